"""Rounds on the tree: what is drawn where, what is kept, and whole runs with several objects."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from drake_screw.acquisition import RoundFinished, Status, TreeEvaluator, acquire
from drake_screw.acquisition import tree_evaluator as module
from drake_screw.bandits import CertifyOrSplit, Goal
from drake_screw.demonstrations import Demonstration, Recording
from drake_screw.planning import Cause, Outcomes
from drake_screw.screws import pose_from_planar
from drake_screw.tasks import ObjectArea, WorkArea, grid_regions
from tests.acquisition.conftest import Obliging, learn

BOWL = ObjectArea("bowl", (0.0, 0.0, 0.0), (1.0, 1.0, 0.0), 0.0)
CUP = ObjectArea("cup", (2.0, 0.5, -0.5), (2.4, 0.5, 0.5), 0.0)
ONE, TWO = WorkArea((BOWL,)), WorkArea((BOWL, CUP))
START = [0.25]
GOAL = Goal(beta=0.95, epsilon=0.02, delta=0.05)


@dataclass
class Nearby:
    """A planner: a demonstration serves where each object is as near to its place in it as this."""

    reach: float

    def any_success(self, demonstrations, X_WO, q_start) -> Outcomes:
        assert q_start.tolist() == START
        away = np.array(
            [np.abs(X_WO - d.X_WO).max(axis=(1, 2, 3)) for d in demonstrations]
        ).reshape(len(demonstrations), len(X_WO))
        served = (away < self.reach).T
        cause = np.where(served, Cause.SUCCESS, Cause.UNREACHABLE).astype(np.uint8)
        segment = np.where(served, -1, 2).astype(np.int16)
        return Outcomes(
            cause,
            segment,
            np.full_like(segment, -1, dtype=np.int8),
            served.astype(np.float32),
            np.zeros_like(segment),
        )


class Edges(Nearby):
    """One demonstration leaves a thin edge and a corner; a second one serves everywhere."""

    def any_success(self, demonstrations, X_WO, q_start) -> Outcomes:
        x, y = X_WO[:, 0, 0, 3], X_WO[:, 0, 1, 3]
        left = (x < 0.005) | (np.minimum(x, y) > 0.87)
        moved = X_WO.copy()
        moved[..., :2, 3] += 100.0 * (left & (len(demonstrations) < 2))[:, None, None]
        return super().any_success(demonstrations, moved, q_start)


def demonstration_at(name: str, *coordinates: tuple[float, float, float]) -> Demonstration:
    X_WO = pose_from_planar(np.array(coordinates))
    recording = Recording(name, ("j0",), np.array([0.0, 1.0]), np.zeros((2, 1)), X_WO)
    return learn(recording)


def evaluator(
    area=ONE, *, reach=0.75, smallest=1 / 64, seed=3, progress=None, planner=Nearby
) -> TreeEvaluator:
    tree = CertifyOrSplit(GOAL, 2 if area is ONE else 4, smallest, 0.5)
    return TreeEvaluator(planner(reach), area, np.array(START), tree, seed, progress)


FIRST = (demonstration_at("first", (0.2, 0.2, 0.0)),)
BOTH = (*FIRST, demonstration_at("second", (0.8, 0.5, 0.0)))


def test_counts_regions_and_instances_agree() -> None:
    evaluation, verdict = evaluator().evaluate(0, FIRST, 1)
    assert not verdict.certified
    served = (evaluation.coordinates[:, 0, :2] < 0.95).all(axis=1)
    np.testing.assert_array_equal(evaluation.failed, ~served)
    regions = evaluation.partition(grid_regions(ONE, {}))
    assert regions.K == len(verdict.samples) > 1
    np.testing.assert_array_equal(regions.index(evaluation.coordinates), evaluation.region)
    drawn, failed = evaluation.region, evaluation.region[evaluation.failed]
    np.testing.assert_array_equal(np.bincount(drawn, minlength=regions.K), verdict.samples)
    np.testing.assert_array_equal(np.bincount(failed, minlength=regions.K), verdict.failures)
    known = verdict.samples > 0
    assert (verdict.lower[known] <= verdict.estimates[known]).all()
    assert (verdict.upper[known] >= verdict.estimates[known]).all()
    assert regions.shares[verdict.region] == pytest.approx(1 / 64)
    assert verdict.lower[verdict.region] > 0.05 > verdict.coverage


def test_batches_do_not_matter_but_rounds_and_seeds_do(monkeypatch) -> None:
    whole, _ = evaluator().evaluate(0, FIRST, 1)
    other, _ = evaluator(seed=4).evaluate(0, FIRST, 1)
    later, _ = evaluator().evaluate(1, FIRST, 1)
    monkeypatch.setattr(module, "BATCH", 7)
    parts, _ = evaluator().evaluate(0, FIRST, 1)
    np.testing.assert_array_equal(whole.coordinates, parts.coordinates)
    np.testing.assert_array_equal(whole.outcomes.cause, parts.outcomes.cause)
    for different in (other, later):
        assert not np.isin(different.coordinates[:, 0, 0], whole.coordinates[:, 0, 0]).any()


def test_progress_counts_the_whole_area() -> None:
    seen = []
    evaluation, _ = evaluator(progress=seen.append).evaluate(0, FIRST, 1)
    assert [e.samples.shape for e in seen] == [(1,)] * len(seen)
    assert seen[-1].samples[0] == len(evaluation.region)
    assert seen[-1].failures[0] == np.count_nonzero(evaluation.failed)


def test_what_was_cleared_is_not_drawn_in_again() -> None:
    rounds = evaluator(smallest=1 / 4, reach=2.0, seed=0, planner=Edges)
    first, before = rounds.evaluate(0, FIRST, 1)
    cleared = [cell for cell in first.frontier if cell.cleared]
    assert cleared
    second, after = rounds.evaluate(1, BOTH, 2)
    kept = [second.frontier.index(cell) for cell in cleared]
    assert not np.isin(second.region, kept).any()
    old = [first.frontier.index(cell) for cell in cleared]
    np.testing.assert_array_equal(after.samples[kept], before.samples[old])
    assert after.certified
    assert after.total_samples == len(second.region) + before.samples[old].sum()
    assert after.coverage >= GOAL.beta


def test_a_remembered_round_leads_on_as_the_round_itself() -> None:
    rounds = evaluator()
    first, _ = rounds.evaluate(0, FIRST, 1)
    expected, verdict = rounds.evaluate(1, BOTH, 2)
    again = evaluator()
    again.remember(first)
    found, same = again.evaluate(1, BOTH, 2)
    np.testing.assert_array_equal(found.coordinates, expected.coordinates)
    np.testing.assert_array_equal(same.samples, verdict.samples)
    assert same.claim == verdict.claim


def test_without_demonstrations_the_whole_area_is_asked_for() -> None:
    evaluation, verdict = evaluator().evaluate(0, (), 1)
    assert evaluation.failed.all()
    assert evaluation.partition(grid_regions(ONE, {})).name(verdict.region) == "the whole work area"


def test_a_tree_of_other_axes_is_refused() -> None:
    tree = CertifyOrSplit(GOAL, 3, 1 / 4, 0.5)
    with pytest.raises(ValueError, match="3 axes, the work area 2"):
        TreeEvaluator(Nearby(1.0), ONE, np.zeros(1), tree, 0)


class ObligingWithAll(Obliging):
    """Demonstrates with all objects where it is asked to."""

    def demonstrate(self, suggestion, *, number, used, rng):
        lesson = super().demonstrate(suggestion, number=number, used=used, rng=rng)
        lesson.recording.X_WO.resize((len(suggestion.coordinates), 4, 4), refcheck=False)
        lesson.recording.X_WO[:] = pose_from_planar(suggestion.coordinates)
        return lesson


@pytest.mark.parametrize("seed", range(3))
def test_a_run_with_two_objects_certifies_what_is_true(seed) -> None:
    """The objects move along x, y and x, yaw: four axes."""
    rounds, teacher = evaluator(TWO, reach=0.5, seed=seed), ObligingWithAll()
    start = grid_regions(TWO, {})
    events = list(acquire(rounds.evaluate, teacher, learn, start, initial=1, budget=200, seed=seed))
    end = events[-1]
    assert end.status is Status.CERTIFIED
    finished = [e for e in events if isinstance(e, RoundFinished)]
    assert len(finished) > 3
    for event, asked in zip(finished, teacher.asked[1:], strict=False):
        assert asked is event.suggestion
        assert asked.regions is event.regions
        assert event.regions.index(asked.coordinates) == asked.region == event.verdict.region
        split = event.regions.upper - event.regions.lower
        assert (split[:, [0, 1], [2, 1]] == 0.0).all(), "fixed axes are not split"
    rng = np.random.default_rng(seed)
    places = rng.uniform(TWO.lower, TWO.upper, (20_000, 2, 3))
    outcomes = Nearby(0.5).any_success(end.demonstrations, TWO.X_WO(places), np.array(START))
    assert np.mean(~outcomes.any_success) <= 1 - GOAL.beta


def test_a_small_pocket_of_failure_is_found_where_it_is() -> None:
    """A corner that is a sixtieth of the area, which 95 % of the whole would not show."""
    near = (demonstration_at("near", (0.43, 0.43, 0.0)),)
    rounds = evaluator(reach=0.4475, smallest=1 / 256)
    evaluation, verdict = rounds.evaluate(0, near, 1)
    lower, _ = evaluation.partition(grid_regions(ONE, {})).bounds(verdict.region)
    assert not verdict.certified
    assert lower[0, :2].max() >= 0.8125


def test_other_demonstrations_start_over() -> None:
    rounds = evaluator(smallest=1 / 4, reach=2.0, seed=0, planner=Edges)
    first, _ = rounds.evaluate(0, FIRST, 1)
    assert any(cell.cleared for cell in first.frontier)
    other = (demonstration_at("other", (0.8, 0.8, 0.0)),)
    for epoch, demonstrations in enumerate((other, BOTH), start=2):
        rounds.start_over()
        found, verdict = rounds.evaluate(epoch, demonstrations, epoch)
        assert verdict.certified == (demonstrations is BOTH)
        assert {cell.epoch for cell in found.frontier} == {epoch}
        drawn = np.bincount(found.region, minlength=len(found.frontier))
        np.testing.assert_array_equal(drawn, verdict.samples)  # nothing is left of before


def test_starting_over_at_the_start_changes_nothing() -> None:
    rounds = evaluator()
    rounds.start_over()
    found, _ = rounds.evaluate(0, FIRST, 1)
    expected, _ = evaluator().evaluate(0, FIRST, 1)
    np.testing.assert_array_equal(found.coordinates, expected.coordinates)
    assert {cell.epoch for cell in found.frontier} == {1}
