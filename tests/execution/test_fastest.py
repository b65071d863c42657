"""The fastest law: within limits, as Drake's Toppra has it, and there is one for every path."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.multibody.optimization import Toppra
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RevoluteJoint, SpatialInertia
from pydrake.trajectories import PiecewisePolynomial
from scipy.interpolate import CubicSpline

from drake_screw.execution.fastest import Law, fastest

V, A = np.array([1.5, 1.0, 2.0]), np.array([2.0, 3.0, 1.0])


def path_of(seed: int, points: int = 8, n: int = 3) -> CubicSpline:
    q = np.cumsum(np.random.default_rng(seed).normal(size=(points, n)), axis=0)
    return CubicSpline(np.linspace(0.0, 1.0, points), q)


def law_of(path: CubicSpline, s: np.ndarray, v: np.ndarray = V, a: np.ndarray = A) -> Law:
    return fastest(s, path(s, 1), path(s, 2), v, a)


def largest(law: Law, path: CubicSpline, v: np.ndarray = V, a: np.ndarray = A) -> tuple[float, ...]:
    """Velocity and, at the beginning and end of intervals, acceleration, over their limits."""
    u = np.diff(law.x)[:, None] / (2.0 * np.diff(law.s)[:, None])
    slope, bend, x = path(law.s, 1), path(law.s, 2), law.x[:, None]
    return (
        np.max(np.abs(slope) * np.sqrt(x) / v),
        np.max(np.abs(slope[:-1] * u + bend[:-1] * x[:-1]) / a),
        np.max(np.abs(slope[1:] * u + bend[1:] * x[1:]) / a),
    )


def toppra(path: CubicSpline, s: np.ndarray) -> PiecewisePolynomial:
    """Drake's law."""
    plant = MultibodyPlant(0.0)
    body = plant.world_body()
    for i in range(len(V)):
        link = plant.AddRigidBody(f"link{i}", SpatialInertia.Zero())
        joint = RevoluteJoint(f"joint{i}", body.body_frame(), link.body_frame(), [0.0, 0.0, 1.0])
        plant.AddJoint(joint)
        body = link
    plant.Finalize()
    spline = PiecewisePolynomial.CubicWithContinuousSecondDerivatives(path.x, path(path.x).T)
    drakes = Toppra(spline, plant, s)
    drakes.AddJointVelocityLimit(-V, V)
    drakes.AddJointAccelerationLimit(-A, A)
    return drakes.SolvePathParameterization()


@given(st.integers(0, 10**6), st.integers(5, 12), st.integers(2, 200), st.floats(0.5, 2.0))
def test_every_path_has_a_law_within_the_limits(seed, points, count, warp) -> None:
    path, s = path_of(seed, points), np.linspace(0.0, 1.0, count + 1) ** warp
    law = law_of(path, s)
    assert max(largest(law, path)) <= 1.0 + 1e-9
    assert law.x[0] == law.x[-1] == 0.0
    assert (law.x[1:-1] > 0.0).all()
    assert np.isfinite(law.duration)


@pytest.mark.parametrize("seed", range(6))
def test_it_is_the_law_of_drakes_toppra(seed) -> None:
    """But for the last interval, at whose end Toppra does not ask for the limits."""
    forth = np.arange(6.0)[:, None] + np.random.default_rng(seed).normal(scale=0.3, size=(6, 3))
    path, s = CubicSpline(np.linspace(0.0, 1.0, 6), forth), np.linspace(0.0, 1.0, 400)
    law, drakes = law_of(path, s), toppra(path, s)
    t = np.linspace(0.0, 1.0, 200)
    ours = law.at(t * law.duration)[0]
    theirs = drakes.vector_values(t * drakes.end_time())[0]
    assert law.duration == pytest.approx(drakes.end_time(), rel=4e-3)
    np.testing.assert_allclose(ours, theirs, atol=4e-3)


@pytest.mark.parametrize(("length", "expected"), [(4.0, 4.0 / 1.5 + 1.5 / 2.0), (0.5, 1.0)])
def test_one_joint_goes_by_the_textbook(length, expected) -> None:
    """Accelerates at 2, goes at 1.5 if there is room for it, and brakes at 2."""
    s = np.linspace(0.0, 1.0, 4001)
    slope, bend = np.full((len(s), 1), length), np.zeros((len(s), 1))
    law = fastest(s, slope, bend, V[:1], A[:1])
    assert law.duration == pytest.approx(expected, rel=1e-3)


def test_a_circle_is_gone_round_as_fast_as_the_way_inwards_allows() -> None:
    """With no limit of velocity; of two joints each turns back twice, so that q' is zero there."""
    s = np.linspace(0.0, 1.0, 2001)
    angle, turn = 2.0 * np.pi * s, 2.0 * np.pi
    slope = turn * np.stack([-np.sin(angle), np.cos(angle)], axis=-1)
    bend = -(turn**2) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    law = fastest(s, slope, bend, np.full(2, np.inf), np.ones(2))
    middle = law.x[500:1500] * turn**2
    assert middle.min() == pytest.approx(1.0, abs=1e-2)
    assert middle.max() <= np.sqrt(2.0) + 1e-2


def test_its_motion_is_what_its_rates_say() -> None:
    path, s = path_of(3), np.linspace(0.0, 1.0, 100)
    law = law_of(path, s)
    t = np.linspace(0.0, law.duration, 20001)
    there, rate = law.at(t)
    assert there[0] == 0.0
    assert there[-1] == pytest.approx(1.0)
    np.testing.assert_allclose(np.cumsum(rate) * t[1], there, atol=1e-3)
    assert np.abs(np.diff(rate)).max() < 0.02 * rate.max()
    np.testing.assert_allclose(law.at(law.t)[1] ** 2, law.x, atol=1e-9 * law.x.max())
    np.testing.assert_allclose(law.at(law.t)[0], law.s, atol=1e-12)


def test_looser_limits_are_never_slower() -> None:
    path, s = path_of(5), np.linspace(0.0, 1.0, 150)
    slow = law_of(path, s)
    assert law_of(path, s, v=2.0 * V).duration <= slow.duration
    assert law_of(path, s, a=2.0 * A).duration < slow.duration
    assert law_of(path, s, 2.0 * V, 4.0 * A).duration == pytest.approx(slow.duration / 2.0)
