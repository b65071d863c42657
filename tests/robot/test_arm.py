"""Arms are found by names, in any serial robot, with errors that help."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant

from drake_screw.errors import ModelError
from drake_screw.robot import Arm
from drake_screw.screws import exp, inverse, log
from tests.robot.small_arms import PLANAR, SEVEN, SLIDING, JointText, arm_of, plant_of, sdf

NAMES = [joint.name for joint in SEVEN]
ARMS = {"7R": SEVEN, "with prismatic joints": SLIDING, "planar 3R": PLANAR}


def drake_pose(arm: Arm, q: np.ndarray) -> np.ndarray:
    plant: MultibodyPlant = arm.plant
    context = plant.CreateDefaultContext()
    for name, value in zip(arm.joint_names, q, strict=True):
        joint = plant.GetJointByName(name)
        plant.SetPositions(
            context,
            np.where(
                np.arange(plant.num_positions()) == joint.position_start(),
                value,
                plant.GetPositions(context),
            ),
        )
    X_WE: RigidTransform = plant.GetFrameByName(arm.end_effector).CalcPoseInWorld(context)
    return X_WE.GetAsMatrix4()


@pytest.fixture(params=ARMS.values(), ids=ARMS.keys())
def arm(request: pytest.FixtureRequest) -> Arm:
    return arm_of(request.param)


def test_limits_come_in_the_order_of_the_names(arm: Arm) -> None:
    assert arm.n == len(arm.joint_names) == len(arm.lower) == len(arm.upper)
    for name, lower, upper in zip(arm.joint_names, arm.lower, arm.upper, strict=True):
        joint = arm.plant.GetJointByName(name)
        assert (lower, upper) == (
            joint.position_lower_limits()[0],
            joint.position_upper_limits()[0],
        )


def test_pose_is_the_plants(arm: Arm) -> None:
    q = np.random.default_rng(0).uniform(arm.lower, arm.upper, (6, arm.n))
    X_WE = arm.pose(q)
    for one, X in zip(q, X_WE, strict=True):
        np.testing.assert_allclose(X, drake_pose(arm, one), atol=1e-14)
        np.testing.assert_array_equal(arm.pose_and_jacobian(one)[0], X)


def test_jacobian_is_the_velocity_of_the_end_effector(arm: Arm) -> None:
    rng = np.random.default_rng(1)
    step = 1e-6
    for q in rng.uniform(arm.lower, arm.upper, (5, arm.n)):
        X_WE, J_WE = arm.pose_and_jacobian(q)
        np.testing.assert_array_equal(J_WE, arm.jacobian(q))
        rates = rng.normal(size=arm.n)
        X_after, X_before = arm.pose(q + step * rates), arm.pose(q - step * rates)
        w = log(X_after @ inverse(X_before))[:3] / (2.0 * step)
        v = (X_after[:3, 3] - X_before[:3, 3]) / (2.0 * step)
        np.testing.assert_allclose(J_WE @ rates, [*w, *v], atol=1e-8)
        twist = log(X_after @ inverse(X_before)) / (2.0 * step)
        shifted = np.concatenate([w, twist[3:] + np.cross(w, X_WE[:3, 3])])
        np.testing.assert_allclose(J_WE @ rates, shifted, atol=1e-7)


@pytest.mark.parametrize("shape", [(), (3,), (2, 3), (0,)])
def test_leading_axes_are_carried(shape: tuple[int, ...]) -> None:
    arm = arm_of(SEVEN)
    q = np.random.default_rng(2).uniform(arm.lower, arm.upper, (*shape, 7))
    assert arm.pose(q).shape == (*shape, 4, 4)
    assert arm.margin(q).shape == (*shape, 7)
    assert arm.full_positions(q).shape == (*shape, arm.plant.num_positions())


def test_margin_is_to_the_nearer_limit_and_negative_outside() -> None:
    arm = arm_of(SEVEN)
    q = np.zeros(7)
    q[0], q[1], q[2] = 2.4, -2.6, 1.5
    np.testing.assert_allclose(arm.margin(q), [0.1, -0.1, 0.0, 2.5, 2.5, 2.5, 2.5])


def test_wrong_number_of_angles_is_refused() -> None:
    arm = arm_of(PLANAR)
    for q in (np.zeros(2), np.zeros((2, 4))):
        with pytest.raises(ValueError, match=r"expected \(3,\)"):
            arm.pose(q)
    with pytest.raises(ValueError, match=r"expected \(3,\)"):
        arm.jacobian(np.zeros((1, 3)))


def test_some_joints_of_a_robot_can_be_the_arm_and_others_be_parked() -> None:
    plant = plant_of(sdf(SEVEN))
    free = Arm(plant, NAMES[2:], "hand")
    parked = Arm(plant, NAMES[2:], "hand", parked={"a1": 0.3, "a2": -0.4})
    q = np.random.default_rng(3).uniform(-1.0, 1.0, (4, 5))
    whole = Arm(plant, NAMES, "hand")
    rest = np.concatenate([np.tile([0.3, -0.4], (4, 1)), q], axis=1)
    np.testing.assert_allclose(parked.pose(q), whole.pose(rest), atol=1e-14)
    np.testing.assert_allclose(parked.jacobian(q[0]), whole.jacobian(rest[0])[:, 2:], atol=1e-14)
    assert not np.allclose(parked.pose(q), free.pose(q), atol=1e-3)
    np.testing.assert_allclose(parked.full_positions(q)[:, :2], rest[:, :2])


def test_two_arms_of_one_plant_do_not_disturb_each_other() -> None:
    left = SEVEN[:3]
    right = tuple(replace(j, name=f"b{i}") for i, j in enumerate(SEVEN[:3]))
    right = (replace(right[0], parent="base", pose="0.1 -0.4 0.3 0 0 1"), *right[1:])
    plant = plant_of(sdf(left + right))
    one = Arm(plant, [j.name for j in left], left[-1].link)
    other = Arm(plant, [j.name for j in right], "hand")
    before = one.pose([0.1, 0.2, 0.3])
    other.pose([1.0, 1.0, 1.0])
    np.testing.assert_array_equal(one.pose([0.1, 0.2, 0.3]), before)
    np.testing.assert_array_equal(one.full_positions([0.1, 0.2, 0.3])[-3:], 0.0)


def test_urdf_models_and_fixed_joints_in_between() -> None:
    text = """<?xml version='1.0'?><robot name='mini'>
      <link name='base'/><link name='one'/><link name='mount'/><link name='two'/>
      <joint name='j1' type='revolute'><parent link='base'/><child link='one'/>
        <axis xyz='0 0 1'/><limit lower='-1' upper='2' effort='1' velocity='1.5'/></joint>
      <joint name='flange' type='fixed'><parent link='one'/><child link='mount'/>
        <origin xyz='0.5 0 0' rpy='1.5707963267948966 0 0'/></joint>
      <joint name='j2' type='revolute'><parent link='mount'/><child link='two'/>
        <axis xyz='0 0 1'/><limit lower='-2' upper='1' effort='1' velocity='2'/></joint>
    </robot>"""
    plant = plant_of(text, suffix=".urdf")
    arm = Arm(plant, ["j1", "j2"], "two")
    np.testing.assert_allclose(arm.velocity_limits, [1.5, 2.0])
    np.testing.assert_allclose(arm.pose([np.pi / 2, 0.0])[:3, 3], [0.0, 0.5, 0.0], atol=1e-15)
    turned = exp([0.0, -0.4, 0.0, 0.0, 0.0, 0.0])[:3, :3]
    np.testing.assert_allclose(
        arm.pose([0.0, 0.4])[:3, :3] @ arm.pose([0.0, 0.0])[:3, :3].T, turned, atol=1e-15
    )
    with pytest.raises(ModelError, match="'flange' is weld"):
        Arm(plant, ["j1", "flange", "j2"], "two")


def test_unknown_joint_names_the_nearest_and_lists_them() -> None:
    with pytest.raises(ModelError) as caught:
        Arm(plant_of(sdf(SEVEN)), [*NAMES[:6], "a_7"], "hand")
    assert "no joint 'a_7'" in str(caught.value)
    assert "Did you mean 'a7'?" in str(caught.value)
    assert "a1, a2, a3, a4, a5, a6, a7" in str(caught.value)
    with pytest.raises(ModelError, match="no joint 'elbow'"):
        Arm(plant_of(sdf(SEVEN)), NAMES, "hand", parked={"elbow": 0.0})


def test_unknown_frame_names_the_nearest_and_lists_those_people_named() -> None:
    with pytest.raises(ModelError) as caught:
        Arm(plant_of(sdf(PLANAR)), ["p1", "p2", "p3"], "hnd")
    assert "no frame 'hnd'" in caught.value.message
    assert "Did you mean 'hand'?" in str(caught.value)
    assert caught.value.remedy is not None
    listed = caught.value.remedy.split("Frames: ")[1].split(", ")
    assert {"hand", "base", "p1_link", "p2_link", "p3_link"} <= set(listed)
    assert "world" not in listed


def test_a_joint_that_does_not_move_the_end_effector_is_refused() -> None:
    finger = JointText("finger", "0 0.1 0 0 0 0")
    plant = plant_of(sdf((*PLANAR, finger)))
    with pytest.raises(ModelError, match="'finger' does not move 'p3_link'"):
        Arm(plant, ["p1", "p2", "p3", "finger"], "p3_link")


def test_a_ball_joint_is_refused() -> None:
    joints = (PLANAR[0], replace(PLANAR[1], kind="ball"), PLANAR[2])
    plant = plant_of(sdf(joints))
    with pytest.raises(ModelError, match="'p2' is ball"):
        Arm(plant, ["p1", "p2", "p3"], "hand")
    with pytest.raises(ModelError, match="'p2' cannot be parked"):
        Arm(plant, ["p1"], "hand", parked={"p2": 0.1})


@pytest.mark.parametrize("names", [["p2", "p1", "p3"], ["p1", "p3", "p2"], ["p1", "p1", "p2"]])
def test_joints_out_of_order_are_refused(names: list[str]) -> None:
    with pytest.raises(ModelError, match="does not come after"):
        Arm(plant_of(sdf(PLANAR)), names, "hand")
