"""The small map beside the 3-D view."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from drake_screw.screws import pose_from_planar
from drake_screw.tasks import Symmetry, WorkArea, grid_regions
from drake_screw.visualization.cells import cells
from drake_screw.visualization.palette import failure_color
from drake_screw.visualization.rounds import sample
from drake_screw.web.area_map import frame_of, map_words, work_area_map
from tests.visualization.conftest import BOWL, make_round, regions

__all__ = ["make_round", "regions"]

FAILURES = [0, 3, 10, 5, 0, 1]


def of_class(drawing: ElementTree.Element, name: str) -> Iterator[ElementTree.Element]:
    return (e for e in drawing.iter() if e.get("class") == name)


def drawn_map(*arguments, **options) -> ElementTree.Element:
    return ElementTree.fromstring(work_area_map(*arguments, **options))


def circle(drawing: ElementTree.Element, name: str) -> np.ndarray:
    (found,) = of_class(drawing, name)
    return np.array([float(found.get(key)) for key in ("cx", "cy")])


def test_it_lies_as_the_3_d_view_shows_it(make_round, regions) -> None:
    event = make_round(regions, FAILURES)
    near, far = np.array([[0.65, 0.0, 0.0]]), np.array([[0.95, 0.5, 0.0]])
    first = circle(drawn_map(event, regions, here=near), "here")
    second = circle(drawn_map(event, regions, here=far), "here")
    assert (second > first).all(), "y grows to the right, x downwards"
    np.testing.assert_allclose(second - first, [0.5 * 300.0, 0.3 * 300.0], atol=0.11)
    (robot,) = of_class(drawn_map(event, regions), "robot")
    corners = np.array([p.split(",") for p in robot.get("points").split()], dtype=float)
    assert (corners[:, 1] < 0.0).all(), "the robot is above the work area"
    np.testing.assert_allclose(corners[:, 0].mean(), 0.3 * 300.0, atol=0.1)


def test_a_click_is_where_the_drawing_says(make_round, regions) -> None:
    event = make_round(regions, FAILURES)
    here = np.array([[0.71, 0.34, 0.0]])
    drawing = drawn_map(event, regions, here=here)
    u, v = circle(drawing, "here")
    first, down, second, right = map(float, drawing.get("data-at").split(","))
    np.testing.assert_allclose([first + v / down, second + u / right], here[0, :2], atol=5e-4)


def test_axes_have_numbers_and_units(make_round, regions) -> None:
    drawing = drawn_map(make_round(regions, FAILURES), regions)
    numbers = [e.text for e in of_class(drawing, "tick-name")]
    assert {"0.6", "0.8", "1.0", "0.0"} <= set(numbers)
    names = [e.text for e in of_class(drawing, "axis-name")]
    assert names == ["y in m →", "← x in m", "robot"]


@pytest.mark.parametrize(("x", "y"), [(0.6, -0.3), (1.0, 0.9), (0.6, 0.9), (1.0, -0.3)])
def test_marks_at_the_border_are_whole(make_round, regions, x, y) -> None:
    event = make_round(regions, FAILURES, demonstrations=1)
    event.demonstrations[0].X_WO[0] = pose_from_planar([x, y, 2.0], 0.1)
    here = np.array([[x, y, 0.7]])
    event = replace(event, suggestion=replace(event.suggestion, coordinates=here))
    drawing = drawn_map(event, regions, here=here)
    left, top, width, height = map(float, drawing.get("viewBox").split())
    for mark in drawing.iter("circle"):
        u, v, r = (float(mark.get(key)) for key in ("cx", "cy", "r"))
        assert left <= u - r - 2.0 <= u + r + 2.0 <= left + width
        assert top <= v - r - 2.0 <= v + r + 2.0 <= top + height


@pytest.mark.parametrize(
    ("symmetry", "marks", "rims"),
    [(None, 1, 0), (Symmetry(turns=3), 3, 0), (Symmetry(), 0, 1), (Symmetry((1, 0, 0)), 1, 0)],
)
def test_a_rim_shows_turn_and_symmetry(make_round, regions, symmetry, marks, rims) -> None:
    event = make_round(regions, FAILURES, demonstrations=0)
    here = np.array([[0.8, 0.3, np.pi / 2.0]])
    drawing = drawn_map(event, regions, here=here, symmetries=[symmetry])
    turns = list(of_class(drawing, "turn"))
    assert len(turns) == marks
    assert len(list(of_class(drawing, "round"))) == rims
    if marks == 1:
        start, end = (
            np.array(p.split(), dtype=float) for p in turns[0].get("d").lstrip("M").split("L")
        )
        np.testing.assert_allclose(end - start, [6.0, 0.0], atol=0.11, err_msg="towards +y")


def test_cells_say_what_part_fails_where_something_does(make_round, regions) -> None:
    drawing = drawn_map(make_round(regions, FAILURES), regions)
    assert [e.text for e in of_class(drawing, "rate")] == ["30%", "100%", "50%", "10%"]


def test_small_rates_have_tints_that_one_can_tell_apart() -> None:
    tints = failure_color([0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0])
    assert (np.abs(np.diff(tints, axis=0)).max(axis=1) > 0.06).all()


def test_a_plane_that_is_none_of_the_table_is_drawn_as_a_chart(make_round) -> None:
    area = WorkArea((replace(BOWL, lower=(0.6, 0.1, -1.0), upper=(1.0, 0.1, 1.0)),))
    parts = grid_regions(area, {"x": 2, "yaw": 3})
    event = make_round(parts, FAILURES)
    drawing = drawn_map(event, parts, here=np.array([[0.9, 0.1, 0.5]]))
    names = [e.text for e in of_class(drawing, "axis-name")]
    assert names == ["yaw in rad →", "x in m →"]
    frame = frame_of(cells(parts, event.verdict.estimates))
    np.testing.assert_allclose(frame.place([[1.0, -1.0], [0.6, 1.0]]), [[0, 0], [360, 150]])
    assert not list(of_class(drawing, "turn"))
    assert (
        map_words(event, sample(event.evaluation, 1000), parts)
        == "dots: what fails of all 60 instances"
    )
