"""Which column is the time, by the names that loggers give it."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.errors import RecordingError
from drake_screw.recordings.mapping import Mapping
from drake_screw.recordings.time_column import time_of
from drake_screw.tables import Table

STAMPS = np.arange(6) * 0.01


def table(**columns: np.ndarray) -> Table:
    return Table(columns, np.arange(2, 8), header=1)


@pytest.mark.parametrize(
    ("name", "scale"),
    [
        ("time, s", 1.0),
        ("Time in ms", 1e3),
        ("t [s]", 1.0),
        ("seconds", 1.0),
        ("millis", 1e3),
    ],
)
def test_names_of_time(name: str, scale: float) -> None:
    found = time_of(table(**{"q0": np.ones(6), name: STAMPS * scale}), Mapping())
    np.testing.assert_allclose(found.t, STAMPS, atol=1e-12)
    assert found.columns == (name,)


def refusal(**columns: np.ndarray) -> str:
    with pytest.raises(RecordingError, match="no column of time") as caught:
        time_of(table(**columns), Mapping())
    return str(caught.value)


def test_the_only_column_that_rises_is_suggested_as_the_time() -> None:
    still = np.array([0.5, 0.4, 0.6, 0.5, 0.5, 0.4])
    assert "'time: Zeit'" in refusal(q0=still, Zeit=STAMPS, counted=np.zeros(6))
    assert "'time: NAME'" in refusal(q0=still, counted=np.zeros(6))
    assert "'time: NAME'" in refusal(q0=STAMPS, Zeit=STAMPS)
