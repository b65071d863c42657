"""Joints without limits are planned as those whose limits nothing comes near."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drake_screw.planning import BatchPlanner, Outcomes, ReferencePlanner
from drake_screw.planning.approach import seeds
from drake_screw.robot import Arm, ScrewChain
from drake_screw.screws import pose_from_planar
from tests.planning.test_batch import MIDDLE, REACHING, demonstration
from tests.planning.test_reference import with_limits

N = 300
TURNS = np.array([1, 0, 0, 0, 1, 0, 1]) > 0  # joints that turn on and on
FAR = 100.0
BENT = np.array([1.2, 0.9, -1.2, 1.9, 1.3, 1.2, -1.5])


def limits(arm: Arm, most: float) -> tuple[np.ndarray, np.ndarray]:
    return np.where(TURNS, -most, arm.lower), np.where(TURNS, most, arm.upper)


def chain_of(arm: Arm, most: float) -> ScrewChain:
    lower, upper = limits(arm, most)
    return replace(arm.screw_chain(), lower=lower, upper=upper)


@pytest.fixture(scope="module")
def lessons(seven: Arm):
    rng, made = np.random.default_rng(8), []
    for i in range(3):
        X_WE = seven.pose(REACHING + np.cumsum(rng.uniform(-0.3, 0.3, (3, seven.n)), axis=0))
        X_WO = pose_from_planar(MIDDLE + rng.uniform(-0.05, 0.05, (2, 3)))
        made.append(demonstration(X_WE, X_WO, np.array([0, 0, i % 2]), f"demo_{i}"))
    return tuple(made)


@pytest.fixture(scope="module")
def places() -> np.ndarray:
    spread = np.random.default_rng(9).uniform(-1.0, 1.0, (N, 2, 3)) * [0.3, 0.4, 1.5]
    return pose_from_planar(MIDDLE + spread)


def assert_same(a: Outcomes, b: Outcomes, atol: float = 1e-4) -> None:
    for name in ("cause", "segment", "joint", "variant"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
    np.testing.assert_allclose(a.fraction, b.fraction, atol=atol)


@pytest.mark.parametrize("redundancy", ["least_norm", "away_from_limits"])
def test_outcomes_are_those_with_far_limits(seven: Arm, lessons, places, redundancy: str) -> None:
    endless = BatchPlanner(chain_of(seven, np.inf), redundancy=redundancy)
    far = BatchPlanner(chain_of(seven, FAR), redundancy=redundancy)
    got = endless.all_outcomes(lessons, places, BENT)
    assert_same(got, far.all_outcomes(lessons, places, BENT))
    assert 0.1 < got.success.mean() < 0.9
    assert not np.isin(got.joint, np.flatnonzero(TURNS)).any()
    near = BatchPlanner(seven.screw_chain(), redundancy=redundancy)
    assert got.success.sum() > near.all_outcomes(lessons, places, BENT).success.sum()


def test_where_the_start_counts_from_makes_no_difference(seven: Arm, lessons, places) -> None:
    planner = BatchPlanner(chain_of(seven, np.inf))
    on = 2.0 * np.pi * np.array([3, 0, 0, 0, -1, 0, 5])
    plain = planner.all_outcomes(lessons, places, BENT)
    turned = planner.all_outcomes(lessons, places, BENT + on)
    assert_same(plain, turned, atol=1e-3)
    which = np.zeros(20, dtype=int)
    plans = planner.plans(lessons, places[:20], BENT + on, which)
    for plan, other in zip(plans, planner.plans(lessons, places[:20], BENT, which), strict=True):
        np.testing.assert_allclose(plan.q - on, other.q, atol=1e-6)


@pytest.mark.slow
def test_the_reference_planner_agrees(seven: Arm, lessons, places) -> None:
    arm = with_limits(seven, *limits(seven, np.inf))
    reference = ReferencePlanner(arm, step=0.02)
    outcomes = BatchPlanner(chain_of(seven, np.inf)).all_outcomes(lessons[:1], places[:40], BENT)
    agree = [
        reference.plan(BENT, lessons[0].transfer(X_WO)).success == bool(outcomes.success[i, 0])
        for i, X_WO in enumerate(places[:40])
    ]
    assert sum(agree) >= 39


def test_a_free_approach_sets_out_near_the_start(seven: Arm, lessons, places) -> None:
    chain = chain_of(seven, np.inf)
    drawn = seeds(chain, 16)
    assert np.isfinite(drawn).all()
    assert (np.abs(drawn[:, TURNS]) <= np.pi).all()
    planner = BatchPlanner(chain, seeds=drawn)
    start = BENT + 2.0 * np.pi * np.array([4, 0, 0, 0, 0, 0, -2])
    found = planner.all_outcomes(lessons, places[:60], start)
    along = BatchPlanner(chain).all_outcomes(lessons, places[:60], start)
    assert found.success.sum() > along.success.sum()
    instance, which = np.nonzero(found.success & ~along.success)
    plans = planner.plans(lessons, places[instance], start, which, found.variant[instance, which])
    assert len(plans) > 0
    for plan in plans:
        assert plan.success
        np.testing.assert_array_equal(plan.q[0], start)
        away = np.abs(plan.q[plan.segment == 0] - start)[:, TURNS]
        assert away.max() < 2.0 * np.pi


def test_an_arm_of_nothing_but_continuous_joints(seven: Arm, lessons, places) -> None:
    none = np.full(seven.n, np.inf)
    endless = BatchPlanner(replace(seven.screw_chain(), lower=-none, upper=none))
    far = BatchPlanner(
        replace(seven.screw_chain(), lower=np.full(seven.n, -FAR), upper=np.full(seven.n, FAR))
    )
    assert_same(
        endless.all_outcomes(lessons, places, BENT), far.all_outcomes(lessons, places, BENT)
    )
