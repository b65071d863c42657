"""Boxes of different sizes: shares, bounds and their inverse, names, and the unit box."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_screw.tasks import (
    BoxRegions,
    ObjectArea,
    WorkArea,
    box_regions,
    draw,
    from_unit_box,
)

BOWL = ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), 0.0)
CUP = ObjectArea("cup", (0.4, 0.1, -1.0), (0.4, 0.5, 1.0), 0.0)
ONE, TWO = WorkArea((BOWL,)), WorkArea((BOWL, CUP))


@st.composite
def partitions(draw: st.DrawFn) -> BoxRegions:
    """The unit box over an area, cut in two at random places a few times."""
    area = draw(st.sampled_from([ONE, TWO]))
    d = int(area.free.sum())
    boxes = [(np.zeros(d), np.ones(d))]
    for _ in range(draw(st.integers(0, 8))):
        lower, upper = boxes.pop(draw(st.integers(0, len(boxes) - 1)))
        axis = draw(st.integers(0, d - 1))
        middle = (lower[axis] + upper[axis]) / 2.0
        below, above = upper.copy(), lower.copy()
        below[axis] = above[axis] = middle
        boxes += [(lower, below), (above, upper)]
    return box_regions(area, [b[0] for b in boxes], [b[1] for b in boxes])


def three() -> BoxRegions:
    """The lower half in x, and the upper one cut in two along y."""
    return box_regions(ONE, [[0, 0], [0.5, 0], [0.5, 0.5]], [[0.5, 1], [1, 0.5], [1, 1]])


def test_the_unit_box_spans_the_axes_with_room() -> None:
    np.testing.assert_array_equal(TWO.free, [[1, 1, 0], [0, 1, 1]])
    places = from_unit_box(TWO, [[0, 0, 0, 0], [1, 1, 1, 1], [0.5, 0, 0.25, 1]])
    np.testing.assert_array_equal(places[0], TWO.lower)
    np.testing.assert_array_equal(places[1], TWO.upper)
    np.testing.assert_allclose(places[2], [[0.9, -0.2, 0.0], [0.4, 0.2, 1.0]])
    assert from_unit_box(ONE, np.zeros((5, 0, 2))).shape == (5, 0, 1, 3)


def test_bounds_shares_and_names() -> None:
    regions = three()
    lower, upper = regions.bounds(2)
    np.testing.assert_allclose([lower, upper], [[[0.9, 0.3, 0.0]], [[1.1, 0.8, 0.0]]])
    np.testing.assert_allclose(regions.shares, [0.5, 0.25, 0.25])
    assert regions.name(0) == "x 0.700..0.900"
    assert regions.name(2) == "x 0.900..1.100, y 0.300..0.800"
    assert box_regions(ONE, [[0, 0]], [[1, 1]]).name(0) == "the whole work area"
    half = box_regions(TWO, [[0, 0, 0, 0.5]], [[1, 1, 1, 1]])
    assert half.name(0) == "cup yaw 0.000..1.000"


def test_borders_belong_to_the_upper_region_and_outside_to_the_nearest() -> None:
    regions = three()
    places = np.array([[0.9, 0.3], [0.9, 0.0], [0.0, 9.0], [9.0, 9.0], [9.0, -9.0], [1.1, 0.8]])
    coordinates = np.append(places, np.full((6, 1), 7.0), axis=1)[:, None]
    np.testing.assert_array_equal(regions.index(coordinates), [2, 1, 0, 2, 1, 2])
    assert regions.index(coordinates[0]).shape == ()


@settings(deadline=None, max_examples=50)
@given(partitions(), st.integers(0, 2**32 - 1))
def test_index_inverts_bounds(regions: BoxRegions, seed: int) -> None:
    numbers = np.arange(regions.K)
    lower, upper = regions.bounds(numbers)
    part = np.random.default_rng(seed).uniform(1e-6, 1.0 - 1e-6, (7, *lower.shape))
    inside = lower + part * (upper - lower)
    np.testing.assert_array_equal(regions.index(inside), np.tile(numbers, (7, 1)))
    assert regions.shares.sum() == pytest.approx(1.0)
    assert len({regions.name(j) for j in numbers.tolist()}) == regions.K


def test_instances_can_be_drawn_in_a_box() -> None:
    regions = three()
    places = draw(regions, 1, seed=0, round=0, start=0, count=50)
    np.testing.assert_array_equal(regions.index(places), 1)
