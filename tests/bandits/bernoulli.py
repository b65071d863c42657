"""Bernoulli arms to test on, and exact probabilities by dynamic programming."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache

import numpy as np
from scipy.stats import binom, binomtest

from drake_screw.bandits import Goal, Pull

GOAL = Goal(beta=0.95, epsilon=0.02, delta=0.05)


def arms(mu: np.ndarray, seed: int) -> Pull:
    """Regions that fail with probabilities mu (K,)."""
    rng = np.random.default_rng(seed)
    return lambda counts: rng.binomial(counts, mu)


def worst(mu: float, rest: float, K: int = 16) -> np.ndarray:
    """One region at mu among K at `rest`."""
    means = np.full(K, rest)
    means[0] = mu
    return means


def stopping_probability(
    stops: Callable[[int, np.ndarray], np.ndarray], looks: Iterable[int], mu: float
) -> float:
    """P(stops(n, failures) is true at some look), exactly, for one region that fails at mu.

    Args:
        stops: whether each of failures (m,) among n samples stops.
        looks: the increasing n at which one looks.
        mu: failure probability.
    """

    @cache
    def failures(count: int) -> np.ndarray:
        return binom.pmf(np.arange(count + 1), count, mu)

    alive = np.array([1.0])
    stopped, before = 0.0, 0
    for n in looks:
        alive = np.convolve(alive, failures(n - before))
        stop = stops(n, np.arange(len(alive)))
        stopped += alive[stop].sum()
        alive[stop] = 0.0
        alive = alive[: 1 + np.flatnonzero(alive >= 1e-15).max(initial=0)]
        before = n
    return float(stopped)


def at_most_plausible(events: int, runs: int, probability: float) -> bool:
    """Whether so many events in so many runs agree with a chance of at most `probability`.

    Rejects a true statement once in 10^4 times.
    """
    return bool(binomtest(events, runs, probability, alternative="greater").pvalue > 1e-4)
