"""A robot of two arms in a plane, half a metre above a table, with a scenario and recordings."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np

from drake_screw import Setup, load_scenario
from drake_screw.demonstrations import Demonstration, Recording
from drake_screw.screws import inverse, pose
from tests.robot.small_arms import JointText, sdf

BALL = "<sphere><radius>0.03</radius></sphere>"
SIDES = {"left": 0.3, "right": -0.3}
START = {"left": (0.9, 0.9, 0.4), "right": (-0.9, -0.9, -0.4)}
Z = 0.2

TEXT = """
name: two_arms
robot:
  model: {model}
  arms:
    - {{name: left, joints: [l1, l2, l3], end_effector: left_hand, start: [0.9, 0.9, 0.4]}}
    - {{name: right, joints: [r1, r2, r3], end_effector: right_hand, start: [-0.9, -0.9, -0.4]}}
objects:
  - {{name: pot, x: [0.5, 0.7], y: [-1.2, 1.2], z: {z}, radius: 0.04, height: 0.2}}
regions: {{grid: {{y: 2}}}}
coverage: {{beta: 0.5, epsilon: 0.3}}
demonstrations: {{initial: 1, budget: 2, objects: [pot]}}
teacher: {{kind: recorded, folder: {folder}}}
planner: {{joint_margin: 0.001}}
"""


def model() -> str:
    """As SDF: the arms' first joints are 0.3 m to the left and to the right."""
    joints = [
        JointText(
            f"{side[0]}{i + 1}", place if i else f"0 {y} 0.5 0 0 0", parent=None if i else "base"
        )
        for side, y in SIDES.items()
        for i, place in enumerate(["", "0.4 0 0 0 0 0", "0.3 0 0 0 0 0"])
    ]
    hands = "".join(
        f"<frame name='{side}_hand' attached_to='{side[0]}3_link'>"
        f"<pose relative_to='{side[0]}3_link'>0.1 0 0 0 0 0</pose></frame>"
        for side in SIDES
    )
    balls = {f"{side[0]}{i}_link": BALL for side in SIDES for i in (2, 3)}
    return sdf(joints, shapes=balls, extra=hands)


def scenario_in(folder: Path) -> Path:
    """Model and scenario, written into a folder; recordings belong into `recordings` there."""
    (folder / "two.sdf").write_text(model())
    file = folder / "two_arms.yaml"
    file.write_text(TEXT.format(model=folder / "two.sdf", folder=folder / "recordings", z=Z))
    return file


def setup_in(folder: Path, *changes: str) -> Setup:
    """Of that scenario."""
    return Setup(load_scenario(scenario_in(folder), list(changes)))


def shown(setup: Setup, number: int, name: str = "demo_01") -> Recording:
    """What an arm shows: from its start to a pot that is under its hand then, and a turn there.

    Args:
        setup: of the scenario.
        number: of the arm.
        name: of the recording.
    """
    one = setup.arms[number]
    side = 1.0 if number == 0 else -1.0
    there = side * np.array([-0.2, 0.5, -0.1])
    stops = [one.start, there, there + side * np.array([0.15, 0.0, 0.2])]
    u = np.linspace(0.0, 1.0, 60)[:, None]
    q = np.concatenate([a + u * (b - a) for a, b in itertools.pairwise(stops)])
    p = one.arm.pose(there)[:3, 3]
    X_WO = pose(np.eye(3), [[p[0], p[1], Z]])
    return Recording(name, one.arm.joint_names, 0.05 * np.arange(len(q)), q, X_WO)


def lesson(setup: Setup, number: int) -> Demonstration:
    """Two guiding poses at the pot, as an arm shows them."""
    recording, arm = shown(setup, number), setup.arms[number].arm
    X_WE = arm.pose(recording.q[[59, -1]])
    X_WO = recording.X_WO
    objects = np.zeros(2, dtype=int)
    return Demonstration("turn", inverse(X_WO[0]) @ X_WE, objects, X_WO, X_WE, np.arange(2))
