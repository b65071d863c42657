"""Trajectories in YAML as other programs print them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw import RecordingError, Setup
from drake_screw.assembly.importing import read_recordings
from drake_screw.recordings import Mapping

LEFT = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
NEAR = Mapping(objects={"bowl": (0.8, 0.5)})


def motion() -> np.ndarray:
    q = np.tile([0.5, -0.2, -0.7, 1.5, 1.8, -0.9, -0.5], (12, 1))
    q[:, 0] += 0.02 * np.arange(12)
    return q


def echoed(sec: str = "sec", nanosec: str = "nanosec") -> str:
    """A JointTrajectory in block style, its joints in another order, 0.1 s apart."""
    order = [6, 2, 0, 1, 3, 5, 4]
    lines = ["header:", "  frame_id: world", "joint_names:", *(f"- {LEFT[j]}" for j in order)]
    lines.append("points:")
    for i, row in enumerate(motion()):
        lines += ["- positions:", *(f"  - {x:.6f}" for x in row[order].tolist())]
        lines += ["  velocities: []", "  time_from_start:"]
        lines += [f"    {sec}: {i // 10}", f"    {nanosec}: {i % 10 * 100_000_000}"]
    return "\n".join(lines) + "\n"


def nested(text: str) -> str:
    inner = "\n".join(f"  {line}" for line in text.splitlines())
    return f"joint_trajectory:\n{inner}\nmulti_dof_joint_trajectory:\n  points: []\n"


WAYS = {
    "JointTrajectory": echoed(),
    "RobotTrajectory": nested(echoed()),
    "ROS 1": echoed("secs", "nsecs"),
    "with dashes behind": echoed() + "---\n",
}


@pytest.mark.parametrize("way", WAYS)
def test_a_trajectory_is_a_recording(way: str, setup: Setup, tmp_path: Path) -> None:
    file = tmp_path / "plan.yml"
    file.write_text(WAYS[way])
    (found,) = read_recordings(file, setup, NEAR)
    assert found.recording is not None
    np.testing.assert_allclose(found.recording.q, motion(), atol=1e-6)
    np.testing.assert_allclose(found.recording.t, 0.1 * np.arange(12), atol=1e-9)


def test_several_are_several(setup: Setup, tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(f"{echoed()}---\n{nested(echoed())}---\n")
    found = read_recordings(tmp_path / "plan.yaml", setup, NEAR)
    assert [each.name for each in found] == ["plan_000000", "plan_000001"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no trajectory of joints"),
        ("- 1\n", "no trajectory of joints"),
        ("name: pouring\n", "no trajectory of joints"),
        ("joint_names: []\npoints: []\n", "no joints, or no points"),
        ("joint_names: [a\n", r"plan\.yaml:2: not YAML"),
        ("[" * 100_000, r"plan\.yaml:1: not YAML"),
        ("joint_names: 2001-99-99\n", r"plan\.yaml: cannot be read: month must be in 1"),
        ("joint_names: 1:99_:__\n", r"plan\.yaml: cannot be read|no joint"),
        (echoed().replace("    sec: 0\n", "", 1), "point 1 of the trajectory has no time_from"),
        (echoed().replace("  - 0.500000\n", "", 1), "point 1 .* has 6 positions for 7 joints"),
        (echoed().replace("- 0.520000", "- fast", 1), "point 2 of the trajectory has no"),
        (echoed().replace("- 0.520000", f"- 1{'0' * 400}", 1), "point 2 of the trajectory has no"),
    ],
)
def test_what_is_none_is_refused(text: str, message: str, setup: Setup, tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(text)
    with pytest.raises(RecordingError, match=message):
        read_recordings(tmp_path / "plan.yaml", setup, NEAR)


def test_yaml_among_other_files_is_passed_over(setup: Setup, tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(echoed())
    with pytest.raises(RecordingError, match="no recordings here"):
        read_recordings(tmp_path, setup, NEAR)
