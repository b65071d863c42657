from __future__ import annotations

import numpy as np
import pytest

from drake_screw.bandits import Cell
from drake_screw.planning import Cause, Outcomes
from drake_screw.tasks import BoxRegions, ObjectArea, WorkArea, box_regions, grid_regions
from drake_screw.visualization.cells import cells
from drake_screw.visualization.rounds import bounds_over, details, headline, sample
from tests.visualization.conftest import BOWL


def outcomes(cause: list[list[int]], segment: list[list[int]], fraction: float = 0.5) -> Outcomes:
    c, s = np.array(cause, dtype=np.uint8), np.array(segment, dtype=np.int16)
    joint = np.full(c.shape, -1, dtype=np.int8)
    return Outcomes(c, s, joint, np.full(c.shape, fraction, dtype=np.float32), 0 * s)


def test_an_instance_fails_as_its_best_attempt_did() -> None:
    J, U, S, N = Cause.JOINT_LIMIT, Cause.UNREACHABLE, Cause.SUCCESS, Cause.NOT_TRIED
    found = outcomes(
        [[J, U], [U, J], [U, S], [N, J], [N, N]], [[3, 1], [0, 2], [4, -1], [0, 0], [0, 0]]
    )
    assert found.best.cause.tolist() == [J, J, S, J, N]


def test_a_finished_segment_is_not_the_next_one_begun() -> None:
    J, U = Cause.JOINT_LIMIT, Cause.UNREACHABLE
    done = outcomes([[J, U]], [[1, 2]])
    done.fraction[:] = [[1.0, 0.0]]
    assert done.best.cause.tolist() == [U]


def test_without_demonstrations_nothing_was_tried() -> None:
    none = outcomes([[]], [[]])
    assert none.best.cause.tolist() == [Cause.NOT_TRIED]


def test_samples_are_capped_stated_and_repeatable(make_round, regions) -> None:
    evaluation = make_round(regions, [5, 0, 0, 0, 0, 0], each=1000).evaluation
    first, second = sample(evaluation, 100), sample(evaluation, 100)
    assert len(first.coordinates) == len(first.cause) == 100
    assert first.statement == "100 of 6,000 instances, drawn at random"
    np.testing.assert_array_equal(first.coordinates, second.coordinates)
    assert sample(evaluation, 6000).statement == "all 6,000 instances"


def test_a_sample_keeps_the_causes_of_its_instances(make_round, regions) -> None:
    evaluation = make_round(regions, [4, 0, 6, 0, 0, 0]).evaluation
    shown = sample(evaluation, 10_000)
    np.testing.assert_array_equal(shown.cause, evaluation.outcomes.cause[:, 0])
    assert sum(shown.count(cause) for cause in Cause) == 60


def test_cells_of_a_plain_grid_are_its_regions(regions) -> None:
    drawn = cells(regions, np.zeros(regions.K))
    assert drawn.stack == 1
    np.testing.assert_array_equal(drawn.region, np.arange(6))
    lower, upper = regions.bounds(np.arange(6))
    np.testing.assert_allclose(drawn.lower, lower[:, 0, :2])
    np.testing.assert_allclose(drawn.upper, upper[:, 0, :2])


def test_a_stack_shows_its_worst_region() -> None:
    area = WorkArea((ObjectArea("bowl", (0.6, 0.0, -1.0), (1.0, 0.4, 1.0), 0.0),))
    regions = grid_regions(area, {"x": 2, "yaw": 3})
    drawn = cells(regions, np.array([0.1, 0.9, 0.5, np.nan, 0.2, 0.3]))
    assert drawn.stack == 3
    assert drawn.region.tolist() == [2, 1]
    np.testing.assert_allclose(drawn.lower, drawn.outlines[:2, 0])
    np.testing.assert_allclose(drawn.outlines, np.tile(drawn.outlines[:2], (3, 1, 1)))


def test_the_first_object_that_can_move_is_drawn() -> None:
    fixed = ObjectArea("cup", (0.5, 0.2, 0.0), (0.5, 0.2, 0.0), 0.0)
    regions = grid_regions(WorkArea((fixed, BOWL)), {"bowl.x": 2})
    drawn = cells(regions, np.zeros(2))
    assert drawn.object == 1
    np.testing.assert_allclose(drawn.lower, [[0.6, -0.3], [0.8, -0.3]])


def refined(area: WorkArea, d: int, seed: int) -> BoxRegions:
    """A frontier of the tree, split at random."""
    rng = np.random.default_rng(seed)
    frontier = [Cell(np.zeros(d), np.ones(d), 0, 1, np.zeros((0, d)), np.zeros(0, bool))]
    for _ in range(40):
        frontier += frontier.pop(rng.integers(len(frontier))).halves()
    return box_regions(area, [c.lower for c in frontier], [c.upper for c in frontier])


def test_cells_of_different_sizes_are_their_own() -> None:
    regions = refined(WorkArea((BOWL,)), 2, seed=0)
    drawn = cells(regions, np.zeros(regions.K))
    assert drawn.stack == 1
    np.testing.assert_array_equal(drawn.region, np.arange(regions.K))
    np.testing.assert_array_equal(np.stack([drawn.lower, drawn.upper], axis=1), drawn.outlines)


@pytest.mark.parametrize("seed", range(5))
def test_every_place_shows_the_worst_region_above_it(seed: int) -> None:
    cup = ObjectArea("cup", (0.2, 0.0, -1.0), (0.4, 0.0, 1.0), 0.0)
    area = WorkArea((BOWL, cup))
    regions = refined(area, 4, seed)
    rng = np.random.default_rng(seed)
    estimates = np.where(rng.random(regions.K) < 0.2, np.nan, rng.random(regions.K))
    drawn = cells(regions, estimates)
    stacks = []
    for place in rng.uniform(area.lower[0, :2], area.upper[0, :2], (200, 2)):
        inside = ((drawn.lower <= place) & (place < drawn.upper)).all(axis=1)
        assert inside.sum() == 1, "the cells tile the work area"
        above = ((regions.lower[:, 0, :2] <= place) & (place < regions.upper[:, 0, :2])).all(axis=1)
        shown = drawn.region[inside.argmax()]
        assert above[shown]
        known = estimates[above]
        worst = known[~np.isnan(known)].max(initial=-1.0)
        assert np.isnan(known).all() or estimates[shown] == worst
        stacks.append(above.sum())
    assert max(stacks) <= drawn.stack


def test_a_round_in_words(make_round, regions) -> None:
    weak = make_round(regions, [0, 0, 7, 0, 0, 0], number=2, demonstrations=1)
    assert headline(weak) == "round 3, 1 demonstration: not certified"
    assert details(weak, regions).startswith("weakest region: x 0.60..0.80, y 0.10..0.50; largest")
    sure = make_round(regions, [0] * 6)
    assert headline(sure) == "round 1, 2 demonstrations: certified"


def test_where_nothing_fails_no_region_is_the_weakest(make_round, regions) -> None:
    assert make_round(regions, [0, 0, 7, 0, 0, 0]).verdict.weakest == 2
    sure = make_round(regions, [0] * 6)
    assert sure.verdict.weakest is None
    assert details(sure, regions).startswith("no instance fails; ")


def test_bounds_over_one_minus_beta_are_explained_in_certified_rounds_only(
    make_round, regions
) -> None:
    sure = make_round(regions, [0] * 6).verdict
    assert sure.upper.max() == pytest.approx(0.1)
    assert bounds_over(sure, 0.95).startswith(
        "The upper bound of 6 of 6 regions is over 1 - beta = 0.05 although the round is certified"
    )
    assert bounds_over(sure, 0.9) == ""
    assert bounds_over(make_round(regions, [1, 0, 0, 0, 0, 0]).verdict, 0.95) == ""
