"""The hand noise's filter, beside scipy's."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.acquisition.simulated.band_pass import filtered, second_order_sections
from drake_screw.acquisition.simulated.human import DRIFT, RATE, TREMOR

BANDS = (DRIFT.band, TREMOR.band, (5.0, 40.0))


@pytest.mark.parametrize("band", BANDS)
def test_the_filter_is_scipys_butterworth_band_pass(band: tuple[float, float]) -> None:
    from scipy.signal import butter

    expected = butter(2, band, "bandpass", fs=RATE, output="sos")
    np.testing.assert_allclose(second_order_sections(band, RATE), expected, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("band", BANDS)
@pytest.mark.parametrize("m", [16, 1500])
def test_filtering_both_ways_is_scipys(band: tuple[float, float], m: int) -> None:
    from scipy.signal import butter, sosfiltfilt

    values = np.random.default_rng(m).standard_normal((m, 3)) + 1.0
    expected = sosfiltfilt(butter(2, band, "bandpass", fs=RATE, output="sos"), values, axis=0)
    found = filtered(second_order_sections(band, RATE), values)
    np.testing.assert_allclose(found, expected, atol=1e-9)
