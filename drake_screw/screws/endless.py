"""Joints without limits: continuous ones, whose angle counts modulo a turn."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.typing import Array

TURN = 2.0 * np.pi


def is_endless(lower: Array, upper: Array) -> NDArray[np.bool_]:
    """(n,) which joints have neither a lower nor an upper limit."""
    return np.asarray(np.isneginf(lower) & np.isposinf(upper))


def within_a_turn(lower: Array, upper: Array) -> tuple[Array, Array]:
    """Limits (n,) that hold every pose of the joints: -pi and pi where there are none."""
    endless = is_endless(lower, upper)
    return np.where(endless, -np.pi, lower), np.where(endless, np.pi, upper)


def middles(lower: Array, upper: Array) -> Array:
    """The middles (n,) of joint ranges, 0 where there are no limits."""
    low, high = within_a_turn(lower, upper)
    return np.asarray((low + high) / 2.0)


def brought_near(q: ArrayLike, reference: ArrayLike, endless: ArrayLike) -> Array:
    """The same configurations (..., n), by full turns at most half a turn from a reference.

    Args:
        q: (..., n) rad or m.
        reference: (..., n) likewise.
        endless: (n,) of which joints turns do not matter.
    """
    q = np.asarray(q, dtype=float)
    turns = np.round((q - np.asarray(reference, dtype=float)) / TURN)
    return np.asarray(np.where(endless, q - TURN * turns, q))


def unwrapped(q: Array, endless: ArrayLike) -> Array:
    """A path (m, n) without jumps by full turns, its first configuration within half a turn of 0.

    Args:
        q: rad or m.
        endless: (n,) of which joints turns do not matter.
    """
    smooth = np.unwrap(q, axis=0, period=TURN)
    first = brought_near(q[0], np.zeros(q.shape[1]), endless)
    return np.asarray(np.where(endless, smooth - smooth[0] + first, q))


def drawn_range(lower: Array, upper: Array, q: Array) -> tuple[Array, Array]:
    """The ranges (n,) to draw joints in at q (m, n): their limits.

    Without limits it is a turn, or more if need be, about the middle of what is drawn.
    """
    least, greatest = q.min(axis=0), q.max(axis=0)
    half = np.maximum(np.pi, 0.5 * (greatest - least))
    endless, middle = is_endless(lower, upper), 0.5 * (least + greatest)
    return np.where(endless, middle - half, lower), np.where(endless, middle + half, upper)
