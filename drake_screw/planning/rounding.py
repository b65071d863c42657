"""Corners of a joint path rounded, so that an arm need not stop at them.

The path becomes a cubic B-spline whose control points lie on the path: a curve without jumps in
its second derivative, within joint limits wherever the path is, and the nearer to the path the
closer the control points (de Boor, A Practical Guide to Splines, 1978, chapter XI). It is sampled
at all its knots and between them, which leaves one cubic spline through the samples: the curve
itself. So a time law that follows a spline through a plan's points moves along it to the last bit.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from drake_screw.typing import Array

GAPS = (0.4, 0.2, 0.1, 0.05, 0.025)
"""rad (or m), summed up over the joints, between control points at most: widest, roundest first."""

BETWEEN = 0.025
"""rad (or m), summed up over the joints, between two samples at most; thrice that at the ends."""

FEWEST = 4
"""Samples in a gap between knots at least."""


def rounded(corners: Array) -> Iterator[Array]:
    """Curves along a path of straight lines, from the roundest to the one nearest to it.

    A curve leaves the path by a third of a gap of GAPS at most, and only at corners. Between two
    samples it leaves the straight line by 1/64 of a gap at most.

    Args:
        corners: (c, n) rad or m, c >= 2.

    Yields:
        (m, n) samples at even steps of the curve's parameter, from the first corner to the last.
    """
    from scipy.interpolate import BSpline  # takes long to import

    for gap in GAPS:
        control = _control_points(corners, gap)
        spans = len(control) - 3
        parts = max(FEWEST, int(np.ceil(gap / BETWEEN)))
        knots = np.concatenate([np.zeros(3), np.arange(spans + 1), np.full(3, spans)])
        u = np.linspace(0.0, spans, spans * parts + 1)
        q = BSpline(knots.astype(float), control, 3)(u)
        q[0], q[-1] = corners[0], corners[-1]
        yield q


def _control_points(corners: Array, gap: float) -> Array:
    """(p, n) points on a path through corners (c, n), a gap apart at most; four at least."""
    pieces = [corners[:1]]
    least = -(-3 // (len(corners) - 1))
    for a, b in itertools.pairwise(corners):
        parts = max(int(np.ceil(np.abs(b - a).sum() / gap)), least)
        share = np.arange(1, parts + 1)[:, None] / parts
        pieces.append(a + share * (b - a))
    return np.concatenate(pieces)
