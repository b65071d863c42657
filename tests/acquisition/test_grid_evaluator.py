from __future__ import annotations

from contextlib import contextmanager
from dataclasses import replace
from functools import partial

import numpy as np

from drake_screw.acquisition import Evaluator, Executed
from drake_screw.acquisition import grid_evaluator as module
from drake_screw.bandits import Goal, make_strategy
from drake_screw.demonstrations import Demonstration
from drake_screw.planning import BatchPlanner, Cause
from drake_screw.planning.outcomes import one_outcome
from drake_screw.robot import ScrewChain
from drake_screw.screws import pose, pose_from_planar
from drake_screw.tasks import ObjectArea, WorkArea, grid_regions


def cartesian() -> ScrewChain:
    """Three slides and a wrist: reaches every pose whose position is within the slides."""
    screws = np.zeros((6, 6))
    screws[0, 3] = screws[1, 4] = screws[2, 5] = 1.0
    screws[3, 2] = screws[4, 1] = screws[5, 0] = 1.0
    limit = np.array([1.0, 1.0, 1.0, 2.0, 1.2, 2.0])
    return ScrewChain(tuple("xyzabc"), screws, np.eye(4), -limit, limit)


def setup(progress=None):
    area = WorkArea((ObjectArea("bowl", (0.0, 0.0, 0.0), (1.2, 0.8, 0.0), 0.0),))
    regions = grid_regions(area, {"x": 2})
    strategy = make_strategy("naive_pac", Goal(0.6, 0.2, 0.1))
    evaluator = Evaluator(
        BatchPlanner(cartesian()), regions, np.zeros(6), strategy, seed=3, progress=progress
    )
    X_OE = pose(np.eye(3), [[0.0, 0.0, 0.1]])
    demonstration = Demonstration(
        "demo", X_OE, np.array([0]), pose_from_planar([[0.0, 0.0, 0.0]]), X_OE, np.array([0])
    )
    return evaluator, (demonstration,)


def test_counts_agree_with_what_planning_says() -> None:
    evaluator, demonstrations = setup()
    evaluation, verdict = evaluator.evaluate(0, demonstrations, 1)
    expected = evaluation.coordinates[:, 0, 0] >= 1.0
    assert np.array_equal(evaluation.failed, expected)
    assert expected.any()
    assert np.array_equal(np.bincount(evaluation.region), verdict.samples)
    assert np.array_equal(np.bincount(evaluation.region[expected], minlength=2), verdict.failures)
    assert np.array_equal(evaluator.regions.index(evaluation.coordinates), evaluation.region)


def test_batches_do_not_matter(monkeypatch) -> None:
    evaluator, demonstrations = setup()
    whole, _ = evaluator.evaluate(1, demonstrations, 1)
    monkeypatch.setattr(module, "BATCH", 37)
    parts, _ = evaluator.evaluate(1, demonstrations, 1)
    assert np.array_equal(whole.coordinates, parts.coordinates)
    assert np.array_equal(whole.outcomes.cause, parts.outcomes.cause)


def test_progress_counts_up_to_the_verdict() -> None:
    seen = []
    evaluator, demonstrations = setup(seen.append)
    _, verdict = evaluator.evaluate(0, demonstrations, 1)
    totals = [e.samples.sum() for e in seen]
    assert totals == sorted(totals)
    assert len(seen) > 1
    assert np.array_equal(seen[-1].failures, verdict.failures)


class Flipping:
    """Executes by the flip of a coin that each instance has for itself."""

    width = 2

    def __init__(self, evaluator: Evaluator) -> None:
        self.evaluator = evaluator
        self.opened = 0

    @contextmanager
    def begin(self, round, demonstrations):
        self.opened += 1
        yield partial(self._try, demonstrations)
        self.opened -= 1

    def _try(self, demonstrations, x_y_yaw, numbers):
        by = self.evaluator
        X_WO = by.regions.area.X_WO(x_y_yaw)
        outcomes = by.planner.any_success(demonstrations, X_WO, by.q_start)
        ran = outcomes.any_success
        bad = ran & (numbers[:, 1] < 0.25)
        outcomes = outcomes.replaced((bad, 0), one_outcome(Cause.EXECUTION, 0))
        flaw = np.where(bad, "pushed", "")
        measures = np.where(ran[:, None], numbers, np.nan)
        executed = Executed(
            x_y_yaw, numbers, ran, flaw, flaw, *measures.T, *measures.T, measures[:, 0]
        )
        return outcomes, executed


def test_what_fails_in_its_execution_fails() -> None:
    evaluator, demonstrations = setup()
    executing = Flipping(evaluator)
    evaluation, verdict = replace(evaluator, executing=executing).evaluate(2, demonstrations, 1)
    executed, reachable = evaluation.executed, evaluation.coordinates[:, 0, 0] < 1.0
    assert executing.opened == 0
    assert np.array_equal(executed.ran, reachable)
    assert np.array_equal(evaluation.failed, ~reachable | (executed.flaw == "pushed"))
    assert verdict.failures.sum() == evaluation.failed.sum()
    rate = (executed.flaw[reachable] == "pushed").mean()
    assert abs(rate - 0.25) < 5 * np.sqrt(0.25 * 0.75 / reachable.sum())
    assert executed.counts() == {"pushed": int((executed.flaw == "pushed").sum())}
    assert len(np.unique(executed.joint_offset, axis=0)) == len(reachable)


def test_what_is_drawn_for_an_execution_depends_on_its_place_alone(monkeypatch) -> None:
    evaluator, demonstrations = setup()
    found = []
    for batch in (module.BATCH, 37):
        monkeypatch.setattr(module, "BATCH", batch)
        executing = Flipping(evaluator)
        evaluation, _ = replace(evaluator, executing=executing).evaluate(1, demonstrations, 1)
        found.append(evaluation)
    whole, parts = found
    assert np.array_equal(whole.executed.joint_offset, parts.executed.joint_offset)
    assert np.array_equal(whole.executed.flaw, parts.executed.flaw)
    planned, _ = evaluator.evaluate(1, demonstrations, 1)
    assert planned.executed is None
    n = min(len(planned.coordinates), len(whole.coordinates))
    per_region = [e.coordinates[e.region == 0][: n // 4] for e in (planned, whole)]
    assert np.array_equal(*per_region)


def test_without_demonstrations_everything_fails() -> None:
    evaluator, _ = setup()
    evaluation, verdict = evaluator.evaluate(0, (), 1)
    assert evaluation.failed.all()
    assert evaluation.outcomes.shape == (verdict.total_samples, 0)


def test_a_round_whose_size_is_known_says_beforehand_how_long_it_is(monkeypatch) -> None:
    monkeypatch.setattr(module, "BATCH", 37)
    seen = []
    evaluator, demonstrations = setup(progress=seen.append)
    evaluation, verdict = evaluator.evaluate(0, demonstrations, 1)
    assert len(seen) > 2
    assert {event.total for event in seen} == {len(evaluation.region)} == {verdict.total_samples}
    seen.clear()
    others = replace(evaluator, strategy=make_strategy("eprocess", Goal(0.6, 0.2, 0.1)))
    others.evaluate(0, demonstrations, 1)
    assert {event.total for event in seen} == {None}
