"""The fastest way along a joint path within limits of velocity and acceleration.

Reachability analysis (TOPP-RA; Pham and Pham, "A New Approach to Time-Optimal Path Parameterization
Based on Reachability Analysis", IEEE Transactions on Robotics, 2018). In the squared rate
x = (ds/dt)^2, and u = d^2s/dt^2, which is constant between two grid points, the limits are linear:
(dq/dt)^2 = q'(s)^2 x and d^2q/dt^2 = q'(s) u + q''(s) x. From the end backwards, the largest x is
found from which the end can be reached; from the start forwards, the largest that can be reached.

Joints accelerate as much one way as the other, so to rest (x = u = 0) is always allowed. That makes
the method's linear programs minima over pairs of limits, and there is a law for every path. Drake's
Toppra, which takes limits of other kinds, too, solves them one by one: it gives the same laws.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drake_screw.compile_cache import cached_njit
from drake_screw.typing import Array

UNBOUNDED = 1e12
"""1/s^2, of x where no joint moves."""


@dataclass(frozen=True, eq=False)
class Law:
    """When a motion along a path is where, from rest to rest.

    Attributes:
        s: (m,) grid points, from one end of the path to the other.
        x: (m,) squared rate there, in 1/s^2; in between it is linear in s.
    """

    s: Array
    x: Array

    @cached_property
    def t(self) -> Array:
        """(m,) s, when each grid point is passed."""
        rate = np.sqrt(self.x)
        return np.concatenate([[0.0], np.cumsum(2.0 * np.diff(self.s) / (rate[:-1] + rate[1:]))])

    @property
    def duration(self) -> float:
        """Length in s."""
        return float(self.t[-1])

    def at(self, t: Array) -> tuple[Array, Array]:
        """s, and its rate in 1/s, at times t (m,) from 0 to the end."""
        i = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, len(self.t) - 2)
        change = (np.diff(self.x) / (2.0 * np.diff(self.s)))[i]
        elapsed, rate = t - self.t[i], np.sqrt(self.x[i])
        s = self.s[i] + elapsed * (rate + 0.5 * change * elapsed)
        return s, np.maximum(rate + change * elapsed, 0.0)


def fastest(
    s: Array,
    slope: Array,
    bend: Array,
    velocity: Array,
    acceleration: Array,
    most: Array | None = None,
) -> Law:
    """The fastest law along a path, from rest to rest, that keeps the limits at its grid points.

    At a grid point the acceleration jumps; it is within the limits before and after.

    Args:
        s: (m,) grid points, ascending; three at least.
        slope, bend: (m, n) first and second derivative of the joint path there, in rad (or m).
        velocity, acceleration: (n,) limits of the joints, positive; a velocity's may be infinite.
        most: (m,) 1/s^2, limit of x besides.
    """
    with np.errstate(divide="ignore"):
        x = np.min((velocity / np.abs(slope)) ** 2, axis=1)
    most = np.minimum(x, UNBOUNDED if most is None else most)
    x = np.minimum(most, UNBOUNDED)
    x[-1] = 0.0
    h = 2.0 * np.diff(s)
    # |a u + b x| <= 1 at both ends of each interval, in terms of x at its beginning: x gains h u.
    a = np.concatenate([slope[:-1], slope[1:] + h[:, None] * bend[1:]], axis=1)
    b = np.concatenate([bend[:-1], bend[1:]], axis=1)
    sign = np.where(a < 0.0, -1.0, 1.0) / np.tile(acceleration, 2)
    a, b = sign * a, sign * b
    _lower(x, h, a, b)
    if not x[1:-1].all():
        # Between grid points far apart it may come to rest. Between two laws there are others.
        slow = (s - s[0]) * (s[-1] - s)
        used = np.abs(a * (np.diff(slow) / h)[:, None] + b * slow[:-1, None]).max()
        x = 0.5 * (x + slow / max(used, np.max(slow / most)))
    return Law(s, x)


@cached_njit(error_model="numpy")
def _lower(x: Array, h: Array, a: Array, b: Array) -> None:
    """Lower bounds of x (m,), in place, to what the fastest law has.

    Args:
        x: 0 at the end.
        h: (m - 1,) what x gains over each interval, for a unit of u.
        a, b: (m - 1, k) coefficients of the limits there, a >= 0.
    """
    m, k = a.shape
    for i in range(m - 1, -1, -1):
        most, ahead = x[i], x[i + 1]
        for j in range(k):
            # u >= -(1 + b x) / a has to leave room for u <= (ahead - x) / h, so that x can go on,
            room = a[i, j] - h[i] * b[i, j]
            if room * most > a[i, j] * ahead + h[i]:
                most = (a[i, j] * ahead + h[i]) / room
            # u <= (1 - b x) / a for u >= -x / h, since there is no x below 0,
            if -room * most > h[i]:
                most = h[i] / -room
            # and either of them for those of the other limits.
            for other in range(j):
                cross = abs(b[i, j] * a[i, other] - b[i, other] * a[i, j])
                if cross * most > a[i, j] + a[i, other]:
                    most = (a[i, j] + a[i, other]) / cross
        x[i] = most
    x[0] = 0.0
    for i in range(m):
        most = x[i + 1]
        for j in range(k):
            gain = h[i] * (1.0 - b[i, j] * x[i])
            if a[i, j] > 0.0 and a[i, j] * (most - x[i]) > gain:
                most = x[i] + gain / a[i, j]
        x[i + 1] = max(most, 0.0)
