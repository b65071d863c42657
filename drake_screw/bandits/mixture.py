"""Jeffreys mixture e-processes for one Bernoulli arm: pure functions of its counts.

Under a failure probability p, n samples with s failures have the likelihood p^s (1-p)^(n-s).
Averaging it over p with the Jeffreys prior, Beta(1/2, 1/2), and dividing by the likelihood at a
point t gives a nonnegative martingale that starts at 1 where t is the truth, so by Ville's
inequality it ever exceeds 1/delta with probability at most delta, however often one looks. With
the prior cut down to p <= t the same holds for every truth >= t (a supermartingale there), which
tests "p >= t"; cut down to p >= t it tests "p <= t".

Sources: Robbins, "Statistical methods related to the law of the iterated logarithm" (Ann. Math.
Statist. 1970), for the method of mixtures; Howard, Ramdas, McAuliffe, Sekhon, "Time-uniform,
nonparametric, nonasymptotic confidence sequences" (Ann. Statist. 2021), for truncated mixtures.

Everything is computed in logarithms, for any n, and broadcasts over n and s.
"""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import ArrayLike

from drake_screw.typing import Array

_SMALLEST = 1e-280  # Below it betainc may have lost digits to underflow.


def _ln_hypergeometric(a: Array, b: Array, t: Array) -> Array:
    """ln 2F1(a+b, 1; a+1; t), by its series of positive terms; needs t < (a+1) / (a+b)."""
    total = np.ones_like(a)
    term = np.ones_like(a)
    k = 0
    while (term > 1e-17 * total).any():
        term = term * (t * (a + b + k) / (a + 1.0 + k))
        total = total + term
        k += 1
    return np.log(total)


def ln_e_clear(n: ArrayLike, s: ArrayLike, t: ArrayLike) -> Array:
    """Logarithm of the evidence against "the failure probability is t or more".

    ln of the integral of p^(s-1/2) (1-p)^(n-s-1/2) over 0 <= p <= t, over the same integral for
    n = s = 0, over t^s (1-t)^(n-s).

    Args:
        n: samples.
        s: failures among them.
        t: a probability strictly between 0 and 1.

    Evidence of 20 shows with confidence 0.95 that a region fails less often than 5 % of the time.
    That takes 74 samples without a failure:

    >>> [bool(ln_e_clear(n, 0, 0.05) >= np.log(20)) for n in (73, 74)]
    [False, True]
    """
    x = np.asarray(t, dtype=float)
    failures = np.asarray(s, dtype=float)
    successes = np.asarray(n, dtype=float) - failures
    a, b = failures + 0.5, successes + 0.5
    share = scipy.special.betainc(a, b, x)
    prior = np.log(2.0 * np.arcsin(np.sqrt(x)))
    with np.errstate(divide="ignore"):
        value = np.log(share) + scipy.special.betaln(a, b) - prior
    value = value - failures * np.log(x) - successes * np.log1p(-x)
    tiny = share < _SMALLEST
    if tiny.any():
        value = np.array(value)
        a, b, x, prior = (np.broadcast_to(v, value.shape)[tiny] for v in (a, b, x, prior))
        value[tiny] = (
            0.5 * (np.log(x) + np.log1p(-x)) - np.log(a) + _ln_hypergeometric(a, b, x) - prior
        )
    return value


def ln_e_flag(n: ArrayLike, s: ArrayLike, t: ArrayLike) -> Array:
    """Logarithm of the evidence against "the failure probability is t or less".

    As `ln_e_clear`, with the integrals over t <= p <= 1.

    >>> bool(ln_e_flag(16, 4, 0.03) > np.log(20) > ln_e_flag(16, 1, 0.03))
    True
    """
    samples = np.asarray(n)
    return ln_e_clear(samples, samples - np.asarray(s), 1.0 - np.asarray(t, dtype=float))


def _p_log_p(p: Array) -> Array:
    return p * np.log(np.where(p > 0.0, p, 1.0))


def _upper_logit(n: Array, s: Array, c: float) -> Array:
    """logit of the larger solution p of g(p) = c, inf where there is none; `confidence_interval`.

    In terms of x = logit(p), g is convex with an asymptote on the right that lies below it, so
    Newton's method, started where the asymptote (or Pinsker's bound, if nearer) reaches c, descends
    monotonically to the solution.
    """
    f = n - s
    some = f > 0.0
    whole = np.maximum(n, 1.0)
    constant = scipy.special.betaln(s + 0.5, f + 0.5) - np.log(np.pi) - c
    x = -constant / np.where(some, f, 1.0)
    mean = s / whole
    slack = whole * (_p_log_p(mean) + _p_log_p(1.0 - mean)) - constant
    pinsker = mean + np.sqrt(0.5 * slack / whole)
    inside = some & (pinsker < 1.0)
    x = np.where(inside, np.minimum(x, scipy.special.logit(np.where(inside, pinsker, 0.5))), x)
    for _ in range(100):
        slope = n * scipy.special.expit(x) - s
        rising = some & (slope > 0.0)
        excess = constant - s * x + n * np.logaddexp(0.0, x)
        step = np.where(rising, excess / np.where(rising, slope, 1.0), 0.0)
        x = x - np.maximum(step, 0.0)
        if (step <= 1e-12 * (1.0 + np.abs(x))).all():
            break
    return np.where(some, x, np.inf)


def confidence_interval(n: ArrayLike, s: ArrayLike, c: float) -> tuple[Array, Array]:
    """Bounds on a failure probability that hold at every n at once, with probability 1 - exp(-c).

    The p whose whole (not cut down) mixture has not reached exp(c), that is g(p) < c with
    g(p) = ln B(s+1/2, n-s+1/2) - ln B(1/2, 1/2) - s ln p - (n-s) ln(1-p).

    Args:
        n: (...) samples.
        s: (...) failures among them.
        c: ln(1 / chance of error), positive.

    Returns:
        lower and upper end, each (...).

    >>> lower, upper = confidence_interval([100, 1000], [5, 50], c=np.log(20))
    >>> lower.round(3).tolist(), upper.round(3).tolist()
    ([0.007, 0.029], [0.156, 0.079])
    """
    samples, failures = np.broadcast_arrays(np.asarray(n, float), np.asarray(s, float))
    ends = _upper_logit(np.stack([samples, samples]), np.stack([samples - failures, failures]), c)
    return scipy.special.expit(-ends[0]), scipy.special.expit(ends[1])


def coverage_bound(n: ArrayLike, s: ArrayLike, delta: float) -> float:
    """beta': the success probability shown for every region at once, with confidence 1 - delta.

    1 - beta' is the smallest tau > max_j s_j / n_j at which every region would be cleared. The
    level is not divided among the regions: the bound is wrong only if the weakest region's own test
    errs. It holds at every look, for any rule of sampling.

    Args:
        n: (K,) samples.
        s: (K,) failures among them.
        delta: chance of error.

    Returns:
        beta', 0 where some region has no success.

    >>> round(coverage_bound([90, 90], [0, 0], delta=0.05), 3)
    0.959
    >>> coverage_bound([90, 16], [0, 16], delta=0.05)
    0.0
    """
    from scipy.optimize import brentq  # takes long to import

    samples, failures = np.atleast_1d(n), np.atleast_1d(s)
    if (samples == failures).any():
        return 0.0

    def excess(x: float) -> float:
        return float(ln_e_clear(samples, failures, scipy.special.expit(x)).min()) + np.log(delta)

    low = scipy.special.logit(np.max((failures + 1e-9) / (samples + 1e-9)))
    high = low + 1.0
    while excess(high) < 0.0:
        high += high - low
    return float(scipy.special.expit(-brentq(excess, low, high, xtol=1e-12)))
