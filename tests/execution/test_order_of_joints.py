"""The order in which a model lists joints and transmissions makes no difference to an execution."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from drake_screw.execution import TimedPlan, build_station, simulate, time_plan
from drake_screw.execution.simulate import Execution
from drake_screw.planning import ReferencePlanner
from drake_screw.robot import RobotConfig
from drake_screw.screws import pose
from tests.robot.six_joints import NAMES, START, urdf

NOWHERE = np.empty((0, 4, 4))
TAGS = {
    "in order": NAMES,
    "reversed": NAMES[::-1],
    "last alone": NAMES[-1:],
    "some": ("j4", "finger", "j2"),
    "finger first": ("finger", *NAMES[::-1]),
    "none": (),
}
LISTED = ("finger", "j6", "j3", "j1", "j5", "j2", "j4")


def config(folder: Path, tags: Sequence[str], order: Sequence[str] | None = None) -> RobotConfig:
    file = folder / "six.urdf"
    file.write_text(urdf(transmissions=tags, order=order))
    return RobotConfig(str(file), NAMES, "hand", START, parked={"finger": 0.03})


def executed(robot: RobotConfig, follow_screws: bool = True) -> tuple[Execution, TimedPlan]:
    station = build_station(robot, follow_screws=follow_screws)
    arm = station.arm
    X = arm.pose(START)
    guides = np.stack([X @ pose(np.eye(3), p) for p in ([0.0, 0.08, -0.05], [0.05, 0.0, -0.08])])
    plan = ReferencePlanner(arm, step=0.02).plan(START, guides)
    assert plan.success
    timed = time_plan(plan, np.concatenate([X[None], guides]), arm)
    return simulate(station, timed, NOWHERE), timed


@pytest.fixture(scope="module")
def in_order(tmp_path_factory: pytest.TempPathFactory) -> Execution:
    return executed(config(tmp_path_factory.mktemp("models"), NAMES))[0]


@pytest.mark.parametrize("tags", TAGS.values(), ids=TAGS.keys())
def test_transmissions_in_any_order_and_number(in_order, tmp_path: Path, tags) -> None:
    done, _ = executed(config(tmp_path, tags))
    assert done.report.flawless, str(done.report)
    assert done.report.velocity < 0.6
    assert done.report.tracking.position < 5e-3
    np.testing.assert_allclose(done.q, in_order.q, atol=1e-6)


@pytest.mark.parametrize("tags", [NAMES, ("j2",)])
def test_joints_listed_in_any_order(in_order, tmp_path: Path, tags) -> None:
    done, _ = executed(config(tmp_path, tags, LISTED))
    assert done.report.flawless, str(done.report)
    np.testing.assert_allclose(done.q, in_order.q, atol=1e-6)


def test_the_joint_path_is_played_in_any_order(tmp_path: Path) -> None:
    done, timed = executed(config(tmp_path, NAMES[::-1]), follow_screws=False)
    assert done.report.flawless, str(done.report)
    np.testing.assert_allclose(done.q[-1], timed.segments[-1].q[-1], atol=2e-3)


def test_idle_joints_are_held_where_they_are_parked(tmp_path: Path) -> None:
    """A finger whose transmission comes first of all, or is missing."""
    for tags in (("finger", *NAMES[::-1]), ("j6",)):
        robot = config(tmp_path, tags)
        station = build_station(robot)
        root = station.context(START, NOWHERE)
        finger = station.plant.GetJointByName("finger")
        assert finger.get_translation(station.plant.GetMyContextFromRoot(root)) == 0.03
        Simulator(station.diagram, root).AdvanceTo(0.2)
        held = finger.get_translation(station.plant.GetMyContextFromRoot(root))
        assert held == pytest.approx(0.03, abs=1e-4)
