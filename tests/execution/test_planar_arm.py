"""An arm of three joints in a plane goes all the way: planned, checked for collisions, executed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drake_screw.demonstrations import Demonstration
from drake_screw.errors import ModelError
from drake_screw.execution.parallel import Job, StationConfig, execute_all
from drake_screw.execution.timing import time_plan
from drake_screw.planning import BatchPlanner, Plan
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.plugins import find, names
from drake_screw.robot import ObjectConfig, RobotConfig, Workcell, build_workcell
from drake_screw.screws import inverse, pose
from tests.robot.small_arms import PLANAR, sdf

BENT = (0.4, 0.9, 0.4)
BALL = "<sphere><radius>0.03</radius></sphere>"
POLE = ObjectConfig("pole", 0.02, 0.6)
X_WO = pose(np.eye(3), [[-1.0, -1.0, 0.2]])


@pytest.fixture(scope="module")
def config(tmp_path_factory: pytest.TempPathFactory) -> StationConfig:
    file = tmp_path_factory.mktemp("models") / "planar.sdf"
    file.write_text(sdf(PLANAR, shapes={"p2_link": BALL, "p3_link": BALL}))
    robot = RobotConfig(str(file), tuple(joint.name for joint in PLANAR), "hand", BENT)
    return StationConfig(robot, None, (POLE,))


@pytest.fixture(scope="module")
def workcell(config: StationConfig) -> Workcell:
    return build_workcell(config.robot, objects=config.objects)


@pytest.fixture(scope="module")
def lesson(workcell: Workcell) -> Demonstration:
    X = workcell.arm.pose(np.add(BENT, [[0.2, -0.3, 0.2], [-0.3, 0.0, 0.4]]))
    return Demonstration("flat", inverse(X_WO[0]) @ X, np.zeros(2, int), X_WO, X, np.arange(2))


@pytest.fixture(scope="module")
def plan(workcell: Workcell, lesson: Demonstration) -> Plan:
    batch = BatchPlanner(workcell.arm.screw_chain())
    checked = CollisionFreePlanner(batch, workcell).all_outcomes([lesson], X_WO[None], BENT)
    assert checked.success.all()
    return batch.plan(lesson, X_WO, BENT)


def test_it_is_executed(config: StationConfig, lesson: Demonstration, plan: Plan) -> None:
    (done,) = execute_all(config, [Job(plan, X_WO)], workers=1)
    assert done.report.flawless, str(done.report.status)
    assert done.report.tracking.position < 5e-3


def test_it_is_executed_with_no_other_model_than_it_was_planned_with(
    config: StationConfig, workcell: Workcell, plan: Plan
) -> None:
    job = Job(plan, X_WO)
    execute_all(replace(config, model=workcell.model.hash), [job], workers=1)
    with pytest.raises(ModelError, match="not the one that plans were made with"):
        execute_all(replace(config, model="0" * 64), [job], workers=1)


@pytest.mark.parametrize("format", names("exporters"))
def test_it_is_exported(workcell: Workcell, lesson: Demonstration, plan: Plan, format: str) -> None:
    arm = workcell.arm
    poses = np.concatenate([arm.pose(plan.q[:1]), lesson.transfer(X_WO)])
    pytest.importorskip({"ros2-bag": "rosbags", "lerobot": "pyarrow"}.get(format, "numpy"))
    content = find("exporters", format)(time_plan(plan, poses, arm), arm)
    files = [content] if isinstance(content, bytes) else content.values()
    assert sum(map(len, files)) > 1000
