"""Rounded corners: near the path, within limits, and what a time law's spline goes along."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from drake_screw.execution.smooth_law import spline
from drake_screw.planning.paths import SPACING
from drake_screw.planning.rounding import BETWEEN, GAPS, rounded

ZIGZAG = np.array([[0.0, 0.0, 0.0], [1.0, 0.5, 0.0], [0.0, 1.0, 0.2], [0.0, 1.0, 0.8]])
PATHS = [ZIGZAG, ZIGZAG[:2], ZIGZAG[:3], np.array([[0.0, 0.0], [1e-3, 0.0], [1.0, 1.0]])]


def distance(q: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(m,) of points from a path."""
    found = []
    for a, b in itertools.pairwise(corners):
        share = np.clip((q - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        found.append(np.linalg.norm(q - a - share[:, None] * (b - a), axis=1))
    return np.min(found, axis=0)


@pytest.mark.parametrize("corners", PATHS, ids=len)
def test_curves_come_nearer_and_nearer_to_the_path(corners) -> None:
    curves = list(rounded(corners))
    assert len(curves) == len(GAPS)
    for q, gap in zip(curves, GAPS, strict=True):
        np.testing.assert_array_equal(q[[0, -1]], corners[[0, -1]])
        assert distance(q, corners).max() <= gap / 3.0
        assert (q >= corners.min(axis=0) - 1e-12).all()
        assert (q <= corners.max(axis=0) + 1e-12).all()
        assert np.abs(np.diff(q, axis=0)).sum(axis=1).max() <= 3.0 * BETWEEN < SPACING
    if corners is ZIGZAG:
        assert distance(curves[0], corners).max() > 8.0 * distance(curves[-1], corners).max()


@pytest.mark.parametrize("corners", PATHS, ids=len)
def test_a_spline_through_the_samples_stays_on_the_checked_lines(corners) -> None:
    """A time law moves along the spline; the lines between samples are what is checked."""
    for q, gap in zip(rounded(corners), GAPS, strict=True):
        path = spline(np.linspace(0.0, 1.0, len(q)), q)
        fine = path(np.linspace(0.0, 1.0, 20 * len(q)))
        assert distance(fine, q).max() <= gap / 64.0


def test_the_spline_is_the_curve_itself() -> None:
    """Sampled twice as finely, a curve is the same."""
    q = next(iter(rounded(ZIGZAG)))
    s = np.linspace(0.0, 1.0, len(q))
    whole, half = spline(s, q), spline(s[::2], q[::2])
    fine = np.linspace(0.0, 1.0, 1000)
    np.testing.assert_allclose(whole(fine), half(fine), atol=1e-9)
