"""Which failed instance is asked for: the rules, on rounds that are made up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from drake_screw.acquisition import Evaluation
from drake_screw.acquisition.asking import (
    MOST,
    NEIGHBOURHOOD,
    apart,
    densest,
    densest_anywhere,
    earliest,
    evenly,
    shares,
)
from drake_screw.acquisition.first import first_place
from drake_screw.acquisition.suggestion import FAILING, initial_suggestions, suggest
from drake_screw.bandits import Cell
from drake_screw.errors import PluginError
from drake_screw.planning import Cause, Outcomes
from drake_screw.tasks import ObjectArea, WorkArea, grid_regions

BOWL = ObjectArea("bowl", (0.0, 0.0, 0.0), (2.0, 1.0, 0.0), 0.0)
AREA = WorkArea((BOWL,))
REGIONS = grid_regions(AREA, {"x": 2, "y": 1})
"""Region 0 is x below 1, region 1 above."""


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def evaluation(coordinates, failed, segment=0, regions=REGIONS, frontier=()) -> Evaluation:
    """A round with one demonstration; coordinates (N, k, 3), failed (N,)."""
    coordinates, failed = np.asarray(coordinates, dtype=float), np.asarray(failed)
    cause = np.where(failed, Cause.JOINT_LIMIT, Cause.SUCCESS).astype(np.uint8)[:, None]
    segment = np.where(failed, segment, -1).astype(np.int16)[:, None]
    outcomes = Outcomes(
        cause,
        segment,
        np.zeros_like(segment, np.int8),
        np.ones(cause.shape, np.float32),
        np.zeros_like(segment),
    )
    drawn = Evaluation(coordinates, np.zeros(len(failed), dtype=np.int64), outcomes, frontier)
    region = drawn.partition(regions).index(coordinates)
    return Evaluation(coordinates, region, outcomes, frontier)


def lattice(nx: int = 40, ny: int = 20) -> np.ndarray:
    """(nx ny, 1, 3) the middles of equal cells of the work area."""
    x, y = np.meshgrid((np.arange(nx) + 0.5) * 2.0 / nx, (np.arange(ny) + 0.5) / ny)
    return np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=-1)[:, None]


def disk(places: np.ndarray, x: float, y: float, radius: float) -> np.ndarray:
    """Which lie in a disk, in the unit box over the area."""
    return np.hypot((places[:, 0, 0] - x) / 2.0, places[:, 0, 1] - y) < radius


def test_earliest_takes_the_one_that_got_least_far_and_draws_among_equals_as_ever() -> None:
    places = rng().uniform(AREA.lower, AREA.upper, (400, 1, 3))
    failed = rng(1).random(400) < 0.5
    seen = evaluation(places, failed, segment=rng(2).integers(0, 3, 400))
    for region in (0, 1):
        mine = np.flatnonzero(failed & (seen.region == region))
        segment = seen.outcomes.segment[mine, 0]
        expected = mine[np.lexsort((rng(5).random(len(mine)), segment))]
        np.testing.assert_array_equal(earliest(seen, region, REGIONS, rng(5)), expected)
        first, second, _ = suggest(seen, region, REGIONS, rng(5), count=3)
        np.testing.assert_array_equal(first.coordinates, places[expected[0]])
        np.testing.assert_array_equal(second.coordinates, places[expected[1]])
        assert first.segment == segment.min() == 0
        assert first.region == region


def test_densest_is_in_the_heart_of_the_pocket_and_not_where_it_fails_earliest() -> None:
    places = lattice()
    pocket, speck = disk(places, 0.5, 0.5, 0.2), disk(places, 0.9, 0.95, 0.04)
    seen = evaluation(places, pocket | speck, segment=np.where(speck, 0, 3))
    assert speck.any()
    found = places[densest(seen, 0, REGIONS, rng())[0], 0]
    assert np.hypot((found[0] - 0.5) / 2.0, found[1] - 0.5) < 0.08
    assert speck[earliest(seen, 0, REGIONS, rng())[0]]


def test_densest_stays_in_the_weakest_region_but_sees_what_fails_beyond_it() -> None:
    """Two pockets of a size; behind one of them the region next to it fails, too."""
    places = lattice()
    alone, beside = disk(places, 0.25, 0.2, 0.1), disk(places, 0.9, 0.8, 0.1)
    beyond = disk(places, 1.3, 0.8, 0.2)
    seen = evaluation(places, alone | beside | beyond)
    rows = densest(seen, 0, REGIONS, rng())
    assert (seen.region[rows] == 0).all()
    assert sorted(rows) == np.flatnonzero(seen.failed & (seen.region == 0)).tolist()
    assert beside[rows[0]] | beyond[rows[0]]
    assert alone[rows[1]], "the second one is not beside the first"


def test_densest_anywhere_may_leave_the_weakest_region() -> None:
    places = lattice()
    small, large = disk(places, 0.4, 0.3, 0.1), disk(places, 1.5, 0.6, 0.2)
    seen = evaluation(places, small | large)
    assert small[densest(seen, 0, REGIONS, rng())[0]]
    first, second, *_ = densest_anywhere(seen, 0, REGIONS, rng())
    assert large[first]
    assert small[second]
    asked = suggest(seen, 0, REGIONS, rng(), rule=densest_anywhere, count=2)
    assert [place.region for place in asked] == [1, 0]
    assert all(place.regions is REGIONS for place in asked)


def test_how_often_a_region_was_drawn_in_makes_no_difference() -> None:
    """Region 1 has 50 times as many instances, and a pocket a third as large."""
    places = np.concatenate(
        [lattice(), *(lattice(80, 40) + np.array([1e-6 * i, 0, 0]) for i in range(12))]
    )
    keep = (places[:, 0, 0] < 1.0) == (np.arange(len(places)) < 800)
    places = places[keep]
    large, small = disk(places, 0.5, 0.5, 0.17), disk(places, 1.5, 0.5, 0.1)
    seen = evaluation(places, large | small)
    assert np.count_nonzero(small) > 10 * np.count_nonzero(large)
    assert large[densest_anywhere(seen, 1, REGIONS, rng())[0]]
    assert shares(seen, REGIONS).sum() == pytest.approx(1.0)
    drawn = evenly(seen, REGIONS, rng(), 4000)
    assert np.isin(drawn, np.flatnonzero(seen.failed)).all()
    assert large[drawn].mean() == pytest.approx(0.17**2 / (0.17**2 + 0.1**2), abs=0.04)


def test_regions_that_refine_themselves_count_by_their_size() -> None:
    """Of a tree's three cells the smallest, an eighth, has most of the instances."""
    corners = [((0, 0), (0.5, 1)), ((0.5, 0), (1, 0.5)), ((0.5, 0.5), (1, 1))]
    none = np.zeros((0, 2)), np.zeros(0, dtype=bool)
    frontier = tuple(
        Cell(np.array(lower, float), np.array(upper, float), 1, 1, *none)
        for lower, upper in corners
    )
    places = np.concatenate([lattice(), lattice(160, 80)])
    inside = (places[:, 0, 0] > 1.0) & (places[:, 0, 1] > 0.5)
    places = places[np.where(np.arange(len(places)) < 800, ~inside, inside)]
    large, small = disk(places, 0.5, 0.5, 0.2), disk(places, 1.6, 0.8, 0.08)
    seen = evaluation(places, large | small, frontier=frontier)
    regions = seen.partition(REGIONS)
    assert np.bincount(seen.region).tolist() == [400, 200, 3200]
    np.testing.assert_allclose(np.bincount(seen.region, shares(seen, regions)), [0.5, 0.25, 0.25])
    assert small[densest(seen, 2, regions, rng())[0]]
    assert large[densest_anywhere(seen, 2, regions, rng())[0]]
    (asked,) = suggest(seen, 2, regions, rng(), rule=densest_anywhere)
    assert asked.region == 0
    assert regions.index(asked.coordinates) == 0


@pytest.mark.parametrize("rule", [earliest, densest, densest_anywhere])
def test_rules_answer_nothing_where_nothing_fails(rule) -> None:
    seen = evaluation(lattice(), np.zeros(800, dtype=bool))
    assert len(rule(seen, 0, REGIONS, rng())) == 0
    assert suggest(seen, 0, REGIONS, rng(), rule=rule, count=3) == ()


@pytest.mark.parametrize("rule", [densest, densest_anywhere])
def test_of_very_many_failures_some_are_looked_at(rule) -> None:
    places = rng().uniform(AREA.lower, AREA.upper, (50_000, 1, 3))
    seen = evaluation(places, disk(places, 0.5, 0.5, 0.2))
    rows = rule(seen, 0, REGIONS, rng(3))
    assert len(set(rows.tolist())) == len(rows) == MOST
    assert seen.failed[rows].all()
    np.testing.assert_array_equal(rows, rule(seen, 0, REGIONS, rng(3)))
    found = places[rows[0], 0]
    assert np.hypot((found[0] - 0.5) / 2.0, found[1] - 0.5) < 0.1


def test_distances_are_parts_of_the_extent_and_a_whole_turn_closes() -> None:
    cup = ObjectArea("cup", (0.0, 0.3, -math.pi), (1.0, 0.3, math.pi), 0.0)
    area = WorkArea((BOWL, cup))
    here = np.array([[[0.0, 0.0, 0.0], [0.0, 0.3, -3.0]]])
    there = np.array(
        [
            [[1.0, 0.1, 0.0], [0.2, 0.3, -3.0]],
            [[0.0, 0.7, 9.0], [0.0, 9.0, -3.0]],
            [[0.0, 0.0, 0.0], [0.0, 0.3, 3.0]],
        ]
    )
    turn = (2 * math.pi - 6.0) / (2 * math.pi)
    np.testing.assert_allclose(apart(area, here, there), [[0.5, 0.7, turn]])
    half = WorkArea((ObjectArea("cup", (0.0, 0.0, -3.0), (1.0, 1.0, 3.0), 0.0),))
    ends = np.array([[[0.5, 0.5, -3.0]], [[0.5, 0.5, 3.0]]])
    assert apart(half, ends[:1], ends[1:])[0, 0] == 1.0


def test_distances_along_the_pitch_of_any_orientation_are_those_of_its_sine() -> None:
    ball = ObjectArea("ball", (0.5, 0.0, 0.0), (0.5, 0.0, 0.0), 0.0, any_orientation=True)
    area = WorkArea((ball,))
    level, up = np.zeros((2, 1, 6))
    level[0, 0] = up[0, 0] = 0.5
    up[0, 5], level[0, 4] = math.pi / 6, 0.1
    assert apart(area, level[None], up[None])[0, 0] == pytest.approx(0.25)
    level[0, 4], up[0, 4], up[0, 5] = -3.0, 3.0, 0.0
    turn = (2 * math.pi - 6.0) / (2 * math.pi)
    assert apart(area, level[None], up[None])[0, 0] == pytest.approx(turn)


def test_the_neighbourhood_reaches_as_far_as_it_says() -> None:
    """The best place of a row of failures has all of them for neighbours, or as many as can be."""
    x = np.linspace(0.1, 1.9, 19)
    places = np.stack([x, np.full(19, 0.5), np.zeros(19)], axis=-1)[:, None]
    seen = evaluation(places, np.ones(19, dtype=bool))
    first = int(densest_anywhere(seen, 0, REGIONS, rng())[0])
    near = np.abs(x - x[first]) / 2.0 <= NEIGHBOURHOOD
    share = shares(seen, REGIONS)
    others = (np.abs(x - x[:, None]) / 2.0 <= NEIGHBOURHOOD) @ share
    assert near @ share == pytest.approx(others.max())


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([3], "instance 3 of 800 succeeds"),
        ([800], "instance 800 of 800 does not exist"),
        ([-1], "instance -1 of 800 does not exist"),
        ([0.5], "found an array float64 of shape (1,)"),
        ([[0]], "found an array int64 of shape (1, 1)"),
        (0, "found an array int64 of shape ()"),
        ([True], "found an array bool of shape (1,)"),
    ],
)
def test_a_rule_that_answers_something_else_is_told_so(rows, message) -> None:
    def mine(evaluation, region, regions, rng):
        return rows

    seen = evaluation(lattice(), np.arange(800) < 3)
    with pytest.raises(PluginError) as caught:
        suggest(seen, 0, REGIONS, rng(), rule=mine)
    assert message in caught.value.message
    assert "mine'" in caught.value.message


def test_a_suggestion_has_instances_with_it_from_all_that_fails() -> None:
    places = lattice()
    left, right = disk(places, 0.5, 0.5, 0.1), disk(places, 1.5, 0.5, 0.1)
    seen = evaluation(places, left | right)
    one, other = suggest(seen, 0, REGIONS, rng(), count=2)
    assert one.failing is other.failing
    assert one.failing.shape == (FAILING, 1, 3)
    assert disk(one.failing, 0.5, 0.5, 0.1).sum() > 50
    assert disk(one.failing, 1.5, 0.5, 0.1).sum() > 50
    assert (disk(one.failing, 0.5, 0.5, 0.1) | disk(one.failing, 1.5, 0.5, 0.1)).all()


def test_the_first_demonstration_may_be_asked_for_in_the_middle_and_the_others_not() -> None:
    settled = first_place("middle", AREA, np.zeros(3))
    (anywhere,) = initial_suggestions(REGIONS, rng(7), 0)
    middle, instead = initial_suggestions(REGIONS, rng(7), 0, settled)
    (second,) = initial_suggestions(REGIONS, rng(7), 1, settled)
    assert middle.coordinates.tolist() == [[1.0, 0.5, 0.0]]
    assert middle.region == REGIONS.index(middle.coordinates)
    drawn = rng(7).uniform(AREA.lower, AREA.upper)
    for place in (anywhere, instead, second):
        np.testing.assert_array_equal(place.coordinates, drawn)
        assert place.region == REGIONS.index(drawn)
    assert middle.failing.shape == (FAILING, 1, 3)
    assert AREA.contains(middle.failing).all()
    assert np.ptp(middle.failing[:, 0, 0]) > 1.8


def area(*boxes: tuple[tuple[float, ...], tuple[float, ...]]) -> WorkArea:
    return WorkArea(tuple(ObjectArea(f"object_{i}", *box, 0.0) for i, box in enumerate(boxes)))


def test_the_farthest_corner_is_that_of_the_greatest_distance_for_each_object() -> None:
    wide = ((-0.3, 0.1, -1.0), (0.7, 0.9, 1.0))
    behind = ((-2.0, -1.0, 0.0), (-1.0, 0.5, 0.0))
    shoulder = np.array([0.1, -0.4, 0.9])
    place = first_place("farthest", area(wide, behind), shoulder)
    for (lower, upper), found in zip((wide, behind), place, strict=True):
        corners = [(x, y) for x in (lower[0], upper[0]) for y in (lower[1], upper[1])]
        away = [np.hypot(x - shoulder[0], y - shoulder[1]) for x, y in corners]
        assert tuple(found[:2]) == corners[int(np.argmax(away))]
    assert np.isnan(place[:, 2]).all()


def test_at_the_farthest_corner_the_yaw_is_drawn_and_a_random_place_comes_behind() -> None:
    turning = area(((0.0, 0.0, -2.0), (2.0, 1.0, 2.0)))
    regions = grid_regions(turning, {"x": 2, "y": 1})
    settled = first_place("farthest", turning, np.array([0.0, 0.2, 0.5]))
    corner, instead = initial_suggestions(regions, rng(3), 0, settled)
    drawn = rng(3).uniform(turning.lower, turning.upper)
    assert corner.coordinates.tolist() == [[2.0, 1.0, drawn[0, 2]]]
    assert corner.region == regions.index(corner.coordinates)
    np.testing.assert_array_equal(instead.coordinates, drawn)
    at_random = first_place("random", turning, np.zeros(3))
    (anywhere,) = initial_suggestions(regions, rng(3), 0, at_random)
    np.testing.assert_array_equal(anywhere.coordinates, drawn)
