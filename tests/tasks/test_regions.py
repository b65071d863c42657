"""Grids: numbering, bounds and their inverse, names."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_screw.tasks import GridRegions, ObjectArea, WorkArea, grid_regions

BOWL = ObjectArea("bowl", (0.7, -0.2, -1.0), (1.1, 0.8, 1.0), 0.0)
CUP = ObjectArea("cup", (0.4, 0.0, 0.0), (0.6, 0.5, 0.0), 0.0)
ONE, TWO = WorkArea((BOWL,)), WorkArea((BOWL, CUP))


@st.composite
def grids(draw: st.DrawFn) -> GridRegions:
    """A grid over one or two objects; axes without width are not split."""
    area = draw(st.sampled_from([ONE, TWO]))
    counts = {}
    for item in area.objects:
        for axis, low, high in zip(area.axes, item.lower, item.upper, strict=True):
            if high > low and draw(st.booleans()):
                counts[f"{item.name}.{axis}"] = draw(st.integers(1, 4))
    return grid_regions(area, counts)


def test_first_axis_runs_fastest() -> None:
    grid = grid_regions(ONE, {"x": 4, "y": 4})
    assert grid.K == 16
    np.testing.assert_array_equal(
        grid.cell([0, 1, 5, 15])[:, 0], [[0, 0, 0], [1, 0, 0], [1, 1, 0], [3, 3, 0]]
    )
    lower, upper = grid.bounds(5)
    np.testing.assert_allclose(lower, [[0.8, 0.05, -1.0]])
    np.testing.assert_allclose(upper, [[0.9, 0.30, 1.0]])
    lower, upper = grid.bounds(0)
    np.testing.assert_allclose(lower, ONE.lower)
    np.testing.assert_allclose(grid.bounds(15)[1], ONE.upper)


def test_yaw_and_objects_come_after_x_and_y() -> None:
    grid = grid_regions(TWO, {"bowl.x": 2, "bowl.yaw": 3, "cup.y": 5})
    assert grid.K == 30
    np.testing.assert_array_equal(grid.counts, [[2, 1, 3], [1, 5, 1]])
    np.testing.assert_array_equal(grid.cell(1), [[1, 0, 0], [0, 0, 0]])
    np.testing.assert_array_equal(grid.cell(2), [[0, 0, 1], [0, 0, 0]])
    np.testing.assert_array_equal(grid.cell(6), [[0, 0, 0], [0, 1, 0]])
    np.testing.assert_array_equal(grid.cell(29), [[1, 0, 2], [0, 4, 0]])


def test_axes_without_a_name_are_the_first_objects() -> None:
    np.testing.assert_array_equal(grid_regions(TWO, {"y": 3}).counts, [[1, 3, 1], [1, 1, 1]])


@settings(deadline=None)
@given(grids(), st.integers(0, 2**32 - 1))
def test_index_inverts_bounds(grid: GridRegions, seed: int) -> None:
    regions = np.arange(grid.K)
    lower, upper = grid.bounds(regions)
    part = np.random.default_rng(seed).uniform(1e-6, 1.0 - 1e-6, (7, *lower.shape))
    inside = lower + part * (upper - lower)
    np.testing.assert_array_equal(grid.index(inside), np.tile(regions, (7, 1)))
    assert grid.index(inside[0, 0]).shape == ()


@settings(deadline=None)
@given(grids())
def test_regions_tile_the_area(grid: GridRegions) -> None:
    lower, upper = grid.bounds(np.arange(grid.K))
    extent = upper - lower
    wide = grid.area.upper > grid.area.lower
    whole = (grid.area.upper - grid.area.lower)[wide].prod()
    assert extent[:, wide].prod(axis=1).sum() == pytest.approx(whole)
    np.testing.assert_allclose(lower.min(axis=0), grid.area.lower)
    np.testing.assert_allclose(upper.max(axis=0), grid.area.upper)
    corners = grid.index(np.stack([grid.area.lower, grid.area.upper]))
    np.testing.assert_array_equal(corners, [0, grid.K - 1])


def test_instances_outside_belong_to_the_nearest_region() -> None:
    grid = grid_regions(ONE, {"x": 4, "y": 4})
    coordinates = np.array([[[0.0, 0.0, 0.0]], [[2.0, 9.0, 0.0]], [[0.85, -3.0, 9.0]]])
    np.testing.assert_array_equal(grid.index(coordinates), [0, 15, 1])


def test_names() -> None:
    assert grid_regions(ONE, {"x": 4, "y": 4}).name(5) == "x 0.80..0.90, y 0.05..0.30"
    assert grid_regions(ONE, {"yaw": 2}).name(1) == "yaw 0.00..1.00"
    assert grid_regions(ONE, {}).name(0) == "the whole work area"
    grid = grid_regions(TWO, {"bowl.x": 2, "cup.y": 5})
    assert grid.name(3) == "bowl x 0.90..1.10, cup y 0.10..0.20"


@settings(deadline=None)
@given(grids())
def test_names_are_all_different(grid: GridRegions) -> None:
    assert len({grid.name(region) for region in range(grid.K)}) == grid.K


@pytest.mark.parametrize("shape", [(), (4,), (2, 3)])
def test_leading_axes_are_carried(shape: tuple[int, ...]) -> None:
    grid = grid_regions(TWO, {"bowl.x": 2, "cup.y": 5})
    regions = np.random.default_rng(0).integers(0, grid.K, shape)
    lower, upper = grid.bounds(regions)
    assert grid.cell(regions).shape == lower.shape == upper.shape == (*shape, 2, 3)
    np.testing.assert_array_equal(grid.index((lower + upper) / 2.0), regions)
