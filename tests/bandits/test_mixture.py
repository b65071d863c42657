from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drake_screw.bandits.mixture import (
    confidence_interval,
    coverage_bound,
    ln_e_clear,
    ln_e_flag,
)

TAU, Q = 0.05, 0.03
counts = st.integers(0, 3000).flatmap(lambda n: st.tuples(st.just(n), st.integers(0, n)))
probabilities = st.floats(0.001, 0.999)


def ln_e_clear_by_quadrature(n: int, s: int, t: float) -> float:
    """Independent of the module: p = sin(x)^2, Gauss-Legendre where the integrand is not nil."""
    end = np.arcsin(np.sqrt(t))

    def ln_ratio(x: np.ndarray) -> np.ndarray:
        p = np.sin(x) ** 2
        return s * np.log(p / t) + (n - s) * np.log((1 - p) / (1 - t))

    grid = np.linspace(0.0, end, 200_001)[1:]
    values = ln_ratio(grid)
    largest = values.max()
    first = grid[np.argmax(values > largest - 45.0)] - grid[0]
    nodes, weights = np.polynomial.legendre.leggauss(200)
    half = (end - first) / 2
    x = first + half * (nodes + 1)
    return largest + np.log(half * weights @ np.exp(ln_ratio(x) - largest)) - np.log(end)


def test_clear_reproduces_reference_values() -> None:
    expected = [2.95992, 3.00478, 3.02555, 3.53360]
    np.testing.assert_allclose(
        ln_e_clear([73, 74, 131, 300], [0, 0, 1, 5], TAU), expected, atol=5e-6
    )


def test_flag_reproduces_reference_values() -> None:
    expected = [3.88039, 6.41851, 6.14969]
    np.testing.assert_allclose(ln_e_flag([16, 16, 2], [4, 5, 2], Q), expected, atol=5e-6)


@pytest.mark.parametrize(
    ("n", "s", "t"),
    [
        (0, 0, 0.05),
        (1, 1, 0.05),
        (300, 5, 0.05),
        (300, 290, 0.05),
        (5_000, 400, 0.05),
        (5_000, 4_000, 0.05),
        (100_000, 9_000, 0.05),
        (100_000, 1_000, 0.05),
        (1_000_000, 60_000, 0.05),
        (40, 20, 0.97),
        (2_000, 30, 1e-3),
    ],
)
def test_clear_agrees_with_quadrature(n: int, s: int, t: float) -> None:
    expected = ln_e_clear_by_quadrature(n, s, t)
    np.testing.assert_allclose(ln_e_clear(n, s, t), expected, rtol=1e-8, atol=1e-8)


def test_clear_is_continuous_where_the_incomplete_beta_function_underflows() -> None:
    s = np.arange(150, 900)
    values = ln_e_clear(1000, s, TAU)
    assert np.isfinite(values).all()
    assert (np.diff(values) < 0).all()
    assert (np.diff(values, 2) > 0).all()


def test_large_counts_stay_finite() -> None:
    n = np.array([10**6, 10**8, 10**9])
    for s in (0 * n, n // 20, n // 2, n):
        assert np.isfinite(ln_e_clear(n, s, TAU)).all()
        assert np.isfinite(ln_e_flag(n, s, Q)).all()


@given(counts, probabilities)
def test_clear_is_a_martingale_at_its_edge(ns: tuple[int, int], t: float) -> None:
    n, s = ns
    now = ln_e_clear(n, s, t)
    success, failure = ln_e_clear(n + 1, s, t), ln_e_clear(n + 1, s + 1, t)
    assert (1 - t) * np.exp(success - now) + t * np.exp(failure - now) == pytest.approx(1, abs=1e-8)


@given(counts, probabilities)
def test_flag_is_a_martingale_at_its_edge(ns: tuple[int, int], t: float) -> None:
    n, s = ns
    now = ln_e_flag(n, s, t)
    success, failure = ln_e_flag(n + 1, s, t), ln_e_flag(n + 1, s + 1, t)
    assert (1 - t) * np.exp(success - now) + t * np.exp(failure - now) == pytest.approx(1, abs=1e-8)


@given(counts, st.floats(0.01, 0.9), st.floats(0.0, 1.0))
def test_evidence_shrinks_on_average_inside_the_hypothesis(
    ns: tuple[int, int], t: float, part: float
) -> None:
    n, s = ns
    mu = t + part * (1 - t)
    now = ln_e_clear(n, s, t)
    success, failure = ln_e_clear(n + 1, s, t), ln_e_clear(n + 1, s + 1, t)
    assert (1 - mu) * np.exp(success - now) + mu * np.exp(failure - now) <= 1 + 1e-8


def test_evidence_starts_at_one() -> None:
    assert ln_e_clear(0, 0, TAU) == pytest.approx(0, abs=1e-12)
    assert ln_e_flag(0, 0, Q) == pytest.approx(0, abs=1e-12)


def test_confidence_interval_reproduces_reference_values() -> None:
    lower, upper = confidence_interval([100, 50, 1000], [0, 25, 30], np.log(320))
    np.testing.assert_allclose(lower, [0, 0.23897, 0.01214], atol=5e-6)
    np.testing.assert_allclose(upper, [0.08281, 0.76103, 0.05957], atol=5e-6)


@given(counts, st.floats(0.5, 40.0))
def test_confidence_interval_ends_where_the_mixture_reaches_its_level(
    ns: tuple[int, int], c: float
) -> None:
    n, s = ns
    lower, upper = confidence_interval(n, s, c)
    assert 0.0 <= lower <= upper <= 1.0
    assert (lower == 0.0) == (s == 0)
    assert (upper == 1.0) == (s == n) or upper > 1 - 1e-12
    # The mixture over all p is that over p <= t plus that over p >= t, with their prior weights.
    for end in (lower, upper):
        if 1e-9 < end < 1 - 1e-9:
            weight = 2 / np.pi * np.arcsin(np.sqrt(end))
            whole = np.logaddexp(
                np.log(weight) + ln_e_clear(n, s, end), np.log1p(-weight) + ln_e_flag(n, s, end)
            )
            assert whole == pytest.approx(c, abs=1e-6)


def test_coverage_bound_reproduces_reference_values() -> None:
    assert coverage_bound(74, 0, 0.05) == pytest.approx(1 - 0.049867, abs=1e-6)
    assert coverage_bound(300, 5, 0.05) == pytest.approx(1 - 0.047273, abs=1e-6)


def test_coverage_bound_is_that_of_the_weakest_region() -> None:
    single = [coverage_bound(n, s, 0.05) for n, s in ((74, 0), (300, 5), (100, 1))]
    assert coverage_bound([74, 300, 100], [0, 5, 1], 0.05) == pytest.approx(min(single))


def test_coverage_bound_is_zero_without_a_success() -> None:
    assert coverage_bound([16, 16], [0, 16], 0.05) == 0.0
    assert coverage_bound([16, 0], [0, 0], 0.05) == 0.0


@given(counts.filter(lambda ns: ns[0] > ns[1]), st.floats(1e-4, 0.4))
def test_coverage_bound_is_what_would_just_be_cleared(ns: tuple[int, int], delta: float) -> None:
    n, s = ns
    tau = 1 - coverage_bound(n, s, delta)
    assert s / n < tau <= 1
    if tau < 1 - 1e-9:
        assert ln_e_clear(n, s, tau) == pytest.approx(np.log(1 / delta), abs=1e-5)
