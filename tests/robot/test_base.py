"""Any link may be the robot's base: it is at the world's origin, whatever holds the robot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw.errors import ModelError
from drake_screw.execution.station import build_station
from drake_screw.robot import RobotConfig, Workcell, build_workcell
from drake_screw.screws import exp, inverse

Q = np.array([0.3, -0.4, 0.8])
NONE = np.empty((0, 4, 4))
BALL = "<collision><geometry><sphere radius='0.05'/></geometry></collision>"
INERTIAL = (
    "<inertial><mass value='1'/>"
    "<inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>"
)
UR = (
    "<link name='base'/><joint name='beside' type='fixed'><parent link='base_link'/>"
    "<child link='base'/><origin xyz='0 0.1 0' rpy='0 0 3.14159265358979'/></joint>"
)
"""UR's arms have a leaf `base` beside `base_link`, half a turn apart."""


def link(name: str) -> str:
    return f"<link name='{name}'>{INERTIAL}{BALL}</link>"


def joint(name: str, parent: str, child: str, kind: str = "revolute", xyz: str = "0.3 0 0") -> str:
    limit = "" if kind in ("fixed", "floating", "planar") else "<axis xyz='0 0 1'/>"
    if kind in ("revolute", "prismatic"):
        limit += "<limit lower='-2.5' upper='2.5' velocity='2' effort='50'/>"
    if kind == "planar":
        limit = "<axis xyz='0 0 1'/>"
    return (
        f"<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>"
        f"<origin xyz='{xyz}'/>{limit}</joint>"
    )


def urdf(before: str = "", after: str = "") -> str:
    """An arm j1..j3 on `base_link`, with what is before it and beside it."""
    arm = "".join(link(name) for name in ("base_link", "l1", "l2", "l3"))
    arm += joint("j1", "base_link", "l1", xyz="0 0 0.4") + joint("j2", "l1", "l2")
    return f"<robot name='small'>{before}{arm}{joint('j3', 'l2', 'l3')}{after}</robot>"


def config(folder: Path, text: str, base: str, **changes: object) -> RobotConfig:
    file = folder / "small.urdf"
    file.write_text(text)
    settings = {"joints": ("j1", "j2", "j3"), "end_effector": "l3", "start": tuple(Q), **changes}
    return RobotConfig(str(file), base=base, **settings)


def frame(cell: Workcell, name: str) -> np.ndarray:
    context = cell.plant.CreateDefaultContext()
    cell.plant.SetPositions(context, cell.arm.full_positions(Q))
    return cell.plant.GetFrameByName(name).CalcPoseInWorld(context).GetAsMatrix4()


@pytest.fixture
def X_BE(tmp_path: Path) -> np.ndarray:
    """(4, 4) the end effector at Q, seen from base_link."""
    return build_workcell(config(tmp_path, urdf(), "base_link")).arm.pose(Q)


HELD = {
    "nothing": "",
    "world": "<link name='world'/>" + joint("w", "world", "base_link", "fixed", "1 2 3"),
    "a fixed link": link("foot") + joint("w", "foot", "base_link", "fixed", "1 2 3"),
    "a planar joint": link("odom") + joint("w", "odom", "base_link", "planar", "1 2 3"),
    "a planar joint on world": "<link name='world'/>" + joint("w", "world", "base_link", "planar"),
    "a floating joint": link("odom") + joint("w", "odom", "base_link", "floating"),
    "a floating joint on world": (
        "<link name='world'/>" + joint("w", "world", "base_link", "floating", "1 2 3")
    ),
    "a rail": link("rail") + joint("w", "rail", "base_link", "prismatic", "1 2 3"),
    "a turntable": link("table_top") + joint("w", "table_top", "base_link", "continuous"),
}


@pytest.mark.parametrize("before", HELD.values(), ids=HELD.keys())
def test_whatever_holds_the_base_it_is_at_the_origin(before: str, X_BE, tmp_path: Path) -> None:
    cell = build_workcell(config(tmp_path, urdf(before), "base_link"))
    np.testing.assert_allclose(frame(cell, "base_link"), np.eye(4), atol=1e-12)
    np.testing.assert_allclose(cell.arm.pose(Q), X_BE, atol=1e-12)
    assert cell.plant.num_positions() == 3


@pytest.mark.parametrize("before", HELD.values(), ids=HELD.keys())
def test_a_leaf_beside_the_root_may_be_the_base(before: str, X_BE, tmp_path: Path) -> None:
    cell = build_workcell(config(tmp_path, urdf(before, UR), "base"))
    np.testing.assert_allclose(frame(cell, "base"), np.eye(4), atol=1e-12)
    X_BL = exp([0.0, 0.0, np.pi, 0.0, 0.0, 0.0])
    X_BL[:3, 3] = [0.0, 0.1, 0.0]
    np.testing.assert_allclose(cell.arm.pose(Q), X_BL @ X_BE, atol=1e-12)


def test_joints_above_the_base_are_held_where_they_are_parked(tmp_path: Path) -> None:
    """The lift of a column; seen from its foot or from the arm's own base."""
    lift = link("foot") + joint("lift", "foot", "base_link", "prismatic", "0 0 0.5")
    lift = lift.replace("<axis xyz='0 0 1'/>", "<axis xyz='1 0 0'/>")
    parked = {"lift": 0.2}
    arm = build_workcell(config(tmp_path, urdf(lift), "base_link", parked=parked))
    np.testing.assert_allclose(frame(arm, "foot")[:3, 3], [-0.2, 0.0, -0.5], atol=1e-12)
    foot = build_workcell(config(tmp_path, urdf(lift), "foot", parked=parked))
    np.testing.assert_allclose(frame(foot, "base_link")[:3, 3], [0.2, 0.0, 0.5], atol=1e-12)
    assert (arm.plant.num_positions(), foot.plant.num_positions()) == (3, 4)
    np.testing.assert_allclose(
        inverse(frame(arm, "foot")) @ arm.arm.pose(Q),
        inverse(frame(foot, "foot")) @ foot.arm.pose(Q),
        atol=1e-12,
    )


def test_a_joint_of_the_arm_cannot_be_above_the_base(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="joint 'j1' of the arm moves the base 'l2'") as caught:
        build_workcell(config(tmp_path, urdf(), "l2"))
    assert "Take a link for the base" in caught.value.remedy
    assert caught.value.file == tmp_path / "small.urdf"
    cell = build_workcell(
        config(tmp_path, urdf(), "l1", joints=("j2", "j3"), start=(0.0, 0.0), parked={"j1": 1.0})
    )
    np.testing.assert_allclose(cell.arm.pose([0.0, 0.0])[:3, 3], [0.6, 0.0, 0.0], atol=1e-12)


def test_wheels_and_casters_stay_where_they_are(tmp_path: Path) -> None:
    wheels = "".join(
        link(side) + joint(f"{side}_spin", "base_link", side, "continuous", f"0 {y} -0.1")
        for side, y in (("left", 0.2), ("right", -0.2))
    )
    robot = config(tmp_path, urdf("", wheels), "base_link", parked={"left_spin": 7.0})
    cell = build_workcell(robot)
    assert cell.plant.num_positions() == 5
    left = cell.plant.GetJointByName("left_spin").position_start()
    assert cell.positions(Q, NONE)[left] == 7.0
    station = build_station(robot)
    context = station.plant.GetMyContextFromRoot(station.context(Q, NONE))
    assert station.plant.GetJointByName("left_spin").GetOnePosition(context) == 7.0


def test_world_for_a_base_leaves_the_model_where_it_puts_itself(tmp_path: Path, X_BE) -> None:
    cell = build_workcell(config(tmp_path, urdf(HELD["world"]), "world"))
    np.testing.assert_allclose(cell.arm.pose(Q)[:3, 3], X_BE[:3, 3] + [1.0, 2.0, 3.0], atol=1e-12)


def test_shapes_that_mjcf_fixes_to_the_world_keep_the_model_there(tmp_path: Path) -> None:
    """A floor, and an arm that stands on it, or not."""

    def mjcf(z: float) -> str:
        return (
            "<mujoco model='m'><worldbody><geom type='box' size='1 1 0.1' pos='0 0 -0.1'/>"
            f"<body name='base' pos='0 0 {z}'><body name='l1' pos='0 0 0.2'>"
            "<joint name='j1' axis='0 1 0' range='-120 120' limited='true'/>"
            "<geom type='sphere' size='0.1' pos='0 0 0.5'/></body></body></worldbody></mujoco>"
        )

    file = tmp_path / "arm.xml"
    file.write_text(mjcf(0.5))
    with pytest.raises(ModelError, match="shapes that are fixed to the world") as caught:
        build_workcell(RobotConfig(str(file), ("j1",), "l1", (0.0,)))
    assert "base: world" in caught.value.remedy
    low = np.array([[0.0], [1.5], [2.09]])
    high = build_workcell(RobotConfig(str(file), ("j1",), "l1", (0.0,), base="world"))
    np.testing.assert_array_equal(high.collides(low, NONE), [False, False, False])
    np.testing.assert_allclose(high.arm.pose([0.0])[:3, 3], [0.0, 0.0, 0.7], atol=1e-12)
    file.write_text(mjcf(0.0))
    on_it = build_workcell(RobotConfig(str(file), ("j1",), "l1", (0.0,)))
    np.testing.assert_array_equal(on_it.collides(low, NONE), [False, False, True])


def test_two_joints_that_carry_one_link_are_told(tmp_path: Path) -> None:
    loop = joint("again", "base_link", "l3", "fixed")
    with pytest.raises(ModelError, match="joints 'j3' and 'again' both carry the link 'l3'"):
        build_workcell(config(tmp_path, urdf("", loop), "base_link"))
