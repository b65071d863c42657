"""The motion of an end effector apart from the scatter of its samples."""

from __future__ import annotations

import numpy as np

from drake_screw.compile_cache import cached_njit
from drake_screw.screws import pose, quaternion_from_rotation, rotation_from_quaternion
from drake_screw.typing import Array

WINDOW = 0.15  # s, to both sides


def smoothed(X_WE: Array, t: Array) -> Array:
    """A path smoothed by parabolas fitted to the samples within `WINDOW` s of each.

    Positions and unit quaternions are smoothed number by number, as by Savitzky and Golay
    (Analytical Chemistry, 1964), but with the samples' own times. Steady motion on a line, a
    circle or about an axis passes nearly unchanged; samples farther apart than the window do, too.

    Args:
        X_WE: (m, 4, 4).
        t: (m,) s, increasing.

    Returns:
        (m, 4, 4).
    """
    q = quaternion_from_rotation(X_WE[:, :3, :3])
    flips = np.where(np.sum(q[1:] * q[:-1], axis=1) < 0.0, -1.0, 1.0)
    q *= np.cumprod(np.append(1.0, flips))[:, None]
    values = np.concatenate([X_WE[:, :3, 3], q], axis=1)
    values = _parabolas(values, np.asarray(t, dtype=float), WINDOW)
    return pose(rotation_from_quaternion(values[:, 3:]), values[:, :3])


@cached_njit()
def _parabolas(values: Array, t: Array, window: float) -> Array:
    m, n = values.shape
    result = values.copy()
    start, stop = 0, 0
    for i in range(m):
        while t[start] < t[i] - window:
            start += 1
        while stop < m and t[stop] <= t[i] + window:
            stop += 1
        if stop - start < 4:
            continue
        s1, s2, s3, s4 = 0.0, 0.0, 0.0, 0.0
        for k in range(start, stop):
            x = (t[k] - t[i]) / window
            s1, s2, s3, s4 = s1 + x, s2 + x * x, s3 + x**3, s4 + x**4
        c0, c1, c2 = s2 * s4 - s3 * s3, s2 * s3 - s1 * s4, s1 * s3 - s2 * s2
        determinant = (stop - start) * c0 + s1 * c1 + s2 * c2
        if determinant <= 1e-9:
            continue
        result[i] = 0.0
        for k in range(start, stop):
            x = (t[k] - t[i]) / window
            weight = (c0 + c1 * x + c2 * x * x) / determinant
            for c in range(n):
                result[i, c] += weight * values[k, c]
    return result
