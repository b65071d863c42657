"""Smoothing takes away scatter and leaves motion."""

from __future__ import annotations

import numpy as np

from drake_screw.demonstrations.smoothing import smoothed
from drake_screw.screws import exp, rotation_angle, translation_distance

RNG = np.random.default_rng(0)


def stirring(t: np.ndarray) -> np.ndarray:
    """A circle of 5 cm in 2 s, the end effector turning along, through a half turn and beyond."""
    turn = np.pi * t
    return exp(np.stack([turn, 0.0 * t, 0.0 * t], axis=1) @ np.eye(3, 6)) @ exp(
        [0, 0, 0, 0, 0.05, 0]
    )


def test_motion_passes_nearly_unchanged_at_any_times() -> None:
    t = np.sort(RNG.uniform(0.0, 4.0, 400))
    path = stirring(t)
    assert translation_distance(smoothed(path, t), path).max() < 5e-4
    assert rotation_angle(smoothed(path, t), path).max() < 5e-3


def test_samples_far_apart_stay_as_they_are() -> None:
    t = 0.2 * np.arange(20)
    np.testing.assert_allclose(smoothed(stirring(t), t), stirring(t), atol=1e-12)


def test_scatter_becomes_less() -> None:
    t = 0.01 * np.arange(400)
    path = stirring(t)
    noisy = path @ exp(RNG.normal(size=(400, 6)) * ([0.01] * 3 + [0.004] * 3))
    for distance in translation_distance, rotation_angle:
        before, after = distance(noisy, path), distance(smoothed(noisy, t), path)
        assert np.sqrt(np.mean(after**2)) < 0.45 * np.sqrt(np.mean(before**2))
