"""An arm in a plane, and a pole that stands between its start and where it is to go."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import BatchPlanner
from drake_screw.planning.approach import seeds
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.robot import ObjectConfig, RobotConfig, Workcell, build_workcell
from drake_screw.screws import inverse, pose
from tests.robot.small_arms import PLANAR, sdf

START, GOAL = np.array([-0.9, 0.3, 0.2]), np.array([0.7, 0.4, 0.1])
BALL = "<sphere><radius>0.03</radius></sphere>"
POLE = ObjectConfig("pole", 0.05, 0.6)

PASSABLE = pose(np.eye(3), [[0.69, 0.05, 0.2]])
"""X_WO (1, 4, 4). The ball of the third link runs into it, unless the second joint bends."""
CLOSED = pose(np.eye(3), [[0.4, 0.0, 0.2]])
"""That of the second link cannot pass, whatever the joints do."""
AWAY = pose(np.eye(3), [[-1.0, -1.0, 0.2]])


def robot_in(folder: Path) -> RobotConfig:
    """The arm, its model written into a folder."""
    file = folder / "planar.sdf"
    file.write_text(sdf(PLANAR, shapes={"p2_link": BALL, "p3_link": BALL}))
    return RobotConfig(str(file), tuple(joint.name for joint in PLANAR), "hand", tuple(START))


def workcell_in(folder: Path) -> Workcell:
    """Arm and pole."""
    return build_workcell(robot_in(folder), objects=[POLE])


def lesson_of(workcell: Workcell, X_WO: np.ndarray, turn: float = 0.2) -> Demonstration:
    """First to the pose at GOAL, then on by a turn of the first joint in rad."""
    X = workcell.arm.pose(np.add(GOAL, [[0.0, 0.0, 0.0], [turn, 0.0, 0.0]]))
    return Demonstration("turn", inverse(X_WO[0]) @ X, np.zeros(2, int), X_WO, X, np.arange(2))


def planner_of(workcell: Workcell, count: int = 16) -> CollisionFreePlanner:
    """A planner whose approach is free, from so many seeds."""
    chain = workcell.arm.screw_chain()
    return CollisionFreePlanner(BatchPlanner(chain, seeds=seeds(chain, count)), workcell)
