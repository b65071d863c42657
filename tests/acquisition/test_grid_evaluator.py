from __future__ import annotations

import numpy as np

from drake_screw.acquisition import Evaluator
from drake_screw.acquisition import grid_evaluator as module
from drake_screw.bandits import Goal, make_strategy
from drake_screw.demonstrations import Demonstration
from drake_screw.planning import BatchPlanner
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


def test_without_demonstrations_everything_fails() -> None:
    evaluator, _ = setup()
    evaluation, verdict = evaluator.evaluate(0, (), 1)
    assert evaluation.failed.all()
    assert evaluation.outcomes.shape == (verdict.total_samples, 0)
