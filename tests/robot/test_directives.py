"""Robots that Drake's model directives put together of several models."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw.errors import ModelError
from drake_screw.execution.station import build_station
from drake_screw.robot import (
    BoxShape,
    ObjectConfig,
    PlacedShape,
    RobotConfig,
    ToolConfig,
    Workcell,
    build_workcell,
)
from drake_screw.screws import pose
from tests.robot.small_arms import PLANAR, sdf

NONE = np.empty((0, 4, 4))
NAMES = ("p1", "p2", "p3")
BOX = "<box><size>{}</size></box>"
GRIPPER = (
    "<?xml version='1.0'?><sdf version='1.9'><model name='gripper'><link name='palm'>"
    "<inertial><mass>0.1</mass></inertial>"
    "<collision name='c'><geometry><sphere><radius>0.05</radius></sphere></geometry></collision>"
    "</link><link name='finger'><pose>0.05 0 0.1 0 0 0</pose><inertial><mass>0.1</mass></inertial>"
    "</link><joint name='slide' type='prismatic'><parent>palm</parent><child>finger</child>"
    "<axis><xyz>1 0 0</xyz><limit><lower>0</lower><upper>0.1</upper><effort>20</effort></limit>"
    "</axis></joint></model></sdf>"
)
STAND = (
    "<?xml version='1.0'?><sdf version='1.9'><model name='stand'><link name='top'>"
    f"<collision name='c'><geometry>{BOX.format('0.2 0.2 0.2')}</geometry></collision>"
    "</link></model></sdf>"
)


def directives(folder: Path, *lines: str) -> Path:
    for name, text in (("arm", sdf(PLANAR)), ("gripper", GRIPPER), ("stand", STAND)):
        (folder / f"{name}.sdf").write_text(text)
    file = folder / "robot.dmd.yaml"
    listed = "".join(f"- {line}\n" for line in lines)
    file.write_text(f"directives:\n{listed}" if lines else "directives: []\n")
    return file


def model(folder: Path, name: str, file: str, more: str = "") -> str:
    return f"add_model: {{name: {name}, file: 'file://{folder}/{file}.sdf'{more}}}"


def weld(parent: str, child: str, xyz: str = "0, 0, 0") -> str:
    return f"add_weld: {{parent: '{parent}', child: '{child}', X_PC: {{translation: [{xyz}]}}}}"


def robot(file: Path, **changes: object) -> RobotConfig:
    settings = {"joints": NAMES, "end_effector": "hand", "start": (0.1, 0.2, 0.3), **changes}
    return RobotConfig(str(file), **settings)


@pytest.fixture
def held(tmp_path: Path) -> Path:
    """A stand, an arm on it, and a gripper that the arm carries, which is open by default."""
    return directives(
        tmp_path,
        model(tmp_path, "stand", "stand"),
        model(tmp_path, "arm", "arm"),
        model(tmp_path, "gripper", "gripper", ", default_joint_positions: {slide: [0.07]}"),
        weld("world", "stand::top", "1, 2, 0.1"),
        weld("stand::top", "arm::base", "0, 0, 0.1"),
        weld("arm::hand", "gripper::palm"),
        "add_frame: {name: 'gripper::tip', X_PF: {base_frame: 'gripper::palm', "
        "translation: [0, 0, 0.2]}}",
    )


def at(cell: Workcell, name: str, q: np.ndarray) -> np.ndarray:
    context = cell.plant.CreateDefaultContext()
    cell.plant.SetPositions(context, cell.positions(q, NONE))
    return cell.plant.GetFrameByName(name).CalcPoseInWorld(context).GetAsMatrix4()


def test_every_model_is_the_robot(held: Path) -> None:
    cell = build_workcell(robot(held, end_effector="tip"))
    assert {cell.plant.GetModelInstanceName(i) for i in cell.robot} == {"stand", "arm", "gripper"}
    q = np.array([0.3, -0.4, 0.8])
    np.testing.assert_allclose(at(cell, "base", q), np.eye(4), atol=1e-12)
    np.testing.assert_allclose(at(cell, "top", q)[:3, 3], [0.0, 0.0, -0.1], atol=1e-12)
    alone = build_workcell(robot(held.parent / "arm.sdf")).arm.pose(q)
    np.testing.assert_allclose(cell.arm.pose(q), alone @ pose(np.eye(3), [0, 0, 0.2]), atol=1e-12)


def test_a_bowl_in_the_gripper_collides(held: Path) -> None:
    cell = build_workcell(robot(held), objects=(ObjectConfig("bowl", 0.05, 0.05),))
    q = np.zeros(3)
    bowl = pose(np.eye(3), cell.arm.pose(q)[:3, 3])
    assert cell.collides(q[None], bowl[None]) == [True]
    assert cell.colliding_bodies(q, bowl[None]) == (("palm", "bowl"),)
    away = pose(np.eye(3), [0.0, 0.0, 9.0])
    assert cell.collides(q[None], away[None]) == [False]


def test_default_positions_of_directives_hold(held: Path) -> None:
    cell = build_workcell(robot(held))
    slide = cell.plant.GetJointByName("slide").position_start()
    assert cell.positions(np.zeros(3), NONE)[slide] == 0.07
    cell = build_workcell(robot(held, parked={"slide": 0.02}))
    assert cell.positions(np.zeros(3), NONE)[slide] == 0.02


def test_all_models_are_driven(held: Path) -> None:
    config = robot(held)
    station = build_station(config)
    q = np.array(config.start)
    root = station.context(q, NONE)
    slide = station.plant.GetJointByName("slide")
    context = station.plant.GetMyContextFromRoot(root)
    assert slide.GetOnePosition(context) == 0.07
    assert station.graphviz.count("joint_command_") >= 2


def test_models_that_stand_by_themselves_are_none_of_the_robot(tmp_path: Path) -> None:
    """Objects may stand on a table that directives add; the arm may not touch it."""
    file = directives(
        tmp_path,
        model(tmp_path, "arm", "arm"),
        model(tmp_path, "stand", "stand"),
        weld("world", "stand::top", "0.8, 0, 0.45"),
        model(tmp_path, "gripper", "gripper"),
        weld("arm::hand", "gripper::palm"),
    )
    cell = build_workcell(robot(file), objects=(ObjectConfig("bowl", 0.05, 0.05),))
    assert {cell.plant.GetModelInstanceName(i) for i in cell.robot} == {"arm", "gripper"}
    on_it = pose(np.eye(3), [0.8, 0.0, 0.549])[None]
    turned = np.array([[2.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    np.testing.assert_array_equal(cell.collides(turned, on_it), [False, True])
    assert ("palm", "top") in cell.colliding_bodies(turned[1], on_it)


@pytest.fixture
def two(tmp_path: Path) -> Path:
    """Two arms of one model."""
    return directives(
        tmp_path,
        model(tmp_path, "left", "arm"),
        model(tmp_path, "right", "arm"),
        weld("world", "left::base", "0, 1, 0"),
        weld("world", "right::base", "0, -1, 0"),
    )


LEFT = tuple(f"left::{name}" for name in NAMES)


def test_scoped_names_go_wherever_a_name_goes(two: Path) -> None:
    box = ToolConfig(
        "left::hand", PlacedShape(BoxShape((0.1, 0.1, 0.1))), touches=("left::p3_link",)
    )
    config = robot(
        two, joints=LEFT, end_effector="left::hand", base="left::base", tool=box,
        parked={"right::p1": 1.0},
    )  # fmt: skip
    cell = build_workcell(config)
    q = np.array([0.3, -0.4, 0.8])
    alone = build_workcell(robot(two.parent / "arm.sdf"))
    np.testing.assert_allclose(cell.arm.pose(q), alone.arm.pose(q), atol=1e-12)
    right = cell.plant.GetModelInstanceByName("right")
    p1 = cell.plant.GetJointByName("p1", right)
    assert cell.positions(q, NONE)[p1.position_start()] == 1.0
    np.testing.assert_allclose(
        cell.plant.GetFrameByName("base", right)
        .CalcPoseInWorld(cell.plant.CreateDefaultContext())
        .translation(),
        [0.0, -2.0, 0.0],
        atol=1e-12,
    )
    station = build_station(config)
    root = station.context(q, NONE)
    context = station.plant.GetMyContextFromRoot(root)
    np.testing.assert_array_equal(
        station.plant.GetPositions(context, station.plant.GetModelInstanceByName("left")), q
    )


@pytest.mark.parametrize(
    ("changes", "message", "choices"),
    [
        ({"joints": NAMES}, "2 joints are called 'p1'", "left::p1, right::p1"),
        ({"end_effector": "hand"}, "2 frames are called 'hand'", "left::hand, right::hand"),
        ({"base": "base"}, "2 links are called 'base'", "left::base, right::base"),
        ({"parked": {"p1": 0.0}}, "2 joints are called 'p1'", "left::p1, right::p1"),
        ({"end_effector": "left::hnd"}, "no frame 'left::hnd'", "Did you mean 'left::hand'"),
    ],
)
def test_ambiguous_names_are_refused_with_the_choices(
    two: Path, changes: dict, message: str, choices: str
) -> None:
    settings = {"joints": LEFT, "end_effector": "left::hand", "base": "left::base", **changes}
    with pytest.raises(ModelError, match=message) as caught:
        build_workcell(robot(two, **settings))
    assert choices in str(caught.value)


def test_directives_without_a_model_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="there is no model in this file") as caught:
        build_workcell(robot(directives(tmp_path)))
    assert caught.value.file == tmp_path / "robot.dmd.yaml"


def test_directives_that_name_no_file_are_refused(tmp_path: Path) -> None:
    for missing in (
        model(tmp_path, "arm", "nothing"),
        "add_model: {name: a, file: package://no/a}",
    ):
        file = directives(tmp_path, missing)
        with pytest.raises(ModelError) as caught:
            build_workcell(robot(file))
        assert caught.value.file == file


@pytest.mark.parametrize("name", ["p3_link", "hand", "p1"])
def test_an_object_may_be_called_as_a_part_of_the_robot(tmp_path: Path, name: str) -> None:
    file = tmp_path / "arm.sdf"
    file.write_text(sdf(PLANAR, shapes={"p3_link": BOX.format("0.1 0.1 0.1")}))
    cell = build_workcell(robot(file), objects=(ObjectConfig(name, 0.05, 0.05),))
    q = np.zeros(3)
    there = pose(np.eye(3), [0.75, 0.0, 0.5])[None]
    pair = ("small::p3_link", "p3_link::p3_link") if name == "p3_link" else ("p3_link", name)
    assert cell.colliding_bodies(q, there) == (pair,)
    assert cell.touching(0) == pair
    alone = build_workcell(robot(file)).arm.pose(q)
    np.testing.assert_array_equal(cell.arm.pose(q), alone)


def test_what_a_tool_may_touch_is_named_with_its_model_where_it_could_be_either(
    tmp_path: Path,
) -> None:
    file = tmp_path / "arm.sdf"
    file.write_text(sdf(PLANAR, shapes={"p2_link": BOX.format("0.1 0.1 0.1")}))
    bowl = (ObjectConfig("p2_link", 0.05, 0.05),)

    def cell(touches: str) -> Workcell:
        shape = PlacedShape(BoxShape((0.7, 0.05, 0.05)), (-0.35, 0.0, 0.0))
        tool = ToolConfig("p3_link", shape, touches=(touches,))
        return build_workcell(robot(file, end_effector="p3_link", tool=tool), objects=bowl)

    with pytest.raises(ModelError, match="2 parts of the workcell are called 'p2_link'") as caught:
        cell("p2_link")
    assert "small::p2_link, p2_link::p2_link" in caught.value.remedy
    far = pose(np.eye(3), [0.0, 0.0, 9.0])[None]
    assert cell("small::p2_link").colliding_bodies(np.zeros(3), far) == ()
    assert cell("p2_link::p2_link").colliding_bodies(np.zeros(3), far) == (
        ("small::p2_link", "tool"),
    )
