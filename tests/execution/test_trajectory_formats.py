"""Exported plans, read back."""

from __future__ import annotations

import io

import numpy as np
import pytest
import yaml

from drake_screw.demonstrations import read_recording
from drake_screw.demonstrations.baxter_csv import COLUMNS
from drake_screw.execution.trajectory_formats import PERIOD, baxter_csv, npz, ros_trajectory


def test_baxter_csv_round_trips_through_our_reader(timed, arm, tmp_path) -> None:
    (tmp_path / "joint_angles.csv").write_bytes(baxter_csv(timed, arm))
    pose = "\n".join(",".join(str(v) for v in row) for row in np.eye(4).tolist())
    (tmp_path / "object_poses.csv").write_text(pose + "\n")
    recording = read_recording(tmp_path, arm.joint_names, arm.lower, arm.upper)
    t, q, _ = timed.sampled(PERIOD)
    # The reader leaves one sample of a still head, and of a still tail.
    away = np.abs(q[:, None] - recording.q[None, 1:-1]).max(axis=-1)
    found = np.argmin(away, axis=0)
    assert away.min(axis=0).max() < 1e-9
    np.testing.assert_array_equal(np.diff(found), 1)
    np.testing.assert_allclose(np.diff(recording.t[1:-1]), np.diff(t[found]), atol=2e-6)
    np.testing.assert_allclose(recording.q[[0, -1]], q[[0, -1]], atol=3e-3)
    assert len(found) > 0.8 * len(t)


def test_baxter_csv_has_all_that_the_playback_program_wants(timed, arm, robot) -> None:
    lines = baxter_csv(timed, arm).decode().splitlines()
    assert lines[0].split(",") == ["time", *COLUMNS]
    table = np.array([[float(v) for v in line.split(",")] for line in lines[1:]])
    t, q, _ = timed.sampled(PERIOD)
    np.testing.assert_allclose(table[:, 0], t, atol=1e-6)
    assert (np.diff(table[:, 0]) > 0).all()
    columns = dict(zip(["time", *COLUMNS], table.T, strict=True))
    for i, name in enumerate(arm.joint_names):
        np.testing.assert_allclose(columns[name], q[:, i], atol=1e-9)
    for name, angle in robot.parked.items():
        np.testing.assert_array_equal(columns[name], angle)
    np.testing.assert_array_equal(columns["right_w2"], 0.0)
    np.testing.assert_array_equal(columns["left_gripper"], 100.0)
    np.testing.assert_array_equal(columns["right_gripper"], 100.0)


def test_ros_trajectory_is_a_message(timed, arm) -> None:
    message = yaml.safe_load(ros_trajectory(timed, arm))
    assert message["joint_names"] == list(arm.joint_names)
    points = message["points"]
    t, q, v = timed.sampled(PERIOD)
    times = [p["time_from_start"]["sec"] + 1e-9 * p["time_from_start"]["nanosec"] for p in points]
    np.testing.assert_allclose(times, t, atol=1e-9)
    assert all(p["time_from_start"]["nanosec"] < 10**9 for p in points)
    np.testing.assert_allclose([p["positions"] for p in points], q, atol=1e-8)
    np.testing.assert_allclose([p["velocities"] for p in points], v, atol=1e-8)
    assert points[0]["velocities"] == pytest.approx([0.0] * 7)


def test_npz_holds_the_arrays(timed, arm) -> None:
    with np.load(io.BytesIO(npz(timed, arm))) as data:
        t, q, v = timed.sampled(PERIOD)
        np.testing.assert_array_equal(data["t"], t)
        np.testing.assert_array_equal(data["q"], q)
        np.testing.assert_array_equal(data["v"], v)
        assert data["joint_names"].tolist() == list(arm.joint_names)
        np.testing.assert_array_equal(data["X_WE"], timed.poses)
        assert set(data["segment"].tolist()) == {0, 1}
        assert data["s"].min() == 0.0
        assert data["s"].max() == pytest.approx(1.0)


def test_an_arm_that_is_not_baxters_gets_its_own_columns(seven_timed) -> None:
    timed, arm = seven_timed
    header = baxter_csv(timed, arm).decode().splitlines()[0]
    assert header == "time," + ",".join(arm.joint_names)


@pytest.fixture
def seven_timed():
    from drake_screw.execution import time_plan
    from drake_screw.planning import ReferencePlanner
    from tests.planning.conftest import serial_arm

    z, y, x = "0 0 1", "0 1 0", "1 0 0"
    places = ["0 0 0.3", "0.07 0 0.1", "0.1 0 0", "0.27 0 0.07", "0.1 0 0", "0.27 0 0", "0.1 0 0"]
    arm = serial_arm([(p, a, 2.0) for p, a in zip(places, [z, y, x, y, x, y, x], strict=True)])
    q = np.array([0.2, -0.3, 0.1, 0.9, 0.2, 0.5, -0.3])
    X_WS = arm.pose(q)
    X_WG = X_WS.copy()
    X_WG[0, 3] -= 0.03
    plan = ReferencePlanner(arm, step=0.02).plan(q, X_WG[None])
    assert plan.success
    return time_plan(plan, np.stack([X_WS, X_WG]), arm), arm
