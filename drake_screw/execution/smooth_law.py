"""A time law along a joint path with continuous acceleration, as fast as limits allow.

The `fastest` law jumps from one acceleration to another, and keeps the limits only at its grid
points. A moving average over a window makes the acceleration continuous. Round a corner the average
may be too fast, where the fastest law is slow for less than the window: it is checked closely, as
it is played, and found once more with that part slowed down. What exceeds a limit even then slows
the whole down.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from drake_screw.execution.fastest import Law, fastest
from drake_screw.typing import Array

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

FINE = 1e-3  # s, between points at which the fastest law is averaged
EVERY = 4  # of them one is a sample
GRID = 120
"""Intervals at least, at whose ends the fastest law keeps the limits. The path's own points are
among them: its second derivative is straight between two."""
RESERVE = 0.99  # part of the limits that the fastest law may use
ROUNDS = 4  # of slowing down where a limit is exceeded, at most
ENOUGH = 1.01  # times as slow as the limits allow: that is left


@dataclass(frozen=True, eq=False)
class Samples:
    """A motion along a path from rest to rest, sampled evenly; cubics in between.

    Attributes:
        period: s between samples.
        s, rate: (m,) where on the path, from 0 to 1, and its time derivative in 1/s.
        q, v: (m, n) joint path, rad (or m), and its time derivative.
    """

    period: float
    s: Array
    rate: Array
    q: Array
    v: Array

    @property
    def duration(self) -> float:
        """Length in s."""
        return self.period * (len(self.s) - 1)

    def slowed(self, times: float) -> Samples:
        """The same motion so many times as slow."""
        return Samples(self.period * times, self.s, self.rate / times, self.q, self.v / times)


def smooth_law(path: CubicSpline, velocity: Array, acceleration: Array, window: float) -> Samples:
    """A time law along a path, from rest to rest.

    Args:
        path: joint positions over [0, 1], as `spline` makes it.
        velocity, acceleration: (n,) limits of the joints.
        window: s, over which the acceleration changes.
    """
    from scipy.ndimage import maximum_filter1d  # takes long to import

    grid = _grid(path.x)
    slope, bend = path(grid, 1), path(grid, 2)
    most, found = np.full(len(grid), np.inf), []
    for _ in range(1 + ROUNDS):
        law = fastest(grid, slope, bend, RESERVE * velocity, RESERVE * acceleration, most)
        samples, excess = _smoothed(law, path, velocity, acceleration, window)
        slower = max(1.0, float(excess.max()))
        found.append(samples.slowed(slower))
        if slower < ENOUGH:
            break
        # The average at a time is of the law in the window before it.
        size = 2 + _steps(window) // EVERY
        about = maximum_filter1d(excess, size, origin=-(size // 2), mode="nearest")
        about = np.interp(law.t[1:-1], samples.period * np.arange(len(about)), about)
        slowed = law.x[1:-1] / np.maximum(about, 1.0) ** 2
        most[1:-1] = np.minimum(most[1:-1], np.where(about > 1.0, slowed, np.inf))
    return min(found, key=lambda samples: samples.duration)


def spline(s: Array, q: Array) -> CubicSpline:
    """A twice differentiable path through points; those nearly in one place count once.

    Args:
        s: (m,) from 0 to 1.
        q: (m, n) rad or m.
    """
    from scipy.interpolate import CubicSpline  # takes long to import

    kept = np.concatenate([[True], (np.diff(s) > 1e-6) & (s[1:] < 1.0 - 1e-6)])
    s, q = np.append(s[kept], 1.0), np.concatenate([q[kept], q[-1:]])
    if len(s) < 5:
        even = np.linspace(0.0, 1.0, 5)
        s, q = even, np.stack([np.interp(even, s, angle) for angle in q.T], axis=-1)
    return CubicSpline(s, q)


def _grid(s: Array) -> Array:
    """All of a path's points s (m,), and as many between any two that there are GRID intervals."""
    parts = -(-GRID // (len(s) - 1))
    return np.interp(np.arange((len(s) - 1) * parts + 1) / parts, np.arange(len(s)), s)


def _smoothed(
    law: Law, path: CubicSpline, velocity: Array, acceleration: Array, window: float
) -> tuple[Samples, Array]:
    """A law averaged over a window, and how much too fast it is at samples (m,); 1 is the limit.

    The average of shifted copies of a law has the average of their derivatives.
    """
    width = _steps(window)
    last = EVERY * int(np.ceil((np.ceil(law.duration / FINE) + width) / EVERY))
    t = FINE * np.arange(last + 1)
    moving = t <= law.duration
    s, rate = law.at(np.minimum(t, law.duration))
    box = np.full(width, 1.0 / width)
    s, rate = (np.convolve(values, box)[: last + 1 : EVERY] for values in (s, rate * moving))
    s = np.clip(s, 0.0, 1.0)
    samples = Samples(EVERY * FINE, s, rate, path(s), path(s, 1) * rate[:, None])
    excess = np.max(np.abs(samples.v) / velocity, axis=1)
    played = np.sqrt(np.max(_accelerations(samples) / acceleration, axis=1))
    excess[:-1] = np.maximum(excess[:-1], played)
    excess[1:] = np.maximum(excess[1:], played)
    return samples, excess


def _steps(window: float) -> int:
    """A window in steps of FINE."""
    return max(1, round(window / FINE))


def _accelerations(samples: Samples) -> Array:
    """(m - 1, n) the largest of the cubics between samples; they are at either end."""
    rise, v = np.diff(samples.q, axis=0) / samples.period, samples.v
    first, last = 3.0 * rise - 2.0 * v[:-1] - v[1:], v[:-1] + 2.0 * v[1:] - 3.0 * rise
    return np.maximum(np.abs(first), np.abs(last)) * (2.0 / samples.period)
