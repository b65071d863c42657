"""The exact bounds against another program for them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binom, binomtest

from drake_screw.bandits.clopper_pearson import at_least, at_most, lower_bound, upper_bound


@pytest.mark.parametrize("alpha", [0.05, 1e-4])
@pytest.mark.parametrize(
    ("n", "s"), [(1, 0), (1, 1), (16, 0), (16, 1), (16, 15), (16, 16), (500, 7)]
)
def test_bounds_agree_with_scipys_exact_interval(n: int, s: int, alpha: float) -> None:
    interval = binomtest(s, n).proportion_ci(1.0 - 2.0 * alpha, method="exact")
    samples, failures = np.array([n]), np.array([s])
    assert lower_bound(samples, failures, alpha)[0] == pytest.approx(interval.low, rel=1e-9)
    assert upper_bound(samples, failures, alpha)[0] == pytest.approx(interval.high, rel=1e-9)


@pytest.mark.parametrize("p", [0.03, 0.5])
def test_tails_agree_with_scipys_binomial(p: float) -> None:
    s = np.arange(17)
    n = np.full_like(s, 16)
    np.testing.assert_allclose(at_most(n, s, p), binom.cdf(s, n, p), rtol=1e-10)
    np.testing.assert_allclose(at_least(n, s, p), binom.sf(s - 1, n, p), rtol=1e-10)
