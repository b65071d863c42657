"""What leading Baxter around a pole costs, and how often it succeeds.

    python benchmarks/connections.py [INSTANCES]

A bowl is placed at random in front of the arm, and a pole 0.7 m high halfway between the hand's
start and the place above the bowl that it is to come to. Prints how many instances succeed with
straight approaches and with ways around, and what one instance takes that needs one.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import BatchPlanner
from drake_screw.planning.approach import seeds
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.robot import ObjectConfig, RobotConfig, TableConfig, build_workcell
from drake_screw.scenario.loader import load_scenario
from drake_screw.screws import pose

BOWL = np.array([0.85, 0.25, -0.0644])
BEFORE, ABOVE = (-0.15, 0.0, 0.25), (-0.15, 0.0, 0.18)


def main() -> None:
    """Print the comparison."""
    N = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    robot = load_scenario("pouring").robot
    config = RobotConfig(
        str(robot.model), robot.joints, robot.end_effector, robot.start, robot.base, robot.parked
    )
    objects = [ObjectConfig("bowl", 0.08, 0.06), ObjectConfig("pole", 0.05, 0.7)]
    table = TableConfig((0.85, 0.25), (0.7, 1.3), -0.0645)
    workcell = build_workcell(config, table=table, objects=objects)
    chain, start = workcell.arm.screw_chain(), workcell.start

    bowl = BOWL + np.random.default_rng(0).uniform([-0.08, -0.1, 0.0], [0.08, 0.1, 0.0], (N, 3))
    pole = (bowl + BEFORE + workcell.arm.pose(start)[:3, 3]) / 2.0
    pole[:, 2] = BOWL[2]
    X_WO = np.stack([pose(np.eye(3), bowl), pose(np.eye(3), pole)], axis=1)
    level = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    X_OE = pose(level, np.array([BEFORE, ABOVE]))
    lesson = Demonstration("above", X_OE, np.zeros(2, int), X_WO[0], X_OE, np.arange(2))

    planner = CollisionFreePlanner(BatchPlanner(chain, seeds=seeds(chain, 32)), workcell)
    planner.all_outcomes([lesson], X_WO[:1], start)
    seconds, success = [], []
    for connects in (False, True):
        planner.connects = connects
        began = time.perf_counter()
        success.append(planner.all_outcomes([lesson], X_WO, start).success[:, 0])
        seconds.append(time.perf_counter() - began)
    needed = int((~success[0]).sum())
    print(f"{N} instances; straight approaches solve {success[0].sum()} in {seconds[0]:.1f} s")
    print(f"with ways around {success[1].sum()} of them")
    if needed:
        print(f"{(seconds[1] - seconds[0]) / needed:.2f} s for each of {needed} that need one")


if __name__ == "__main__":
    main()
