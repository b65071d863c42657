"""Where the roll is free: a lane's guiding pose, rolled as far as the hand is as a segment begins.

Compiled as part of the code of an arm (kernel.py), and not on its own.
"""

from __future__ import annotations

import numpy as np

from drake_screw.planning.compiled.inner import inner
from drake_screw.planning.compiled.rows import POSE, TARGET, at


@inner
def roll_target(b, i, m, k, g, X_BO, X_OE):  # type: ignore[no-untyped-def]
    """Rolls the target about its z axis as far as the end effector is from pose X_BO X_OE."""
    cosine, sine = 0.0, 0.0
    for r in range(3):
        x, y = 0.0, 0.0
        for a in range(3):
            x += X_BO[m, k, r, a] * X_OE[g, a, 0]
            y += X_BO[m, k, r, a] * X_OE[g, a, 1]
        x_E, y_E = b[at(POSE + 4 * r, i)], b[at(POSE + 4 * r + 1, i)]
        cosine += x * x_E + y * y_E
        sine += y * x_E - x * y_E
    size = np.sqrt(cosine * cosine + sine * sine) + 1e-30
    cosine, sine = cosine / size, sine / size
    for r in range(3):
        x, y = b[at(TARGET + 4 * r, i)], b[at(TARGET + 4 * r + 1, i)]
        b[at(TARGET + 4 * r, i)] = cosine * x + sine * y
        b[at(TARGET + 4 * r + 1, i)] = cosine * y - sine * x
