"""A free approach: other ways to the first guiding pose, and the rest of the plan from there."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.planning import BatchPlanner, Cause, Outcomes, Symmetries
from drake_screw.planning.approach import seeds, straight
from drake_screw.planning.paths import SPACING
from drake_screw.robot import Arm
from drake_screw.screws import pose_from_planar, rotation_angle, sclerp, translation_distance
from drake_screw.tasks import Symmetry
from tests.planning.test_batch import MIDDLE, REACHING, demonstration

N, SEEDS = 120, 12
BENT = np.array([1.2, 0.9, -1.2, 1.9, 1.3, 1.2, -1.5])  # near many limits


@pytest.fixture(scope="module")
def lessons(seven: Arm):
    rng, made = np.random.default_rng(8), []
    for i in range(3):
        steps = rng.uniform(-0.25, 0.25, (3, seven.n))
        X_WE = seven.pose(REACHING + np.cumsum(steps, axis=0))
        X_WO = pose_from_planar(MIDDLE + rng.uniform(-0.05, 0.05, (2, 3)))
        made.append(demonstration(X_WE, X_WO, np.array([0, 0, i % 2]), f"demo_{i}"))
    return tuple(made)


@pytest.fixture(scope="module")
def places() -> np.ndarray:
    spread = np.random.default_rng(9).uniform(-1.0, 1.0, (N, 2, 3)) * [0.25, 0.3, 1.0]
    return pose_from_planar(MIDDLE + spread)


@pytest.fixture(scope="module", params=[1, 4], ids=["fixed", "turning"])
def planner(request: pytest.FixtureRequest, seven: Arm) -> BatchPlanner:
    chain = seven.screw_chain()
    objects = [None if request.param == 1 else Symmetry(turns=request.param), None]
    symmetries = Symmetries.of(chain, objects)
    return BatchPlanner(chain, symmetries=symmetries, seeds=seeds(chain, SEEDS))


@pytest.fixture(scope="module")
def found(planner: BatchPlanner, lessons, places) -> Outcomes:
    return planner.all_outcomes(lessons, places, BENT)


def test_whatever_a_screw_reaches_is_reached_and_more(
    planner: BatchPlanner, lessons, places, found: Outcomes
) -> None:
    screws = BatchPlanner(planner.chain, symmetries=planner.symmetries)
    along = screws.all_outcomes(lessons, places, BENT)
    assert found.success[along.success].all()
    np.testing.assert_array_equal(found.variant[along.success], along.variant[along.success])
    assert found.success.sum() > along.success.sum() + 10


def test_outcomes_are_those_of_the_first_variant_that_succeeds(
    planner: BatchPlanner, lessons, places, found: Outcomes
) -> None:
    for d, lesson in enumerate(lessons):
        each = planner.variant_outcomes(lesson, places, BENT)
        assert each.shape == (N, planner.variants(lesson))
        np.testing.assert_array_equal(found.success[:, d], each.any_success)
        solved = np.flatnonzero(each.any_success)
        first = each.success[solved].argmax(axis=1)
        np.testing.assert_array_equal(found.variant[solved, d], first)
        own = planner.variant_outcomes(lesson, places, BENT, others=False)
        np.testing.assert_array_equal(own.cause, each.cause[:, : own.shape[1]])


def test_any_success_finds_the_same(
    planner: BatchPlanner, lessons, places, found: Outcomes
) -> None:
    some = planner.any_success(lessons, places, BENT)
    np.testing.assert_array_equal(some.any_success, found.any_success)
    tried = some.cause != Cause.NOT_TRIED
    assert tried[~found.any_success].all()
    for name in ("cause", "segment", "joint", "fraction", "variant"):
        np.testing.assert_array_equal(getattr(some, name)[tried], getattr(found, name)[tried])


def test_a_plan_goes_straight_to_the_first_guiding_pose_and_on_along_its_screws(
    planner: BatchPlanner, lessons, places, found: Outcomes, seven: Arm
) -> None:
    free = 0
    for d in range(len(lessons)):
        which = np.full(N, d)
        plans = planner.plans(lessons, places, BENT, which, found.variant[:, d])
        for i, plan in enumerate(plans):
            assert plan.outcome.cause == found.cause[i, d]
            np.testing.assert_array_equal(plan.q[0], BENT)
            if not plan.success or not plan.approach:
                continue
            free += 1
            assert (seven.margin(plan.q) > -1e-12).all()
            first = plan.segment == 0
            way = plan.q[first]
            s = plan.s[first][:, None]
            np.testing.assert_allclose(way, BENT + s * (way[-1] - BENT), atol=1e-12)
            assert np.abs(np.diff(way, axis=0)).sum(axis=1).max() <= SPACING + 1e-9
            X_WE = seven.pose(plan.q)
            for segment in range(len(plan.guides)):
                X_WS = X_WE[plan.segment == segment][-1]
                assert translation_distance(X_WS, plan.guides[segment]) < 1e-4
                assert rotation_angle(X_WS, plan.guides[segment]) < 1e-3
            on = ~first
            screw = sclerp(
                plan.guides[plan.segment[on] - 1], plan.guides[plan.segment[on]], plan.s[on]
            )
            assert translation_distance(X_WE[on], screw).max() < 1e-3
    assert free > 10


def test_what_fails_on_another_way_to_the_first_guiding_pose_has_come_no_way(
    planner: BatchPlanner, lessons, places
) -> None:
    each = planner.variant_outcomes(lessons[0], places, BENT)
    turns = planner.symmetries.count(lessons[0])
    there = each.segment[:, turns:] == 0
    assert there.sum() > 100
    assert not each.fraction[:, turns:][there].any()
    assert each.fraction[:, :turns][each.segment[:, :turns] == 0].any()
    at = np.argwhere(there)[0]
    plan = planner.plan(lessons[0], places[at[0]], BENT, int(at[1]) + turns)
    assert plan.approach
    np.testing.assert_array_equal(plan.q, BENT[None])


def test_configurations_are_spread_within_the_limits_and_always_the_same(seven: Arm) -> None:
    chain = seven.screw_chain()
    some = seeds(chain, 50)
    assert some.shape == (50, 7)
    assert (some > chain.lower).all()
    assert (some < chain.upper).all()
    np.testing.assert_array_equal(some, seeds(chain, 50))
    np.testing.assert_array_equal(some[:20], seeds(chain, 20))
    assert np.ptp(some, axis=0).min() > 0.7 * (chain.upper - chain.lower).min()


def test_a_straight_way_of_no_length_has_both_its_ends() -> None:
    q, segment, s = straight(np.zeros(3), np.zeros(3))
    assert len(q) == len(segment) == len(s) == 2
