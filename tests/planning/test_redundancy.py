"""More joints than six move away from their limits while the end effector follows its screws."""

from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np
import pytest

from drake_screw.planning import BatchPlanner, Outcomes, ReferencePlanner
from drake_screw.planning.compiled import Settings
from drake_screw.planning.compiled import rows as r
from drake_screw.planning.contract import away_from_limits, middle_and_half
from drake_screw.robot import Arm, ScrewChain
from drake_screw.screws import pose_from_planar
from tests.planning.compiled_arms import bench, random_chain
from tests.planning.test_batch import (
    MIDDLE,
    REACHING,
    assert_agrees_but_within_a_hair,
    demonstration,
)
from tests.planning.test_compiled_code import about_E, least_singular_value, plain_velocities
from tests.planning.test_reference import check_success, nearby, with_limits

AWAY = Settings(redundancy="away_from_limits")
NEAR = np.array([1.4, 0.9, -1.2, 1.7, 1.2, 1.1, -1.5])  # of most joints' limits
N = 200


def limited(chain: ScrewChain, *, unlimited: int | None = None) -> ScrewChain:
    """With limits of its own for each joint, or with none for one of them."""
    lower = -np.linspace(1.0, 3.0, chain.n)
    upper = np.linspace(2.5, 1.5, chain.n)
    if unlimited is not None:
        lower[unlimited], upper[unlimited] = -np.inf, np.inf
    return replace(chain, lower=lower, upper=upper)


def test_nothing_in_the_middle_third_and_steeper_towards_a_limit() -> None:
    lower, upper = np.array([-1.0, -1.0, 1.0]), np.array([1.0, 1.0, 5.0])
    velocities = np.array([3.0, 0.0, 4.0])

    def pull(x: float) -> np.ndarray:
        return away_from_limits(velocities, np.array([x, -x, 3.0 + 2.0 * x]), lower, upper)

    np.testing.assert_array_equal(pull(0.33), 0.0)
    for x in (0.4, 0.7, 0.95):
        z = pull(x)
        assert z[0] < 0.0
        np.testing.assert_allclose(z, z[0] * np.array([1.0, -1.0, 1.0]))
    assert pull(0.7)[0] == pytest.approx(-5.0 * (0.7 - 1.0 / 3.0) / (1.05 - 0.49))
    slopes = np.diff([pull(x)[0] for x in np.linspace(0.4, 1.0, 7)])
    assert (np.diff(slopes) < 0.0).all()
    assert np.isfinite(pull(5.0)).all()
    assert (away_from_limits(0.0 * velocities, np.full(3, 0.9), lower, upper) == 0.0).all()


def test_a_joint_without_limits_is_left_alone() -> None:
    lower, upper = np.array([-np.inf, -1.0, -np.inf]), np.array([np.inf, np.inf, 2.0])
    middle, half = middle_and_half(lower, upper)
    np.testing.assert_array_equal(middle, 0.0)
    np.testing.assert_array_equal(half, np.inf)
    assert (away_from_limits(np.ones(3), np.full(3, 50.0), lower, upper) == 0.0).all()


@pytest.mark.parametrize("n", [7, 8])
@pytest.mark.parametrize("unlimited", [None, 2])
def test_compiled_joint_velocities(n: int, unlimited: int | None) -> None:
    rng = np.random.default_rng(n)
    chain = limited(random_chain(rng, n, sliding=0.2), unlimited=unlimited)
    b = bench(chain, AWAY)
    q, V = rng.uniform(-1.5, 1.5, (r.LANES, n)), rng.normal(size=(r.LANES, 6))
    b.block[b.rows.q_stage : b.rows.q_stage + n] = q.T
    b.block[r.TWIST : r.TWIST + 6] = b.base_twist(V).T
    b.run("rate")
    got = b.block[b.rows.rate : b.rows.rate + n].T
    clear = least_singular_value(chain, q) > 0.05
    assert clear.sum() >= 4
    J, V_E = about_E(chain, q, V)
    moved = (J @ got[..., None])[..., 0]
    np.testing.assert_allclose(moved[clear], V_E[clear], atol=1e-7)
    least = plain_velocities(chain, q, V)
    for i in np.flatnonzero(clear):
        z = away_from_limits(least[i], q[i], chain.lower, chain.upper)
        want = least[i] + z - np.linalg.pinv(J[i]) @ (J[i] @ z)
        np.testing.assert_allclose(got[i], want, atol=1e-7)
        assert np.linalg.norm(got[i] - least[i]) > 1e-3


@pytest.mark.parametrize("n", [3, 6])
def test_up_to_six_joints_have_nothing_to_move_with(n: int) -> None:
    chain = random_chain(np.random.default_rng(n), n)
    plain, away = bench(chain), bench(chain, AWAY)
    assert {k: str(p) for k, p in plain.programs.items()} == {
        k: str(p) for k, p in away.programs.items()
    }


def test_nor_have_they_in_the_reference_planner(planar: Arm) -> None:
    q = np.array([0.4, 0.9, 0.4])
    guides = planar.pose(q + np.array([[0.1, -0.2, 0.1], [-0.2, 0.3, 0.2]]))
    plain = ReferencePlanner(planar, step=0.02).plan(q, guides)
    away = ReferencePlanner(planar, step=0.02, redundancy="away_from_limits").plan(q, guides)
    np.testing.assert_array_equal(plain.q, away.q)


@pytest.mark.parametrize("seed", range(4))
def test_the_screws_are_followed_further_from_the_limits(seven: Arm, seed: int) -> None:
    wide = with_limits(seven, 1.3 * seven.lower, 1.3 * seven.upper)
    guides = nearby(seven, NEAR, seed, 3)
    steps = {"step": 0.02, "joint_step": 0.01}
    plain = ReferencePlanner(wide, **steps).plan(NEAR, guides)
    away = ReferencePlanner(wide, **steps, redundancy="away_from_limits").plan(NEAR, guides)
    check_success(wide, plain, NEAR, guides)
    check_success(wide, away, NEAR, guides)

    def pressed(q: np.ndarray) -> float:
        """What the pull grows from: the sum of how far beyond the middle third joints are."""
        middle, half = middle_and_half(wide.lower, wide.upper)
        x = np.abs((q - middle) / half)
        return float((np.maximum(x - 1.0 / 3.0, 0.0) ** 2).sum())

    assert pressed(away.q[-1]) < pressed(plain.q[-1]) - 1e-3


@pytest.fixture(scope="module")
def lessons(seven: Arm):
    rng, made = np.random.default_rng(21), []
    for i in range(3):
        steps = rng.uniform(-0.3, 0.3, (2 + i, seven.n))
        X_WE = seven.pose(REACHING + np.cumsum(steps, axis=0))
        X_WO = pose_from_planar(MIDDLE + rng.uniform(-0.05, 0.05, (2, 3)))
        made.append(demonstration(X_WE, X_WO, rng.integers(0, 2, 2 + i), f"demo_{i}"))
    return tuple(made)


@pytest.fixture(scope="module")
def places() -> np.ndarray:
    spread = np.random.default_rng(22).uniform(-1.0, 1.0, (N, 2, 3)) * [0.2, 0.2, 0.5]
    return pose_from_planar(MIDDLE + spread)


@pytest.fixture(scope="module")
def planner(seven: Arm) -> BatchPlanner:
    return BatchPlanner(seven.screw_chain(), redundancy="away_from_limits")


@pytest.fixture(scope="module")
def answers(planner: BatchPlanner, lessons, places) -> Outcomes:
    return planner.all_outcomes(lessons, places, REACHING)


@pytest.mark.slow
def test_the_batch_planner_agrees_with_the_reference(seven: Arm, lessons, places, answers) -> None:
    same = [
        assert_agrees_but_within_a_hair(
            seven, REACHING, lessons[d].transfer(places[i]), answers[i, d], "away_from_limits"
        )
        for i in range(0, N, 25)
        for d in range(3)
    ]
    assert np.mean(same) >= 0.95


def test_it_ends_where_the_reference_does(
    planner: BatchPlanner, seven: Arm, lessons, places, answers
) -> None:
    plain = BatchPlanner(seven.screw_chain())
    both = answers.success & plain.all_outcomes(lessons, places, REACHING).success
    solved = np.flatnonzero(both[:, 2])[:3]
    assert len(solved) == 3
    reference = ReferencePlanner(seven, step=0.02, redundancy="away_from_limits")
    for i in solved:
        end = planner.plan(lessons[2], places[i], REACHING).q[-1]
        exact = reference.plan(REACHING, lessons[2].transfer(places[i])).q[-1]
        np.testing.assert_allclose(end, exact, atol=1e-3)
        other = plain.plan(lessons[2], places[i], REACHING).q[-1]
        assert np.abs(end - other).max() > 0.01


def test_more_succeeds_and_next_to_nothing_is_lost(
    planner: BatchPlanner, seven: Arm, lessons, places
) -> None:
    plain = BatchPlanner(seven.screw_chain()).all_outcomes(lessons, places, NEAR).success
    away = planner.all_outcomes(lessons, places, NEAR).success
    won, lost = away & ~plain, plain & ~away
    assert won.sum() >= 20
    assert lost.sum() <= won.sum() / 5


def test_limits_that_are_infinite_compile(seven: Arm, lessons, places) -> None:
    arm = copy.copy(seven)
    arm.lower, arm.upper = seven.lower.copy(), seven.upper.copy()
    arm.lower[6], arm.upper[6] = -np.inf, np.inf
    planner = BatchPlanner(arm.screw_chain(), redundancy="away_from_limits")
    answers = planner.all_outcomes(lessons, places[:20], REACHING)
    for i in range(0, 20, 4):
        assert_agrees_but_within_a_hair(
            arm, REACHING, lessons[0].transfer(places[i]), answers[i, 0], "away_from_limits"
        )
