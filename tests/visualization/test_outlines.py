"""Obstacles as pictures show them."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.spatial import ConvexHull

from drake_screw.robot import BoxShape, CylinderShape, ObstacleConfig, PlacedShape
from drake_screw.visualization import draw_heat_map, heat_map_figure
from drake_screw.visualization.outlines import Outline, convex_outline, outlines, widened
from drake_screw.visualization.progress import run_figure
from drake_screw.web.area_map import work_area_map

TURNED = PlacedShape(BoxShape((0.2, 0.1, 0.5)), (0.8, 0.3, 0.1), (0.0, 0.0, np.pi / 2))
WALL = ObstacleConfig("wall", TURNED)
LYING = PlacedShape(CylinderShape(0.05, 0.4), (0.5, 0.0, 0.0), (0.0, np.pi / 2, 0.0))
BEAM = ObstacleConfig("beam", LYING)
FAILURES = [0, 3, 10, 5, 0, 1]


@pytest.fixture
def ax() -> Axes:
    return Figure(figsize=(8, 4), dpi=100).add_subplot()


def span(outline: Outline) -> np.ndarray:
    return np.array([outline.corners.min(axis=0), outline.corners.max(axis=0)])


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(3, 40))
def test_the_outline_is_the_convex_hull(seed: int, count: int) -> None:
    points = np.random.default_rng(seed).normal(size=(count, 2))
    found, hull = convex_outline(points), points[ConvexHull(points).vertices]
    assert {tuple(p) for p in found} == {tuple(p) for p in hull}
    ahead = np.roll(found, -1, axis=0) - found
    after = np.roll(ahead, -1, axis=0)
    assert (ahead[:, 0] * after[:, 1] - ahead[:, 1] * after[:, 0] > 0.0).all()


def test_points_on_a_line_have_an_outline() -> None:
    line = np.linspace([0.0, 1.0], [2.0, 5.0], 5)
    np.testing.assert_allclose(convex_outline(line), line[[0, -1]])
    np.testing.assert_allclose(convex_outline([[1.0, 2.0], [1.0, 2.0]]), [[1.0, 2.0]])


def test_obstacles_are_seen_from_above_and_from_the_side() -> None:
    wall, beam = outlines([WALL, BEAM])
    np.testing.assert_allclose(span(wall), [[0.75, 0.2], [0.85, 0.4]], atol=1e-12)
    np.testing.assert_allclose(span(beam), [[0.3, -0.05], [0.7, 0.05]], atol=1e-12)
    (side,) = outlines([WALL], [[1, 0, 0], [0, 0, -1]])
    np.testing.assert_allclose(span(side), [[0.75, -0.35], [0.85, 0.15]], atol=1e-12)


def test_a_picture_is_widened_for_what_is_near_but_not_for_all_of_it() -> None:
    lower, upper = np.zeros(2), np.ones(2)

    def square(x: float, size: float) -> Outline:
        return Outline("s", np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * size + [x, 0.4])

    for thing, right in ((square(1.05, 0.05), 1.1), (square(1.05, 9.0), 1.15), (square(2, 1), 1)):
        low, high = widened(lower, upper, [thing], 0.15)
        assert high[0] == pytest.approx(right)
        np.testing.assert_allclose(low, lower)


def test_heat_maps_show_them_with_their_names(ax, make_round, regions) -> None:
    event = make_round(regions, FAILURES)
    far = ObstacleConfig("far", PlacedShape(BoxShape((0.2, 0.1, 0.5)), (3.0, 0.0, 0.0)))
    draw_heat_map(ax, event, regions, things=outlines([WALL, far]))
    (wall,) = [p for p in ax.patches if p.get_gid() == "obstacle wall"]
    y_x = wall.get_xy()
    np.testing.assert_allclose([y_x.min(axis=0), y_x.max(axis=0)], [[0.2, 0.75], [0.4, 0.85]])
    names = [t.get_text() for t in ax.texts]
    assert "wall" in names
    assert "far" not in names
    assert sorted(ax.get_ylim()) == pytest.approx([0.6, 1.0])


def test_legends_tell_of_them_only_where_they_are(make_round, regions) -> None:
    event = make_round(regions, FAILURES)
    for things, told in (((), False), (outlines([BEAM]), True)):
        single = heat_map_figure(event, regions, things=things)
        whole = run_figure([event], [regions], things=things)
        for figure in (single, whole):
            words = [t.get_text() for t in figure.legends[0].get_texts()]
            assert ("obstacle" in words) == told
            drawn = [p for p in figure.axes[0].patches if p.get_gid() == "obstacle beam"]
            assert bool(drawn) == told
            low, _ = sorted(figure.axes[0].get_ylim())
            assert low == pytest.approx(0.45 if told else 0.6)


def test_small_maps_show_them(make_round, regions) -> None:
    event = make_round(regions, FAILURES)
    drawn = ElementTree.fromstring(work_area_map(event, regions, things=outlines([WALL])))
    (wall,) = [e for e in drawn.iter() if e.get("class") == "obstacle"]
    corners = np.array([p.split(",") for p in wall.get("points").split()], dtype=float)
    # 300 units a metre: to the right from y = -0.3, downwards from x = 0.6
    np.testing.assert_allclose([corners.min(axis=0), corners.max(axis=0)], [[150, 45], [210, 75]])
