"""Robot, table and objects in one plant; what hits what."""

from __future__ import annotations

import gc
from pathlib import Path

import numpy as np
import pytest

from drake_screw.errors import ModelError
from drake_screw.robot import (
    ObjectConfig,
    RobotConfig,
    TableConfig,
    build_workcell,
)
from drake_screw.screws import exp, pose
from tests.robot.small_arms import PLANAR, JointText, sdf

NAMES = ("p1", "p2", "p3")
SPHERE = "<sphere><radius>0.05</radius></sphere>"
STRETCHED, FOLDED = np.zeros(3), np.array([0.0, 2.5, 2.0])
TABLE = TableConfig(center=(0.8, 0.0), size=(0.4, 0.6), top=0.4)
BOWL, CUP = ObjectConfig("bowl", 0.08, 0.06), ObjectConfig("cup", 0.04, 0.1)
FAR = pose(np.eye(3), [5.0, 0.0, 0.0])


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A planar arm 0.5 m above the ground, with balls of 5 cm at its joints and its hand."""
    pose_of_ball = "<pose>0.1 0 0 0 0 0</pose>"
    ball = f"<collision name='ball'>{pose_of_ball}<geometry>{SPHERE}</geometry></collision>"
    text = sdf(
        PLANAR,
        hand="0.1 0 0 0 0 0",
        shapes={"base": "<box><size>0.2 0.2 1.2</size></box>", "p2_link": SPHERE},
    )
    text = text.replace("<link name='p3_link'>", f"<link name='p3_link'>{ball}")
    file = tmp_path / "planar.sdf"
    file.write_text(text)
    return file


def robot(model: Path, **changes: object) -> RobotConfig:
    settings: dict[str, object] = {
        "model": str(model),
        "joints": NAMES,
        "end_effector": "hand",
        "start": (0.1, 0.2, 0.3),
    }
    return RobotConfig(**{**settings, **changes})  # type: ignore[arg-type]


def at(x: float, y: float, z: float) -> np.ndarray:
    return pose(np.eye(3), [x, y, z])


def test_workcell_without_table_and_objects(model: Path) -> None:
    cell = build_workcell(robot(model))
    assert cell.model_file == model
    assert cell.objects == ()
    assert cell.plant.num_positions() == 3
    np.testing.assert_array_equal(cell.start, [0.1, 0.2, 0.3])
    np.testing.assert_allclose(cell.arm.pose(STRETCHED)[:3, 3], [0.8, 0.0, 0.5], atol=1e-15)
    q = np.stack([STRETCHED, FOLDED])
    np.testing.assert_array_equal(cell.collides(q, np.empty((0, 4, 4))), [False, True])
    assert cell.colliding_bodies(STRETCHED, np.empty((0, 4, 4))) == ()


def test_table_is_hit_from_above_by_the_hand_only(model: Path) -> None:
    q = np.stack([STRETCHED, [1.5, 0.0, 0.0]])
    none = np.empty((0, 4, 4))
    high = build_workcell(robot(model), table=TableConfig((0.8, 0.0), (0.4, 0.6), top=0.46))
    np.testing.assert_array_equal(high.collides(q, none), [True, False])
    assert high.colliding_bodies(STRETCHED, none) == (("p3_link", "table"),)
    low = build_workcell(robot(model), table=TableConfig((0.8, 0.0), (0.4, 0.6), top=0.44))
    np.testing.assert_array_equal(low.collides(q, none), [False, False])
    under = TableConfig((0.8, 0.0), (0.4, 0.6), top=0.58, thickness=0.02)
    np.testing.assert_array_equal(
        build_workcell(robot(model), table=under).collides(q, none), [False, False]
    )


def test_a_base_that_stands_in_the_table_is_no_collision(model: Path) -> None:
    around = TableConfig(center=(0.0, 0.0), size=(0.5, 0.5), top=0.2)
    cell = build_workcell(robot(model), table=around)
    assert not cell.collides(STRETCHED[None], np.empty((0, 4, 4))).any()


def test_objects_are_where_the_query_puts_them(model: Path) -> None:
    cell = build_workcell(robot(model), table=TABLE, objects=(BOWL, CUP))
    q = np.tile(STRETCHED, (4, 1))
    X_WO = np.array(
        [
            [at(0.8, 0.0, 0.4), at(0.8, 0.3, 0.4)],
            [at(0.8, 0.0, 0.47), at(0.8, 0.3, 0.4)],
            [at(0.8, 0.2, 0.4), at(0.8, 0.0, 0.4)],
            [FAR, FAR],
        ]
    )
    np.testing.assert_array_equal(cell.collides(q, X_WO), [True, True, True, False])
    assert cell.colliding_bodies(STRETCHED, X_WO[1]) == (("p3_link", "bowl"),)
    assert cell.colliding_bodies(STRETCHED, X_WO[2]) == (("p3_link", "cup"),)
    assert cell.colliding_bodies(STRETCHED, X_WO[3]) == ()
    np.testing.assert_array_equal(cell.collides(q, X_WO[2]), [True] * 4)


def test_object_frame_is_at_the_centre_of_its_bottom(model: Path) -> None:
    cell = build_workcell(robot(model), objects=(CUP,))
    beside = 0.05 + 0.04
    heights = {0.5 + 0.05 + 1e-3: False, 0.5 + 0.05 - 1e-3: True}
    heights |= {0.5 - 0.05 - 0.1 - 1e-3: False, 0.5 - 0.05 - 0.1 + 1e-3: True}
    for z, hit in heights.items():
        assert cell.collides(STRETCHED[None], [at(0.8, 0.0, z)])[0] == hit
    assert cell.collides(STRETCHED[None], [at(0.8 + beside - 1e-3, 0.0, 0.45)])[0]
    assert not cell.collides(STRETCHED[None], [at(0.8 + beside + 1e-3, 0.0, 0.45)])[0]
    lying = at(0.8, 0.11, 0.5) @ exp([np.pi / 2, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert cell.collides(STRETCHED[None], lying[None])[0]
    assert not cell.collides(STRETCHED[None], [at(0.8, 0.11, 0.5)])[0]


def test_objects_may_touch_the_table_and_one_another(model: Path) -> None:
    cell = build_workcell(robot(model), table=TABLE, objects=(BOWL, CUP))
    stacked = np.array([at(0.8, -0.25, 0.38), at(0.8, -0.25, 0.39)])
    assert not cell.collides(STRETCHED[None], stacked)[0]


def test_positions_hold_arm_objects_and_parked_joints(model: Path) -> None:
    cell = build_workcell(
        robot(model, joints=("p2", "p3"), start=(0.0, 0.0), parked={"p1": 0.5}), objects=(BOWL, CUP)
    )
    q = np.random.default_rng(0).uniform(-1.0, 1.0, (5, 2))
    X_WO = exp(np.random.default_rng(1).uniform(-1.0, 1.0, (5, 2, 6)))
    full = cell.positions(q, X_WO)
    assert full.shape == (5, 3 + 7 + 7)
    context = cell.plant.CreateDefaultContext()
    for i in range(5):
        cell.plant.SetPositions(context, full[i])
        for k, body in enumerate(cell.objects):
            X = cell.plant.EvalBodyPoseInWorld(context, body).GetAsMatrix4()
            np.testing.assert_allclose(X, X_WO[i, k], atol=1e-14)
        hand = cell.plant.GetFrameByName("hand").CalcPoseInWorld(context).GetAsMatrix4()
        np.testing.assert_allclose(hand, cell.arm.pose(q[i]), atol=1e-14)
        p1 = cell.plant.GetJointByName("p1")
        assert p1.GetOnePosition(context) == 0.5
    assert cell.positions(q[0], X_WO[0]).shape == (17,)
    assert cell.positions(q[0], X_WO).shape == (5, 17)


def test_no_configurations_no_answers(model: Path) -> None:
    cell = build_workcell(robot(model), objects=(BOWL,))
    assert cell.collides(np.empty((0, 3)), FAR[None]).shape == (0,)


def test_base_already_fixed_in_the_model_is_accepted(model: Path) -> None:
    joint = (
        "<joint name='floor' type='fixed'><parent>world</parent><child>base</child>"
        "<pose relative_to='base'>0 0 0 0 0 0</pose></joint></model>"
    )
    model.write_text(model.read_text().replace("</model>", joint))
    cell = build_workcell(robot(model))
    np.testing.assert_allclose(cell.arm.pose(STRETCHED)[:3, 3], [0.8, 0.0, 0.5], atol=1e-15)


def test_model_without_the_base_link(model: Path) -> None:
    with pytest.raises(ModelError) as caught:
        build_workcell(robot(model, base="bse"))
    assert caught.value.file == model
    assert "no link 'bse' in model 'planar'" in caught.value.message
    assert "Did you mean 'base'?" in str(caught.value)
    assert "p1_link" in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "not xml at all",
        "<?xml version='1.0'?><sdf version='1.9'><model name='broken'><link name='a'>",
        "<?xml version='1.0'?><sdf version='1.9'></sdf>",
        "<?xml version='1.0'?><sdf version='1.9'><model name='m'><link name='a'/>"
        "<link name='b'/><joint name='j' type='revolute'><parent>a</parent><child>c</child>"
        "<axis><xyz>0 0 1</xyz></axis></joint></model></sdf>",
    ],
    ids=["empty", "text", "cut off", "no model", "joint to nowhere"],
)
def test_unreadable_model_names_the_file(tmp_path: Path, text: str) -> None:
    file = tmp_path / "broken.sdf"
    file.write_text(text)
    with pytest.raises(ModelError) as caught:
        build_workcell(robot(file))
    assert caught.value.file == file
    assert str(file) in str(caught.value)


def test_missing_model_is_a_model_error(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"nowhere\.sdf"):
        build_workcell(robot(tmp_path / "nowhere.sdf"))


def test_start_of_the_wrong_length(model: Path) -> None:
    with pytest.raises(ModelError, match="2 angles for 3 joints"):
        build_workcell(robot(model, start=(0.0, 0.0)))


def test_extra_joints_keep_their_defaults(tmp_path: Path) -> None:
    finger = JointText("finger", "0.1 0 0 0 0 0", limits=(0.0, 0.04), kind="prismatic")
    file = tmp_path / "gripper.sdf"
    file.write_text(sdf((*PLANAR, finger)))
    cell = build_workcell(robot(file, end_effector="p3_link"))
    np.testing.assert_array_equal(cell.arm.full_positions(STRETCHED), np.zeros(4))
    held = build_workcell(robot(file, end_effector="p3_link", parked={"finger": 0.03}))
    np.testing.assert_array_equal(held.arm.full_positions(STRETCHED), [0.0, 0.0, 0.0, 0.03])


def test_an_arm_outlives_the_workcell_it_came_from(shared: Path) -> None:
    robot = RobotConfig(
        str(shared / "reference" / "baxter_left_calibrated.sdf"),
        ("left_s0", "left_s1", "left_e0", "left_e1", "left_w0", "left_w1", "left_w2"),
        "left_hand",
        (0.0,) * 7,
    )
    arm = build_workcell(robot).arm
    gc.collect()
    assert np.isfinite(arm.pose(np.zeros(7))).all()


@pytest.mark.parametrize("name", ["table", "baxter"])
def test_an_object_needs_a_name_of_its_own(name: str) -> None:
    robot = RobotConfig("baxter", ("left_s0", "left_s1"), "left_hand", (0.0, 0.0))
    table = TableConfig((0.9, 0.3), (0.7, 1.5), -0.06)
    with pytest.raises(ModelError, match=f"the name '{name}' of an object is taken"):
        build_workcell(robot, table=table, objects=[ObjectConfig(name, 0.1, 0.1)])
