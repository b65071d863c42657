"""A Butterworth band pass that shifts nothing in time.

It computes what ``scipy.signal.sosfiltfilt`` does with ``scipy.signal.butter``, whose package takes
longer to import than a demonstration to be made.
"""

from __future__ import annotations

import numpy as np

from drake_screw.compile_cache import cached_njit
from drake_screw.typing import Array


def second_order_sections(band: tuple[float, float], rate: float) -> Array:
    """A digital Butterworth band pass of fourth order, by the bilinear transform.

    Oppenheim and Schafer, Discrete-Time Signal Processing, section 7.2.

    Args:
        band: Hz, where half the power passes; between 0 and half the rate.
        rate: Hz, of the samples.

    Returns:
        (2, 6): b0, b1, b2, a0 = 1, a1, a2 of each section, the pole nearest to the unit circle
        last.
    """
    lower, upper = 2.0 * np.tan(np.pi * np.asarray(band) / rate)
    half = 0.5 * (upper - lower) * np.exp(0.75j * np.pi)
    root = np.sqrt(half * half - lower * upper)
    poles = half + root, half - root
    z = sorted(((2.0 + pole) / (2.0 - pole) for pole in poles), key=abs)
    gain = (2.0 * (upper - lower)) ** 2 / np.prod([abs(2.0 - pole) ** 2 for pole in poles])
    return np.array(
        [
            [b * gain, 2.0 * sign * b * gain, b * gain, 1.0, -2.0 * one.real, abs(one) ** 2]
            for one, sign, b, gain in zip(z, (1.0, -1.0), (1.0, 1.0), (gain, 1.0), strict=True)
        ]
    )


def filtered(sections: Array, values: Array) -> Array:
    """Values filtered forwards and then backwards, so that the phases cancel.

    Before the first value and behind the last one they are taken to go on for a little while,
    turned about it by half a turn. Each pass starts as if its first value had been there for ever.

    Args:
        sections: (s, 6), as `second_order_sections` has them.
        values: (m, n), evenly spaced in time; more than 6 s + 3.

    Returns:
        (m, n).
    """
    more = 3 * (2 * len(sections) + 1)
    before = 2.0 * values[0] - values[more:0:-1]
    behind = 2.0 * values[-1] - values[-2 : -more - 2 : -1]
    x = np.concatenate([before, values, behind])
    state, passed = np.zeros((len(sections), 2)), 1.0
    for i, (b0, b1, b2, _, a1, a2) in enumerate(sections):
        first = (b1 - a1 * b0 + b2 - a2 * b0) / (1.0 + a1 + a2)
        state[i] = passed * first, passed * ((1.0 + a1) * first - (b1 - a1 * b0))
        passed *= (b0 + b1 + b2) / (1.0 + a1 + a2)
    for _ in range(2):
        _filter(sections, x, state[:, :, None] * x[0])
        x = x[::-1].copy()
    return x[more:-more]


@cached_njit()
def _filter(sections: Array, x: Array, state: Array) -> None:
    """Runs x (m, n) through sections from their state (s, 2, n), in place."""
    for k in range(x.shape[0]):
        for c in range(x.shape[1]):
            value = x[k, c]
            for i in range(sections.shape[0]):
                b0, b1, b2, _, a1, a2 = sections[i]
                result = b0 * value + state[i, 0, c]
                state[i, 0, c] = b1 * value - a1 * result + state[i, 1, c]
                state[i, 1, c] = b2 * value - a2 * result
                value = result
            x[k, c] = value
