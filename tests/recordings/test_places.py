"""Where an object was, as a user says it: x and y alone will not always do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw.errors import RecordingError
from drake_screw.recordings.places import Given
from drake_screw.screws import pose_from_planar


def nowhere(time: float) -> np.ndarray:
    raise AssertionError(time)


def test_x_and_y_do_where_the_height_is_fixed() -> None:
    pose, how = Given("bowl", "0.9,0.1,0.5").pose(-0.06, nowhere)
    np.testing.assert_array_equal(pose, pose_from_planar([0.9, 0.1, 0.5], -0.06))
    assert how == "given, at the scenario's height -0.06 m"


def test_where_the_height_varies_all_of_a_pose_is_asked_for() -> None:
    with pytest.raises(RecordingError) as error:
        Given("bowl", "0.9,0.1").pose(None, nowhere)
    assert "object bowl: found x, y and perhaps yaw, which is not all" in str(error.value)
    assert "x,y,z,xyzw:0,0,0,1" in str(error.value)
    pose, _ = Given("bowl", "0.9,0.1,0.2,xyzw:0,0,0,1").pose(None, nowhere)
    np.testing.assert_allclose(pose[:3, 3], [0.9, 0.1, 0.2])


@pytest.mark.parametrize(
    ("place", "found"),
    [
        ("hand:1-2s", "'1-2'"),
        (((1.0, 2.0), (3.0,)), "'((1.0, 2.0), (3.0,))'"),
        ("", "''"),
        ((float("nan"), 0.0), "a number that is not finite"),
        ((1e308,) * 15 + (1.0,), "a matrix that is not a pose (its last row is 0,0,0,1)"),
    ],
)
def test_what_is_no_place_is_quoted_with_the_recordings_file(place: object, found: str) -> None:
    with pytest.raises(RecordingError) as error:
        Given("bowl", place, Path("log.csv")).pose(0.0, nowhere)
    assert str(error.value).startswith(f"log.csv: object bowl: found {found}\n  Give x,y or")
