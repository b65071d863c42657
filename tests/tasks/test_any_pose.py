"""Objects at any height, turned in any way, on one another, and apart."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from scipy.spatial.transform import Rotation

from drake_screw.errors import ScenarioError
from drake_screw.robot import ObjectConfig
from drake_screw.robot.overlap import ObjectsOverlap
from drake_screw.screws import inverse, pose_from_planar
from drake_screw.tasks import (
    ObjectArea,
    WorkArea,
    anywhere,
    draw,
    draw_in_all,
    from_unit_box,
    grid_regions,
)

PI = np.pi
HERE = ((0.5, 0.0, 0.0), (0.5, 0.0, 0.0))
ANY = WorkArea((ObjectArea("ball", *HERE, z=0.1, any_orientation=True),))
EULER = WorkArea(
    (
        ObjectArea(
            "ball",
            (0.5, 0.0, -PI),
            (0.5, 0.0, PI),
            z=0.1,
            roll=(-PI, PI),
            pitch=(-PI / 2, PI / 2),
        ),
    )
)
"""What draws roll, pitch and yaw uniformly, and is not uniform on SO(3)."""

SHELF = ObjectArea("bowl", (0.7, -0.2, -1.0), (1.1, 0.8, 1.0), z=(0.0, 0.4), pitch=(-0.2, 0.3))
TRAY = ObjectArea("tray", (0.6, 0.0, -0.5), (0.8, 0.3, 0.5), z=0.2)
CUP = ObjectArea("cup", (-0.1, 0.0, 0.0), (0.1, 0.0, 0.0), z=0.05, on="tray")


def improbability(R: np.ndarray) -> float:
    """Least two-sided binomial probability of counts of events whose share on SO(3) is known."""
    found = []
    for Q in Rotation.random(8, random_state=7).as_matrix():
        cosine = (np.trace(Q.T @ R, axis1=-2, axis2=-1) - 1.0) / 2.0
        angle = np.arccos(np.clip(cosine, -1.0, 1.0))
        for most in (0.8, 1.6, 2.4):
            share = (most - np.sin(most)) / PI
            found.append(stats.binomtest(int((angle <= most).sum()), len(R), share).pvalue)
    for axis in range(3):
        for least in (-0.5, 0.5, 0.9):
            count = int((R[:, axis, axis] > least).sum())
            found.append(stats.binomtest(count, len(R), (1.0 - least) / 2.0).pvalue)
    return min(found)


def rotations(area: WorkArea, how: str) -> np.ndarray:
    """20,000 or so of the first object, from each of the ways that instances come about."""
    if how == "one region":
        places = draw(grid_regions(area, {}), 0, seed=3, round=0, start=0, count=20_000)
    elif how == "a grid":
        regions = grid_regions(area, {"pitch": 5, "roll": 2, "yaw": 3})
        places, _ = draw_in_all(regions, 667, seed=3, round=0)
    elif how == "a tree":
        places = from_unit_box(area, np.random.default_rng(3).random((20_000, 3)))
    else:
        places = anywhere(area, np.random.default_rng(3), 20_000)
    return area.X_WO(places)[:, 0, :3, :3]


@pytest.mark.parametrize("how", ["one region", "a grid", "a tree", "anywhere"])
def test_any_orientation_is_uniform_on_SO3_and_uniform_angles_are_not(how: str) -> None:
    assert improbability(rotations(ANY, how)) > 1e-6
    assert improbability(rotations(EULER, how)) < 1e-12


def test_cells_along_the_pitch_of_any_orientation_are_equally_large() -> None:
    regions = grid_regions(ANY, {"pitch": 4})
    lower, upper = regions.bounds(np.arange(4))
    np.testing.assert_allclose(np.sin(upper[:, 0, 5]), [-0.5, 0.0, 0.5, 1.0])
    np.testing.assert_allclose(lower[1:, 0, 5], upper[:-1, 0, 5])
    everywhere = draw(grid_regions(ANY, {}), 0, seed=1, round=0, start=0, count=10_000)
    for count in np.bincount(regions.index(everywhere), minlength=4):
        assert stats.binomtest(int(count), 10_000, 0.25).pvalue > 1e-6


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**32 - 1))
def test_coordinates_are_recovered_from_poses_of_any_kind(seed: int) -> None:
    area = WorkArea((SHELF, CUP, TRAY, ANY.objects[0]))
    places = anywhere(area, np.random.default_rng(seed), 5)
    assert places.shape == (5, 4, 6)
    X_WO = area.X_WO(places)
    np.testing.assert_allclose(area.X_WO(area.coordinates(X_WO)), X_WO, atol=1e-9)
    np.testing.assert_allclose(area.coordinates(X_WO)[:, :3], places[:, :3], atol=1e-12)
    assert area.contains(places).all()


def test_turns_are_those_of_drake() -> None:
    from pydrake.math import RollPitchYaw

    X_WO = EULER.X_WO([[0.5, 0.0, 0.3, 0.1, -0.4, 0.7]])[0]
    expected = RollPitchYaw(-0.4, 0.7, 0.3).ToRotationMatrix().matrix()
    np.testing.assert_allclose(X_WO[:3, :3], expected, atol=1e-15)


def test_what_stands_on_something_moves_with_it() -> None:
    area = WorkArea((CUP, TRAY))
    cup, tray = area.X_WO([[0.1, 0.0, 0.0], [0.7, 0.2, PI / 2]])
    np.testing.assert_allclose(cup[:3, 3], [0.7, 0.3, 0.25], atol=1e-15)
    np.testing.assert_allclose(inverse(tray) @ cup, pose_from_planar([0.1, 0, 0], 0.05), atol=1e-15)
    assert area.related == {(0, 1)}
    assert (area.settled(0), WorkArea((ANY.objects[0],)).settled(0)) == (False, False)


def test_a_work_area_is_as_wide_as_it_needs_to_be() -> None:
    assert WorkArea((TRAY, CUP)).axes == ("x", "y", "yaw")
    assert WorkArea((TRAY, SHELF)).axes == ("x", "y", "yaw", "z", "roll", "pitch")
    assert WorkArea((TRAY, SHELF)).columns == (
        *((0, j) for j in range(3)),
        *((1, j) for j in (0, 1, 2, 3, 5)),
    )


def test_a_further_axis_leaves_the_draws_of_the_first_three_as_they_are() -> None:
    flat = ObjectArea("bowl", SHELF.lower, SHELF.upper, z=0.0)
    ways = {"seed": 2, "round": 1, "start": 5, "count": 40}
    planar = draw(grid_regions(WorkArea((flat,)), {"x": 3}), 1, **ways)
    whole = draw(grid_regions(WorkArea((SHELF,)), {"x": 3}), 1, **ways)
    np.testing.assert_array_equal(whole[..., :3], planar)
    again = draw(
        grid_regions(WorkArea((SHELF,)), {"x": 3}), 1, **(ways | {"start": 30, "count": 1})
    )
    np.testing.assert_array_equal(again[0], whole[25])
    assert abs(np.corrcoef(whole[:, 0, [0, 1, 2, 3, 5]].T)[3, :3]).max() < 0.7


def beside(one: str, other: str) -> WorkArea:
    """Two things on a line of 1 m that must be half a metre apart."""

    def overlap(X_WO: np.ndarray) -> np.ndarray:
        return np.abs(X_WO[:, 0, 0, 3] - X_WO[:, 1, 0, 3]) < 0.5

    line = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    area = WorkArea((ObjectArea(one, *line, z=0.0), ObjectArea(other, *line, z=0.0)))
    return area.apart(overlap)


@pytest.mark.parametrize("how", ["draw", "anywhere"])
def test_what_is_left_where_objects_must_not_overlap_is_uniform(how: str) -> None:
    area, n = beside("a", "b"), 8000
    if how == "draw":
        found = draw(grid_regions(area, {}), 0, seed=4, round=0, start=0, count=n)
    else:
        found = anywhere(area, np.random.default_rng(4), n)
    a, b = found[:, :, 0].T
    assert (np.abs(a - b) >= 0.5).all()
    # Two triangles with legs of 0.5 m are left; shares of parts of them.
    for event, share in (
        (a < b, 0.5),
        ((a < 0.25) & (a < b), 0.375),
        (np.abs(a - b) > 0.75, 0.25),
        (b > 0.75, 0.375),
    ):
        assert stats.binomtest(int(event.sum()), n, share).pvalue > 1e-6


def test_instances_apart_depend_only_on_their_place() -> None:
    regions = grid_regions(beside("a", "b"), {"a.x": 2})
    ways = {"seed": 4, "round": 2}
    together = draw(regions, 1, **ways, start=0, count=1500)
    for first, last in pairwise([0, 1, 7, 1020, 1030, 1500]):
        part = draw(regions, 1, **ways, start=first, count=last - first)
        np.testing.assert_array_equal(part, together[first:last])


def test_a_region_with_nothing_left_is_an_error_that_says_so() -> None:
    regions = grid_regions(beside("cup", "bowl"), {"cup.x": 4, "bowl.x": 4})
    assert len(draw(regions, 3, seed=0, round=0, start=0, count=3)) == 3
    with pytest.raises(ScenarioError) as found:
        draw(regions, 0, seed=0, round=0, start=0, count=3, most=500)
    assert "region 0 (cup x 0.00..0.25, bowl x 0.00..0.25): objects overlap" in str(found.value)
    assert "next to nothing of it is left" in str(found.value)


def test_overlap_is_that_of_the_objects_shapes() -> None:
    cylinders = (ObjectConfig("bowl", 0.08, 0.06), ObjectConfig("cup", 0.04, 0.1))
    overlap = ObjectsOverlap(cylinders)
    bowl = pose_from_planar(np.zeros(3))
    for place, z, found in (
        ((0.119, 0.0), 0.0, True),
        ((0.121, 0.0), 0.0, False),
        ((0.0, 0.0), 0.059, True),
        ((0.0, 0.0), 0.061, False),
    ):
        X_WO = np.stack([bowl, pose_from_planar([*place, 0.7], z)])
        assert overlap(X_WO[None]).tolist() == [found], (place, z)
    lying = np.stack([bowl, pose_from_planar([0.17, 0.0, 0.0], 0.05)])
    assert not overlap(lying[None])[0]
    lying[1, :3, :3] = [[0, 0, -1], [0, 1, 0], [1, 0, 0]]
    assert overlap(lying[None])[0]
    assert not ObjectsOverlap(cylinders, frozenset({(0, 1)}))(lying[None])[0]
