"""Where an arm's shapes are, and how far they travel between two configurations."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from drake_screw.planning.compiled.trace import dense_output
from drake_screw.planning.swept import motion, sweep
from tests.planning.compiled_arms import random_chain

place_arm, place_balls, as_polynomial = (
    getattr(function, "py_func", function)
    for function in (motion.place_arm, motion.place_balls, sweep.as_polynomial)
)


class Shaken:
    """A random arm with a few shapes on each link, as balls, at one configuration.

    Attributes:
        chain: the arm.
        joint: (M,) the last joint before each shape.
        p: (M, 3) m, middles at q = 0.
        reach: (M,) m.
    """

    def __init__(self, seed: int, n: int = 5, sliding: float = 0.4) -> None:
        rng = np.random.default_rng(seed)
        self.chain = random_chain(rng, n, sliding=sliding)
        self.joint = np.repeat(np.arange(n), 2)
        self.p, self.reach = rng.normal(size=(2 * n, 3)), rng.uniform(0.0, 0.5, 2 * n)
        self.cell = SimpleNamespace(
            screws=self.chain.screws,
            centers=np.ascontiguousarray(self.p.T),
            moved_joint=self.joint,
            moved_reach=self.reach,
            begin=np.searchsorted(self.joint, np.arange(n)),
        )
        M = 2 * n
        self.room = SimpleNamespace(
            clock=np.zeros(1, dtype=np.int64),
            E=np.tile(np.eye(4)[:3], (n + 1, 1, 1)),
            axes=np.zeros((n, 6)),
            q=rng.uniform(-3.0, 3.0, n),
            dq=rng.uniform(0.0, 0.6, n) * (rng.random(n) < 0.8),
            sines=np.zeros(n),
            cosines=np.zeros(n),
            centers=np.zeros((3, M)),
            way=np.zeros(M),
            travel=np.zeros(n * M),
        )
        place_arm(self.cell, self.room)
        place_balls(self.cell, self.room)
        self.travel = self.room.travel.reshape(n, M)

    def points(self, rng: np.random.Generator, count: int) -> np.ndarray:
        """(M, count, 4) points of the shapes at q = 0, most on the balls that hold them."""
        way = rng.normal(size=(len(self.p), count, 3))
        way *= (self.reach[:, None] / np.linalg.norm(way, axis=-1))[..., None]
        p = self.p[:, None] + way * rng.choice([0.3, 1.0, 1.0], (len(self.p), count, 1))
        return np.concatenate([p, np.ones((*p.shape[:2], 1))], axis=-1)


@pytest.mark.parametrize("seed", range(5))
def test_the_arm_is_where_its_screws_say(seed: int) -> None:
    arm = Shaken(seed)
    E = arm.chain.motions(arm.room.q[None])[:, 0]
    np.testing.assert_allclose(arm.room.E[1:], E[:, :3], atol=1e-12)
    J = arm.chain.jacobian(arm.room.q)
    np.testing.assert_allclose(arm.room.axes, J.T, atol=1e-12)
    p = np.einsum("mij,mj->mi", E[arm.joint], np.column_stack([arm.p, np.ones(len(arm.p))]))
    np.testing.assert_allclose(arm.room.centers.T, p[:, :3], atol=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1e-9, np.pi / 2, np.pi, -np.pi, 3.5 * np.pi, 100.0])
def test_the_arm_is_where_its_screws_say_at_any_angle(angle: float) -> None:
    arm = Shaken(1, sliding=0.0)
    arm.room.q[:] = angle
    place_arm(arm.cell, arm.room)
    E = arm.chain.motions(arm.room.q[None])[:, 0]
    np.testing.assert_allclose(arm.room.E[1:], E[:, :3], atol=1e-11)


@pytest.mark.parametrize("seed", range(8))
def test_no_point_travels_farther_than_its_bound(seed: int) -> None:
    """Nor seen from any link on the way, be the joints wherever within dq of q."""
    arm, rng = Shaken(seed, sliding=(0.0, 0.4, 1.0)[seed % 3]), np.random.default_rng(seed)
    n, q, dq = arm.chain.n, arm.room.q, arm.room.dq
    share = rng.uniform(-1.0, 1.0, (300, n))
    share[:200] = rng.choice([-1.0, 1.0], (200, n))
    points, E = arm.points(rng, 20), arm.chain.motions(np.vstack([q, q + share * dq]))
    before = np.concatenate([np.broadcast_to(np.eye(4), (1, 301, 4, 4)), E[:-1]])
    tightest = 0.0
    for k in range(n):
        seen = np.linalg.inv(before[k])
        for m in np.flatnonzero(arm.joint >= k):
            p = np.einsum("tij,pj->tpi", seen @ E[arm.joint[m]], points[m])[..., :3]
            gone = np.linalg.norm(p[1:] - p[0], axis=-1).max()
            assert gone <= arm.travel[k, m] + 1e-12
            tightest = max(tightest, gone / max(arm.travel[k, m], 1e-9))
    assert tightest > 0.8


def test_a_shape_does_not_travel_seen_from_its_own_link() -> None:
    """Only the joints that move it count, and of those only what moves the one it is seen from."""
    arm = Shaken(2)
    for m, last in enumerate(arm.joint):
        assert (arm.travel[last + 1 :, m] == 0.0).all()
        assert (np.diff(arm.travel[: last + 1, m]) <= 0.0).all()


def test_along_a_rail_the_bound_is_what_is_travelled() -> None:
    """It may not be larger either: all sliding joints along one line."""
    arm = Shaken(3, sliding=1.0)
    arm.cell.screws[:, 3:] = arm.cell.screws[0, 3:]
    place_arm(arm.cell, arm.room)
    place_balls(arm.cell, arm.room)
    dq = arm.room.dq
    for m, last in enumerate(arm.joint):
        behind = [dq[k : last + 1].sum() for k in range(arm.chain.n)]
        np.testing.assert_allclose(arm.travel[:, m], behind, atol=1e-12)


def some_steps(rng: np.random.Generator, count: int, n: int) -> np.ndarray:
    """Steps of a trace (count, 5, n), each of its parts large in some and nothing in others."""
    steps = rng.normal(size=(count, 5, n)) * rng.choice([0.0, 0.1, 3.0], (count, 5, n))
    steps[:, 1] = steps[:, 0] + steps[:, 1] * rng.choice([0.0, 1.0], (count, 1))
    return steps


def test_a_step_is_the_polynomial_of_its_dense_output() -> None:
    steps, u = some_steps(np.random.default_rng(4), 200, 3), np.linspace(0.0, 1.0, 23)
    v, room = 1.0 - u, SimpleNamespace(bend=np.zeros((5, 3)), fastest=np.zeros(3))
    bernstein = np.array([v**4, 4 * u * v**3, 6 * u**2 * v**2, 4 * u**3 * v, u**4])
    for step in steps:
        as_polynomial(step, room)
        dense = dense_output(np.tile(step, (23, 1, 1)), u)
        np.testing.assert_allclose(bernstein.T @ room.bend, dense, atol=1e-12)


def test_no_joint_is_faster_than_a_step_says() -> None:
    """Whatever of its ends and its middle is the fastest."""
    steps, u = some_steps(np.random.default_rng(5), 400, 3), np.linspace(0.0, 1.0, 401)
    room, tightest = SimpleNamespace(bend=np.zeros((5, 3)), fastest=np.zeros(3)), 0.0
    for step in steps:
        motion = as_polynomial(step, room)
        q = dense_output(np.tile(step, (401, 1, 1)), u)
        fastest = np.abs(np.diff(q, axis=0)).max(axis=0) * 400.0
        assert (fastest <= room.fastest + 1e-9).all()
        assert motion == pytest.approx(room.fastest.sum())
        assert motion >= np.abs(np.diff(q, axis=0)).sum() - 1e-9
        tightest = max(tightest, (fastest / np.maximum(room.fastest, 1e-9)).max())
    assert tightest > 0.98


def test_a_straight_line_goes_at_one_speed() -> None:
    way = np.array([0.3, -2.0, 0.0])
    step = np.array([np.ones(3), 1.0 + way, way, way, np.zeros(3)])
    room = SimpleNamespace(bend=np.zeros((5, 3)), fastest=np.zeros(3))
    as_polynomial(step, room)
    np.testing.assert_allclose(room.fastest, np.abs(way), atol=1e-12)
