"""Smooth laws: limits at every moment, without waiting for it at corners."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_screw.execution import smooth_law as module
from drake_screw.execution.smooth_law import Samples, smooth_law, spline
from drake_screw.planning.rounding import rounded

V, A = np.full(4, 1.0), np.full(4, 2.0)


def curves(seed: int) -> list[np.ndarray]:
    """Through five corners, from the roundest to the tightest."""
    return list(rounded(np.random.default_rng(seed).uniform(-0.7, 0.7, (5, 4))))


def law_of(q: np.ndarray, window: float = 0.1) -> Samples:
    return smooth_law(spline(np.linspace(0.0, 1.0, len(q)), q), V, A, window)


def largest(law: Samples) -> tuple[float, float]:
    """Velocity and acceleration of the cubics between samples, over their limits."""
    u = np.linspace(0.0, 1.0, 9)[:, None, None]
    rise, left, right = np.diff(law.q, axis=0), law.period * law.v[:-1], law.period * law.v[1:]
    b, c = 3.0 * rise - 2.0 * left - right, left + right - 2.0 * rise
    v, a = left + u * (2.0 * b + 3.0 * u * c), 2.0 * b + 6.0 * u * c
    return np.max(np.abs(v) / law.period / V), np.max(np.abs(a) / law.period**2 / A)


@settings(max_examples=20)
@given(st.integers(0, 10**6), st.integers(0, 4), st.sampled_from([0.02, 0.1, 0.3]))
def test_limits_hold_at_every_moment(seed, tight, window) -> None:
    law = law_of(curves(seed)[tight], window)
    velocity, acceleration = largest(law)
    assert velocity <= 1.0 + 1e-4
    assert acceleration <= 1.0 + 1e-9
    assert max(velocity, acceleration) > 0.9
    assert law.s[0] == 0.0
    assert law.s[-1] == pytest.approx(1.0, abs=1e-12)
    assert (np.diff(law.s) >= 0.0).all()


def test_a_corner_does_not_slow_down_what_is_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    paths = [curves(seed)[tight] for seed in range(4) for tight in (2, 4)]
    found = [law_of(q).duration for q in paths]
    monkeypatch.setattr(module, "ROUNDS", 0)
    whole = [law_of(q).duration for q in paths]
    gain = np.array(found) / whole
    assert (gain <= 1.0).all()
    assert gain.mean() < 0.95


@pytest.mark.parametrize("seed", range(3))
def test_acceleration_changes_over_the_window(seed) -> None:
    """At most from one limit to the other, in the time of a window: where a joint goes straight."""
    there = np.random.default_rng(seed).uniform(0.5, 1.0, 4)
    law = law_of(np.linspace(np.zeros(4), there, 30), window=0.2)
    jerk = np.diff(law.v, n=2, axis=0) / law.period**2
    assert np.abs(jerk).max() <= 2.0 * A[0] / 0.2 * (1.0 + 1e-3)


def test_a_law_slowed_is_the_same_motion() -> None:
    law = law_of(curves(1)[0])
    slow = law.slowed(2.0)
    assert slow.duration == 2.0 * law.duration
    assert largest(slow)[1] == pytest.approx(largest(law)[1] / 4.0)
    np.testing.assert_array_equal(slow.q, law.q)
