"""What is drawn for what is not known exactly."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import kstest

from drake_screw.execution.noise import Noise
from drake_screw.tasks import Symmetry

SLIDES = np.array([False, True, False])
NOISE = Noise(object_position=5e-3, object_yaw=0.1, joint_offset=0.01, slide_offset=2e-3)


def drawn(noise: Noise, symmetries=(None, None), count=4000, seed=0):
    width = noise.width(len(symmetries), len(SLIDES))
    chance = np.random.default_rng(seed).random((count, width))
    return noise.drawn(chance, symmetries, SLIDES)


def test_every_number_is_normal_with_its_standard_deviation() -> None:
    """Each by an exact test at 1e-6, and none goes with another."""
    places, offsets = drawn(NOISE)
    assert places.shape == (4000, 2, 3)
    deviations = [*[5e-3, 5e-3, 0.1] * 2, 0.01, 2e-3, 0.01]
    columns = np.concatenate([places.reshape(-1, 6), offsets], axis=1)
    for column, deviation in zip(columns.T, deviations, strict=True):
        assert kstest(column / deviation, "norm").pvalue > 1e-6
    apart = np.corrcoef(columns.T) - np.eye(9)
    assert np.abs(apart).max() < 5.0 / np.sqrt(4000)


def test_another_spread_would_be_noticed() -> None:
    places, _ = drawn(NOISE)
    assert kstest(places[:, 0, 0] / 6e-3, "norm").pvalue < 1e-6


def test_what_may_be_turned_by_any_angle_has_no_yaw_to_mistake() -> None:
    places, _ = drawn(NOISE, (Symmetry(), Symmetry(turns=4)), 10)
    assert (places[:, 0, 2] == 0.0).all()
    assert (places[:, 0, :2] != 0.0).all()
    assert (places[:, 1, 2] != 0.0).all()
    lying, _ = drawn(NOISE, (Symmetry(axis=(1.0, 0.0, 0.0)), None), 10)
    assert (lying[:, 0, 2] != 0.0).all()


def test_without_noise_no_number_is_drawn_and_nothing_is_off() -> None:
    assert Noise().width(2, 3) == 0
    assert NOISE.width(2, 3) == 9
    places, offsets = drawn(Noise())
    assert not places.any()
    assert not offsets.any()
    assert Noise().words == ()
    assert "x and y of objects are measured to 0.005 m" in NOISE.words


@pytest.mark.parametrize("number", [0.0, 1.0 - 2.0**-53])
def test_the_ends_of_the_unit_interval_are_finite(number: float) -> None:
    places, _ = NOISE.drawn(np.full((1, 9), number), (None, None), SLIDES)
    assert np.isfinite(places).all()
    assert np.abs(places[..., :2]).max() < 9 * 5e-3
