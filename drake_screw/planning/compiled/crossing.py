"""Where in a step a joint reaches a limit, by the cubics through the step's ends."""

from __future__ import annotations

import numpy as np

from drake_screw.planning.compiled.inner import inner
from drake_screw.planning.compiled.rows import STEP, at


@inner
def first_crossing(b, i, rows, limits):  # type: ignore[no-untyped-def]
    """The joint that first reaches a limit in the step, by the cubic through both its ends.

    Returns:
        joint (-1: none), fraction of the step.
    """
    n = rows.q_stage - rows.q
    slope0 = rows.q_stage + 2 * n
    step = b[at(STEP, i)]
    first, joint = 2.0, -1
    for j in range(n):
        q0, q1 = b[at(rows.q + j, i)], b[at(rows.q_stage + j, i)]
        d0, d1 = b[at(slope0 + j, i)] * step, b[at(slope0 + 6 * n + j, i)] * step
        for side in range(2):
            sign = 1.0 - 2.0 * side
            bound = limits[side, j]
            if np.isinf(bound):
                continue
            u = cubic_reaches_zero(sign * (q0 - bound), sign * d0, sign * (q1 - bound), sign * d1)
            if u < first:
                first, joint = u, j
    return joint, first


@inner
def cubic_reaches_zero(f0, d0, f1, d1):  # type: ignore[no-untyped-def]
    """The least u in [0, 1] where the cubic with these end values and slopes is not positive.

    Returns:
        u, or 2 where it stays positive.
    """
    if f0 <= 0.0:
        return 0.0
    c2, c3 = 3.0 * (f1 - f0) - 2.0 * d0 - d1, d0 + d1 - 2.0 * (f1 - f0)
    below = 0.0
    for above in extrema(d0, c2, c3):
        if f0 + above * (d0 + above * (c2 + above * c3)) <= 0.0:
            for _ in range(50):
                middle = 0.5 * (below + above)
                if f0 + middle * (d0 + middle * (c2 + middle * c3)) > 0.0:
                    below = middle
                else:
                    above = middle
            return above
        below = above
    return 2.0


@inner
def extrema(d0, c2, c3):  # type: ignore[no-untyped-def]
    """Where d0 + 2 c2 u + 3 c3 u^2 is zero in (0, 1), in order, and 1 at the end."""
    discriminant = c2 * c2 - 3.0 * c3 * d0
    if discriminant <= 0.0:
        return 1.0, 1.0, 1.0
    larger = -(c2 + (np.sqrt(discriminant) if c2 >= 0.0 else -np.sqrt(discriminant)))
    u1 = larger / (3.0 * c3) if c3 != 0.0 else 1.0
    u2 = d0 / larger
    u1 = u1 if 0.0 < u1 < 1.0 else 1.0
    u2 = u2 if 0.0 < u2 < 1.0 else 1.0
    return min(u1, u2), max(u1, u2), 1.0
