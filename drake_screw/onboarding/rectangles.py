"""The best rectangle of good cells on a grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.typing import Array


@dataclass(frozen=True)
class Rectangle:
    """x and y: least and greatest, m."""

    x: tuple[float, float]
    y: tuple[float, float]

    @property
    def size(self) -> tuple[float, float]:
        """m, along x and y."""
        return self.x[1] - self.x[0], self.y[1] - self.y[0]

    @property
    def area(self) -> float:
        """m²."""
        return self.size[0] * self.size[1]

    def holds(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Whether points are in it; arrays broadcast."""
        eps = 1e-9
        inside = (x >= self.x[0] - eps) & (x <= self.x[1] + eps)
        return np.asarray(inside & (y >= self.y[0] - eps) & (y <= self.y[1] + eps))


def best_rectangle(
    x: Array,
    y: Array,
    good: NDArray[np.bool_],
    *,
    most: tuple[float, float],
    middle: tuple[float, float],
    within: Rectangle | None = None,
) -> Rectangle | None:
    """The largest rectangle whose corners are grid points and which holds none that is not good.

    Of rectangles of one size it is that whose middle is the nearest to a point.

    Args:
        x, y: (X,), (Y,) m, evenly spaced.
        good: (X, Y).
        most: m, size along x and y beyond which no rectangle is better.
        middle: (x, y) m.
        within: where it has to lie.

    Returns:
        None if no four neighbours are good.

    >>> import numpy as np
    >>> good = np.ones((4, 5), dtype=bool)
    >>> good[3, 4] = False
    >>> best_rectangle(np.arange(4.0), np.arange(5.0), good, most=(9.0, 9.0), middle=(1.5, 2.0))
    Rectangle(x=(0.0, 3.0), y=(0.0, 3.0))
    """
    if within is not None:
        good = good & within.holds(x[:, None], y[None, :])
    bad = np.pad(np.cumsum(np.cumsum(~good, axis=0), axis=1), ((1, 0), (1, 0)))
    best: tuple[tuple[float, float], Rectangle] | None = None
    for i in range(len(x)):
        for k in range(i + 1, len(x)):
            if x[k] - x[i] > most[0] + 1e-9:
                break
            for j in range(len(y)):
                for m in range(j + 1, len(y)):
                    if y[m] - y[j] > most[1] + 1e-9:
                        break
                    if bad[k + 1, m + 1] - bad[i, m + 1] - bad[k + 1, j] + bad[i, j]:
                        break
                    size = float((x[k] - x[i]) * (y[m] - y[j]))
                    off = np.hypot((x[k] + x[i]) / 2 - middle[0], (y[m] + y[j]) / 2 - middle[1])
                    key = round(size, 6), -round(float(off), 6)
                    if best is None or key > best[0]:
                        found = Rectangle((float(x[i]), float(x[k])), (float(y[j]), float(y[m])))
                        best = key, found
    return None if best is None else best[1]
