"""An arm's programs, run in numpy, against the plain formulas in numpy."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from scipy.integrate import RK45

from drake_screw.planning.compiled import rows as r
from drake_screw.planning.compiled.arm_code import DAMPING
from drake_screw.planning.compiled.step_code import ERROR, TABLEAU, Settings
from drake_screw.planning.contract import RATE_LIMIT, RESIDUAL_LIMIT
from drake_screw.robot import ScrewChain
from drake_screw.screws import adjoint, exp, log
from tests.planning.compiled_arms import Bench, bench, random_chain

L = r.LANES
KINDS = list(product(range(1, 9), [0.0, 0.35], [False, True]))


def chain_of(n: int, sliding: float, square: bool) -> tuple[ScrewChain, np.random.Generator]:
    """A random arm whose joints are independent, and random numbers to go with it."""
    rng = np.random.default_rng([n, int(100 * sliding), square])
    while True:
        chain = random_chain(rng, n, sliding=sliding, square=square)
        if np.median(least_singular_value(chain, rng.uniform(-3.0, 3.0, (9, n)))) > 0.02:
            return chain, rng


def about_E(chain: ScrewChain, q: np.ndarray, V: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Jacobians (L, 6, n) and twists (L, 6) with the velocity of the end effector's origin."""
    J, p = chain.jacobian(q).copy(), chain.pose(q)[:, :3, 3]
    V = V.copy()
    V[:, 3:] += np.cross(V[:, :3], p)
    J[:, 3:] += np.cross(np.swapaxes(J[:, :3], 1, 2), p[:, None]).swapaxes(1, 2)
    return J, V


def plain_velocities(chain: ScrewChain, q: np.ndarray, V: np.ndarray) -> np.ndarray:
    """J^+ V (L, n), damped as documented, of twists in W."""
    J, V = about_E(chain, q, V)
    Jt = np.swapaxes(J, 1, 2)
    if chain.n < 6:
        return np.linalg.solve(Jt @ J + DAMPING * np.eye(chain.n), Jt @ V[..., None])[..., 0]
    return (Jt @ np.linalg.solve(J @ Jt + DAMPING * np.eye(6), V[..., None]))[..., 0]


def least_singular_value(chain: ScrewChain, q: np.ndarray) -> np.ndarray:
    return np.linalg.svd(about_E(chain, q, np.zeros((len(q), 6)))[0])[1].min(axis=-1)


def configurations(b: Bench, rng: np.random.Generator) -> np.ndarray:
    """(L, n), written to where stages are evaluated."""
    q = rng.uniform(-4.0, 4.0, (L, b.chain.n))
    b.block[b.rows.q_stage : b.rows.q_stage + b.chain.n] = q.T
    return q


@pytest.mark.parametrize(("n", "sliding", "square"), KINDS)
def test_joint_velocities(n: int, sliding: float, square: bool) -> None:
    chain, rng = chain_of(n, sliding, square)
    b = bench(chain)
    q, V = configurations(b, rng), rng.normal(size=(L, 6))
    b.block[r.TWIST : r.TWIST + 6] = b.base_twist(V).T
    b.run("rate")
    got = b.block[b.rows.rate : b.rows.rate + n].T
    want, s = plain_velocities(chain, q, V), least_singular_value(chain, q)
    clear = s > 1e-2
    error = np.abs(got - want).max(axis=1)[clear] * s[clear] ** 2
    assert (error < 1e-11).all()


@pytest.mark.parametrize(("n", "sliding", "square"), KINDS)
def test_arrive_and_aim(n: int, sliding: float, square: bool) -> None:
    chain, rng = chain_of(n, sliding, square)
    b, rows = bench(chain), r.Rows(n)
    q, goal = configurations(b, rng), chain.pose(rng.uniform(-3.0, 3.0, (L, n)))
    b.block[r.TARGET : r.TARGET + 12] = b.base_pose(goal).T
    b.run("arrive")
    X_WE = chain.pose(q)
    np.testing.assert_allclose(b.block[r.POSE : r.POSE + 12], b.base_pose(X_WE).T, atol=1e-12)
    off = X_WE - goal
    np.testing.assert_allclose(
        b.block[r.OFF_TURN], (off[:, :3, :3] ** 2).sum(axis=(1, 2)), atol=1e-11
    )
    np.testing.assert_allclose(b.block[r.OFF_PLACE], (off[:, :3, 3] ** 2).sum(axis=1), atol=1e-11)

    b.block[r.AIM], b.block[r.ACCEPTED], b.block[r.NEXT_STEP] = 1.0, 1.0, 0.1
    b.run("aim")
    V = log(goal @ np.linalg.inv(X_WE))
    turn = np.linalg.norm(V[:, :3], axis=1)
    clear = (turn < 3.1) & (least_singular_value(chain, q) > 1e-2)
    assert clear.any()
    np.testing.assert_allclose(
        b.block[r.TWIST : r.TWIST + 6].T[clear], b.base_twist(V)[clear], atol=1e-9
    )
    np.testing.assert_allclose(b.block[rows.q : rows.q + n], q.T)
    want = plain_velocities(chain, q, V)
    got = b.block[rows.slope(0) : rows.slope(0) + n].T
    np.testing.assert_allclose(got[clear], want[clear], rtol=1e-7, atol=1e-7)
    J, V_E = about_E(chain, q, V)
    rest = V_E - (J @ want[..., None])[..., 0]
    np.testing.assert_allclose(b.block[r.HAND][clear], (V_E**2).sum(axis=1)[clear], rtol=1e-9)
    tolerance = 1e-9 * (V_E**2).sum(axis=1)[clear]
    assert (np.abs(b.block[r.RESIDUAL] - (rest**2).sum(axis=1))[clear] <= tolerance + 1e-12).all()
    assert (b.block[r.PROGRESS] == 0.0).all()


def test_a_step_that_is_not_taken_changes_nothing() -> None:
    chain, rng = chain_of(7, 0.0, False)
    b, rows = bench(chain), r.Rows(7)
    configurations(b, rng)
    b.block[r.TARGET : r.TARGET + 12] = b.base_pose(chain.pose(np.zeros((L, 7)))).T
    b.run("arrive")
    b.block[[r.AIM, r.ACCEPTED, r.NEXT_STEP]] = [[1.0], [1.0], [0.1]]
    b.run("aim")
    kept = [
        slice(r.TWIST, r.TWIST + 6),
        slice(rows.q, rows.q + 7),
        slice(rows.slope(0), rows.slope(1)),
        slice(r.HAND, r.HAND + 1),
        slice(r.PROGRESS, r.PROGRESS + 1),
        slice(r.RESIDUAL, r.RESIDUAL + 1),
    ]
    before = [b.block[rows].copy() for rows in kept]
    configurations(b, rng)
    b.run("arrive")
    b.block[[r.AIM, r.ACCEPTED, r.NEXT_STEP]] = [[0.0], [0.0], [0.02]]
    b.run("aim")
    for old, rows_kept in zip(before, kept, strict=True):
        np.testing.assert_array_equal(b.block[rows_kept], old)


def test_the_pair_is_dormand_and_prince() -> None:
    for k, weights in enumerate(TABLEAU[:5], start=1):
        np.testing.assert_allclose(weights, RK45.A[k, :k])
    np.testing.assert_allclose(TABLEAU[5], RK45.B)
    np.testing.assert_allclose(np.abs(ERROR), np.abs(RK45.E), atol=1e-15)


@pytest.mark.parametrize("n", [3, 6, 7])
def test_a_whole_step(n: int) -> None:
    chain, rng = chain_of(n, 0.0, n == 3)
    settings = Settings()
    b, rows = bench(chain, settings), r.Rows(n)
    q0 = configurations(b, rng) / 3.0
    b.block[rows.q_stage : rows.q_stage + n] = q0.T
    goal = chain.pose(q0 + rng.uniform(-0.1, 0.1, (L, n)))
    b.block[r.TARGET : r.TARGET + 12] = b.base_pose(goal).T
    b.run("arrive")
    b.block[[r.AIM, r.ACCEPTED, r.NEXT_STEP]] = 1.0
    b.run("aim")
    h = b.block[r.STEP].copy()
    for k in range(1, 7):
        b.run(f"blend_{k}")
        if k < 6:
            b.run("rate")
    b.run("arrive")
    b.run("judge")

    V = log(goal @ np.linalg.inv(chain.pose(q0)))
    slopes = [plain_velocities(chain, q0, V)]
    for weights in TABLEAU:
        moved = q0 + h[:, None] * sum(w * k for w, k in zip(weights, slopes, strict=True))
        slopes.append(plain_velocities(chain, moved, V))
    clear = least_singular_value(chain, q0) > 0.03
    assert clear.sum() >= 4
    np.testing.assert_allclose(
        b.block[rows.q_stage : rows.q_stage + n].T[clear], moved[clear], atol=1e-7
    )
    speed = np.stack([(k**2).sum(axis=1) for k in slopes])
    np.testing.assert_allclose(b.block[r.RATE_START][clear], speed[0][clear], rtol=1e-5)
    np.testing.assert_allclose(b.block[r.RATE_END][clear], speed[6][clear], rtol=1e-5)
    error = h * np.abs(sum(e * k for e, k in zip(ERROR, slopes, strict=True))).max(axis=1)
    bound = RATE_LIMIT**2 * b.block[r.HAND]
    sure = clear & (np.abs(np.log(error / settings.tolerance)) > 0.01) & (speed.max(0) < bound)
    if n <= 6:
        J = about_E(chain, q0, V)[0]
        inner = np.linalg.det(np.swapaxes(J, 1, 2) @ about_E(chain, moved, V)[0])
        sure &= inner > 0.0
    np.testing.assert_array_equal(
        b.block[r.ACCEPTED][sure], (error < settings.tolerance)[sure].astype(float)
    )


@pytest.mark.parametrize("n", [2, 4, 6])
def test_orientation_turns_at_a_singularity(n: int) -> None:
    chain, rng = chain_of(n, 0.0, False)
    b, rows = bench(chain), r.Rows(n)
    q0 = configurations(b, rng)
    b.run("arrive")
    b.block[[r.AIM, r.ACCEPTED, r.NEXT_STEP]] = [[1.0], [1.0], [0.1]]
    b.run("aim")
    q1 = q0 + rng.uniform(-0.3, 0.3, (L, n))
    b.block[rows.q_stage : rows.q_stage + n] = q1.T
    b.run("arrive")
    J0, J1 = (chain.jacobian(q) for q in (q0, q1))
    if n == 6:
        want = np.linalg.det(J0) * np.linalg.det(J1)
        np.testing.assert_allclose(b.block[r.ORIENTATION], want, rtol=1e-6, atol=1e-12)
        assert (b.block[r.ORIENTATION] < 0.0).any()
    volume = np.linalg.det(np.swapaxes(J1, 1, 2) @ J1) if n == 6 else b.block[r.VOLUME_END]
    np.testing.assert_allclose(b.block[r.VOLUME_END], volume, rtol=1e-5, atol=1e-12)
    assert (
        b.block[r.ORIENTATION] ** 2
        <= b.block[r.VOLUME_START] * b.block[r.VOLUME_END] * 1.001 + 1e-18
    ).all()


@pytest.mark.parametrize(
    ("n", "slides"), [(3, ()), (4, (2,)), (5, (1,)), (6, (4,)), (7, (3,)), (8, ())]
)
def test_arms_that_are_redundant_in_a_plane(n: int, slides: tuple[int, ...]) -> None:
    """All axes parallel: J never has more than four independent columns."""
    rng = np.random.default_rng(n)
    z, names, limit = np.array([0.6, 0.0, 0.8]), tuple("abcdefgh"[:n]), np.full(n, 3.0)
    screws = np.concatenate(
        [np.tile(z, (n, 1)), np.cross(rng.normal(size=(n, 3)) * 0.4, z)], axis=1
    )
    for i in slides:
        screws[i] = [0.0, 0.0, 0.0, *z]
    chain = ScrewChain(names, screws, exp(rng.normal(size=6)), -limit, limit)
    b = bench(chain)
    q = configurations(b, rng)
    V = (chain.jacobian(q) @ rng.normal(size=(L, n, 1)))[..., 0]
    b.block[r.TWIST : r.TWIST + 6] = b.base_twist(V).T
    b.run("rate")
    J, V_E = about_E(chain, q, V)
    want = np.stack([np.linalg.pinv(j, rcond=1e-9) @ v for j, v in zip(J, V_E, strict=True)])
    got = b.block[b.rows.rate : b.rows.rate + n].T
    np.testing.assert_allclose(got, want, rtol=0, atol=1e-3)
    np.testing.assert_allclose((J @ got[..., None])[..., 0], V_E, rtol=0, atol=1e-5)


@pytest.mark.parametrize("n", [2, 4, 5, 6, 7])
def test_the_world_may_be_seen_from_anywhere(n: int) -> None:
    """Velocities do not depend on the frame, nor the residual that few joints leave of a twist."""
    chain, rng = chain_of(n, 0.3, False)
    X_VW = exp(rng.normal(size=6))
    moved = ScrewChain(
        chain.joint_names,
        chain.screws @ adjoint(X_VW).T,
        X_VW @ chain.home,
        chain.lower,
        chain.upper,
    )
    q, goal = rng.uniform(-2.0, 2.0, (L, n)), exp(rng.normal(size=(L, 6)) * 0.3)
    seen = []
    for one, X_WG in ((chain, goal @ chain.pose(q)), (moved, X_VW @ goal @ chain.pose(q))):
        b = bench(one)
        b.block[b.rows.q_stage : b.rows.q_stage + n] = q.T
        b.block[r.TARGET : r.TARGET + 12] = b.base_pose(X_WG).T
        b.run("arrive")
        b.block[[r.AIM, r.ACCEPTED, r.NEXT_STEP]] = [[1.0], [1.0], [0.1]]
        b.run("aim")
        seen.append((b.block[b.rows.slope(0) : b.rows.slope(1)].copy(), b.block[r.RESIDUAL].copy()))
    clear = least_singular_value(chain, q) > 0.02
    (v, residual), (v_moved, residual_moved) = seen
    np.testing.assert_allclose(v_moved[:, clear], v[:, clear], rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(residual_moved[clear], residual[clear], rtol=1e-6, atol=1e-9)
    if n < 6:
        assert (residual[clear] > 1e-4).all()


def judged(**rows: float) -> np.ndarray:
    """One judgement of a one-joint arm that moves from 0 by 0.1 at a steady rate, limits +-3."""
    chain = random_chain(np.random.default_rng(0), 1)
    b, places = bench(chain), r.Rows(1)
    values = {
        r.STEP: 0.1,
        r.HAND: 1.0,
        r.PROGRESS: 0.2,
        r.ORIENTATION: 1.0,
        r.VOLUME_START: 1.0,
        r.VOLUME_END: 1.0,
        places.q: 0.0,
        places.q_stage: 0.1,
    } | {places.slope(s): 1.0 for s in range(7)}
    for row, value in (values | {getattr(r, k): v for k, v in rows.items() if k.isupper()}).items():
        b.block[row] = value
    for name, value in rows.items():
        if name.startswith("slope_"):
            b.block[places.slope(int(name[-1]))] = value
        elif not name.isupper():
            b.block[getattr(places, name)] = value
    b.run("judge")
    return b.block[:, 0]


def test_judge_lets_a_plain_step_pass() -> None:
    lane = judged()
    assert lane[r.ACCEPTED] == 1.0
    assert lane[r.EVENT] == 0.0
    assert lane[r.NEXT_STEP] == pytest.approx(0.5)


def test_judge_sees_what_matters() -> None:
    assert judged(PROGRESS=0.9)[r.EVENT] == 1.0
    assert judged(q=2.95, q_stage=3.05)[r.EVENT] == 1.0
    assert judged(q=-2.95, q_stage=-3.05)[r.MARGIN] <= 0.0
    assert judged(RESIDUAL=1.01 * RESIDUAL_LIMIT**2)[r.EVENT] == 1.0
    assert judged(RESIDUAL=0.99 * RESIDUAL_LIMIT**2)[r.EVENT] == 0.0
    fast = 1.01 * RATE_LIMIT
    assert judged(slope_0=fast)[r.EVENT] == 1.0
    assert judged(STEP=1e-7, slope_6=fast)[r.EVENT] == 1.0
    for turned in (judged(ORIENTATION=-1e-6), judged(STEP=1e-3, slope_4=fast)):
        assert turned[r.ACCEPTED] == 0.0
        assert turned[r.NEXT_STEP] == pytest.approx(0.2 * turned[r.STEP])
    rough = judged(slope_3=20.0)
    assert rough[r.ACCEPTED] == 0.0
    assert rough[r.EVENT] == 0.0
    assert judged(STEP=1e-6, slope_3=80.0, ORIENTATION=-1.0)[r.EVENT] == 1.0


def test_judge_approaches_the_end_of_reach_by_parts() -> None:
    slow = judged(STEP=0.01, slope_0=1.0, slope_6=1.1)
    ahead = 0.01 / (1.1**2 - 1.0)
    assert slow[r.NEXT_STEP] <= Settings().approach * ahead * 1.0001
    shrinking = judged(STEP=0.1, VOLUME_END=0.25)
    assert shrinking[r.NEXT_STEP] == pytest.approx(Settings().approach * 0.1)
