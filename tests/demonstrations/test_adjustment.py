"""Guiding poses are moved to where the screws between them are nearer to samples."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_screw.demonstrations.adjustment import adjusted
from drake_screw.demonstrations.screw_fit import poses_on_screws
from drake_screw.screws import (
    exp,
    pose,
    quaternion_from_rotation,
    rotation_angle,
    rotation_from_quaternion,
    sclerp,
    translation_distance,
)
from tests.demonstrations.test_faithful import held_in_order

CUTS = np.array([0, 70, 160, 240])
TOLERANCES = 0.010, 0.1


def shown(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Four guiding poses and the samples on the three screws between them, at `CUTS` theirs."""
    guides = [exp(rng.uniform(-1.0, 1.0, 6))]
    for _ in range(3):
        guides.append(guides[-1] @ exp([*rng.uniform(-0.6, 0.6, 3), *rng.uniform(-0.15, 0.15, 3)]))
    parts = [
        sclerp(A, B, np.arange(n) / n)
        for A, B, n in zip(guides, guides[1:], np.diff(CUTS), strict=False)
    ]
    return np.stack(guides), np.concatenate([*parts, guides[-1:]])


def moved(X: np.ndarray, rng: np.random.Generator, place: float, turn: float) -> np.ndarray:
    """Poses moved by that much in random directions."""
    w, p = rng.normal(size=(2, len(X), 3))
    w, p = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (w, p))
    R = exp(np.concatenate([turn * w, 0.0 * w], axis=1))[:, :3, :3]
    return pose(R @ X[:, :3, :3], X[:, :3, 3] + place * p)


def test_poses_on_screws_are_sclerp() -> None:
    guides, _ = shown(np.random.default_rng(0))
    q = quaternion_from_rotation(guides[:, :3, :3])
    p, q = poses_on_screws(np.ascontiguousarray(guides[:, :3, 3]), q, 7)
    expected = sclerp(guides[:-1, None], guides[1:, None], np.linspace(0.0, 1.0, 7))
    np.testing.assert_allclose(pose(rotation_from_quaternion(q), p), expected, atol=1e-12)


@pytest.mark.slow
@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_guiding_poses_find_back_to_screws_that_were_shown(seed: int) -> None:
    rng = np.random.default_rng(seed)
    guides, samples = shown(rng)
    found = adjusted(moved(guides, rng, 0.008, 0.08), CUTS, samples, *TOLERANCES)
    assert found.share < 0.5
    assert held_in_order(samples, found.X_WE, 0.005, 0.05)


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_samples_that_scatter_are_nearer_than_before_and_within_the_share(seed: int) -> None:
    rng = np.random.default_rng(seed)
    guides, samples = shown(rng)
    samples = moved(samples, rng, 0.004, 0.04)
    start = moved(guides, rng, 0.004, 0.04)
    found = adjusted(start, CUTS, samples, *TOLERANCES)
    closely = 1.01 * found.share
    assert held_in_order(samples, found.X_WE, closely * 0.010, closely * 0.1)
    assert not held_in_order(samples, start, found.share * 0.0099, found.share * 0.099)
    Y = exp(rng.uniform(-2.0, 2.0, 6))
    elsewhere = adjusted(Y @ start, CUTS, Y @ samples, *TOLERANCES)
    assert elsewhere.share == pytest.approx(found.share, abs=0.05)


def test_one_sample_thrown_off_is_met_half_way() -> None:
    line = np.tile(np.eye(4), (49, 1, 1))
    line[:, 0, 3] = np.linspace(0.0, 0.2, 49)
    samples = line.copy()
    samples[24, 1, 3] = 0.012
    found = adjusted(line[[0, 48]], np.array([0, 48]), samples, *TOLERANCES)
    assert found.share == pytest.approx(0.6, abs=0.05)
    np.testing.assert_allclose(found.X_WE[:, 1, 3], 0.006, atol=5e-4)
    assert rotation_angle(found.X_WE, line[[0, 48]]).max() < 1e-6


@pytest.mark.parametrize("still", [False, True])
def test_what_fits_stays_as_it_is(still: bool) -> None:
    path = np.tile(np.eye(4), (49, 1, 1))
    if not still:
        path[:, 0, 3] = np.linspace(0.0, 0.2, 49)
    found = adjusted(path[[0, 48]], np.array([0, 48]), path, *TOLERANCES)
    assert found.share < 1e-6
    assert translation_distance(found.X_WE, path[[0, 48]]).max() < 1e-6
