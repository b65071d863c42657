from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from drake_screw.planning import Cause
from drake_screw.visualization.palette import (
    ACCENT,
    OUTCOME_COLORS,
    OUTCOME_NAMES,
    UNKNOWN,
    contrast,
    failure_color,
    ink_on,
    linear_from_srgb,
)

# Machado, Oliveira and Fernandes (2009), severity 1.0, on linear light.
SIGHTS = {
    "normal": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
XYZ_FROM_LINEAR = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
D65 = np.array([0.95047, 1.0, 1.08883])


def lab(srgb: np.ndarray, sight: str) -> np.ndarray:
    """CIE L*a*b* of colours (..., 3) as somebody with this sight sees them."""
    linear = np.clip(linear_from_srgb(srgb) @ np.array(SIGHTS[sight]).T, 0.0, 1.0)
    t = linear @ XYZ_FROM_LINEAR.T / D65
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    x, y, z = np.moveaxis(f, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def test_every_cause_has_a_color_and_a_name() -> None:
    assert set(OUTCOME_COLORS) == set(OUTCOME_NAMES) == set(Cause)


@pytest.mark.parametrize("sight", SIGHTS)
def test_outcomes_and_suggestion_stay_apart(sight: str) -> None:
    colors = [OUTCOME_COLORS[c] for c in Cause if c != Cause.NOT_TRIED] + [ACCENT]
    seen = lab(np.array([to_rgb(c) for c in colors]), sight)
    assert min(np.linalg.norm(a - b) for a, b in combinations(seen, 2)) > 30.0


@pytest.mark.parametrize("sight", SIGHTS)
def test_failure_probability_gets_darker_all_the_way(sight: str) -> None:
    lightness = lab(failure_color(np.linspace(0.0, 1.0, 41)), sight)[:, 0]
    assert (np.diff(lightness) < 0.0).all()
    assert lightness[0] - lightness[-1] > 75.0


def test_a_region_without_samples_is_grey() -> None:
    np.testing.assert_allclose(failure_color([np.nan, 0.0])[0], to_rgb(UNKNOWN))
    assert not np.allclose(failure_color([np.nan, 0.0])[1], to_rgb(UNKNOWN))


def test_text_is_readable_on_every_cell() -> None:
    for color in failure_color(np.linspace(0.0, 1.0, 101)):
        assert contrast(to_rgb(ink_on(color)), color) > 4.0


def test_contrast_of_black_and_white_is_21() -> None:
    assert contrast((0, 0, 0), (1, 1, 1)) == pytest.approx(21.0)
    assert contrast((0.3, 0.4, 0.5), (0.3, 0.4, 0.5)) == pytest.approx(1.0)


def test_linear_light() -> None:
    np.testing.assert_allclose(
        linear_from_srgb([0.0, 0.04045, 0.5, 1.0]), [0.0, 0.0031308, 0.2140411, 1.0], atol=1e-6
    )
