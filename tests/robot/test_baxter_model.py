"""models/baxter.sdf against the maker's published numbers and against real recordings."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from pydrake.geometry import Box, Role
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.planning import RobotDiagramBuilder, SceneGraphCollisionChecker

MODEL = Path(__file__).parents[2] / "models" / "baxter.sdf"
ARM_JOINTS = ("s0", "s1", "e0", "e1", "w0", "w1", "w2")
ARM_LINKS = (
    *("upper_shoulder", "lower_shoulder", "upper_elbow", "lower_elbow"),
    *("upper_forearm", "lower_forearm", "wrist"),
)

# The published transforms, xyz (m) and rpy (rad): the arm's mount on the torso, what each joint's
# frame is to the link before it, and the hand to the wrist. Every joint turns about its own z.
H = 1.57079632679
MOUNTS = {
    "left": ((0.024645, 0.219645, 0.118588), (0, 0, 0.7854)),
    "right": ((0.024645, -0.219645, 0.118588), (0, 0, -0.7854)),
}
JOINT_TRANSFORMS = (
    ((0.055695, 0, 0.011038), (0, 0, 0)),
    ((0.069, 0, 0.27035), (-H, 0, 0)),
    ((0.102, 0, 0), (H, 0, H)),
    ((0.069, 0, 0.26242), (-H, -H, 0)),
    ((0.10359, 0, 0), (H, 0, H)),
    ((0.01, 0, 0.2707), (-H, -H, 0)),
    ((0.115975, 0, 0), (H, 0, H)),
)
HAND = ((0, 0, 0.11355), (0, 0, 0))

LOWER = (-1.70167993878, -2.147, -3.05417993878, -0.05, -3.059, -1.57079632679, -3.059)
UPPER = (1.70167993878, 1.047, 3.05417993878, 2.618, 3.059, 2.094, 3.059)
VELOCITY = (1.5, 1.5, 1.5, 1.5, 4.0, 4.0, 4.0)
EFFORT = (50.0, 100.0, 50.0, 50.0, 15.0, 15.0, 15.0)
MASSES = (5.70044, 3.22698, 4.31272, 2.07206, 2.24665, 1.60979, 0.35093)

# The extents of the real shells in the links' frames (m): lower and upper corner.
EXTENTS = {
    "torso": ((-0.22, -0.336, -0.06), (0.20, 0.336, 0.875)),
    "pedestal": ((-0.50, -0.41, -0.924), (0.42, 0.41, -0.06)),
    "head": ((-0.075,) * 3, (0.075,) * 3),
    "screen": ((-0.135, -0.10, -0.025), (0.135, 0.10, 0.025)),
    "upper_shoulder": ((-0.09, -0.14, 0.03), (0.135, 0.14, 0.37)),
    "lower_shoulder": ((-0.07, -0.076, -0.0975), (0.12, 0.076, 0.0975)),
    "upper_elbow": ((-0.09, -0.09, 0.01), (0.09, 0.09, 0.326)),
    "lower_elbow": ((-0.07, -0.07, -0.095), (0.07, 0.07, 0.095)),
    "upper_forearm": ((-0.08, -0.08, -0.02), (0.08, 0.08, 0.32)),
    "lower_forearm": ((-0.06, -0.06, -0.085), (0.17, 0.06, 0.085)),
    "wrist": ((-0.056, -0.056, 0.054), (0.056, 0.056, 0.139)),
    "hand": ((-0.05, -0.05, -0.03), (0.05, 0.05, 0.093)),
}

POURING_START = (
    *(1.04349043096, -0.220126243062, -0.7470486437, 1.52439340796),
    *(1.88181093154, -0.96870886755, -0.490873852123),
)
SCOOPING_START = (*POURING_START[:6], 1.02968460387)
PARKED = (-1.6, 0.15, 0.0, 1.4, 0.0, 0.2, 0.0)

TABLE = Box(0.72, 1.5, 0.03)
TABLE_CENTER = (0.9, 0.27, -0.0645 - 0.03 / 2)


def welded_plant(model: Path) -> MultibodyPlant:
    plant = MultibodyPlant(time_step=0.0)
    Parser(plant).AddModels(str(model))
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.Finalize()
    return plant


@pytest.fixture(scope="module")
def plant() -> MultibodyPlant:
    return welded_plant(MODEL)


def collision_checker(sdf: str) -> SceneGraphCollisionChecker:
    """Baxter at a table, without any padding."""
    builder = RobotDiagramBuilder(time_step=0.0)
    plant = builder.plant()
    (robot,) = builder.parser().AddModelsFromString(sdf, "sdf")
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.RegisterCollisionGeometry(
        plant.world_body(), RigidTransform(TABLE_CENTER), TABLE, "table", CoulombFriction(0.5, 0.5)
    )
    plant.Finalize()
    return SceneGraphCollisionChecker(
        model=builder.Build(), robot_model_instances=[robot], edge_step_size=0.1
    )


@pytest.fixture(scope="module")
def checker() -> SceneGraphCollisionChecker:
    return collision_checker(MODEL.read_text())


def transform(
    xyz: tuple[float, float, float], rpy: tuple[float, float, float], turn: np.ndarray
) -> np.ndarray:
    """Fixed transform (xyz, then rpy as yaw * pitch * roll) and a turn (n,) about z, (n, 4, 4)."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    X = np.eye(4)
    X[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    X[:3, 3] = xyz
    Z = np.tile(np.eye(4), (len(turn), 1, 1))
    Z[:, 0, 0] = Z[:, 1, 1] = np.cos(turn)
    Z[:, 1, 0] = np.sin(turn)
    Z[:, 0, 1] = -Z[:, 1, 0]
    return X @ Z


def published_hand_pose(side: str, q: np.ndarray) -> np.ndarray:
    """The product of the published transforms for arm positions q (n, 7), (n, 4, 4)."""
    still = np.zeros(len(q))
    X = transform(*MOUNTS[side], still)
    for fixed, turn in zip(JOINT_TRANSFORMS, q.T, strict=True):
        X = X @ transform(*fixed, turn)
    return X @ transform(*HAND, still)


def positions(
    plant: MultibodyPlant, left: np.ndarray, right: np.ndarray, head: float = 0.0
) -> np.ndarray:
    """The plant's positions (n, 15) for left and right arm positions (n, 7) or (7,)."""
    left, right = np.broadcast_arrays(np.atleast_2d(left), np.atleast_2d(right))
    q = np.full((len(left), plant.num_positions()), head)
    for side, arm in (("left", left), ("right", right)):
        for joint, angles in zip(ARM_JOINTS, arm.T, strict=True):
            q[:, plant.GetJointByName(f"{side}_{joint}").position_start()] = angles
    return q


def touching(checker: SceneGraphCollisionChecker, q: np.ndarray) -> set[frozenset[str]]:
    """The pairs of bodies that touch at any of the positions q (n, 15)."""
    free = np.asarray(checker.CheckConfigsCollisionFree(list(q), parallelize=False), dtype=bool)
    pairs = set()
    for configuration in q[~free]:
        clearance = checker.CalcRobotClearance(configuration, 0.0)
        bodies = zip(clearance.robot_indices(), clearance.other_indices(), strict=True)
        for pair, distance in zip(bodies, clearance.distances(), strict=True):
            if distance < 0.0:
                pairs.add(frozenset(checker.plant().get_body(body).name() for body in pair))
    return pairs


def test_base_is_free_and_every_moving_joint_has_an_actuator() -> None:
    plant = MultibodyPlant(time_step=0.0)
    (robot,) = Parser(plant).AddModels(str(MODEL))
    plant.Finalize()
    assert plant.GetModelInstanceName(robot) == "baxter"
    assert plant.GetBodyByName("base").is_floating_base_body()
    assert plant.num_positions() == 7 + 15
    actuated = {plant.get_joint_actuator(i).joint().name() for i in plant.GetJointActuatorIndices()}
    arms = {f"{side}_{joint}" for side in MOUNTS for joint in ARM_JOINTS}
    assert actuated == arms | {"head_pan"}


@pytest.mark.parametrize("side", ["left", "right"])
def test_hand_pose_is_the_product_of_the_published_transforms(
    plant: MultibodyPlant, side: str
) -> None:
    q = np.random.default_rng(7).uniform(LOWER, UPPER, size=(1000, 7))
    expected = published_hand_pose(side, q)
    context = plant.CreateDefaultContext()
    hand = plant.GetBodyByName(f"{side}_hand")
    for q_all, X_WE in zip(positions(plant, q, q), expected, strict=True):
        plant.SetPositions(context, q_all)
        actual = plant.EvalBodyPoseInWorld(context, hand).GetAsMatrix4()
        np.testing.assert_allclose(actual, X_WE, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("side", ["left", "right"])
def test_limits_and_masses(plant: MultibodyPlant, side: str) -> None:
    joints = [plant.GetJointByName(f"{side}_{name}") for name in ARM_JOINTS]
    assert [joint.position_lower_limit() for joint in joints] == list(LOWER)
    assert [joint.position_upper_limit() for joint in joints] == list(UPPER)
    assert [joint.velocity_upper_limit() for joint in joints] == list(VELOCITY)
    assert [joint.velocity_lower_limit() for joint in joints] == [-v for v in VELOCITY]
    assert [joint.default_damping() for joint in joints] == [0.7] * 7
    actuators = {
        actuator.joint().name(): actuator.effort_limit()
        for actuator in map(plant.get_joint_actuator, plant.GetJointActuatorIndices())
    }
    assert [actuators[joint.name()] for joint in joints] == list(EFFORT)
    links = [plant.GetBodyByName(f"{side}_{name}") for name in ARM_LINKS]
    assert [link.default_mass() for link in links] == list(MASSES)
    assert plant.GetBodyByName(f"{side}_hand").default_mass() == 0.19125


def test_every_number_of_the_published_description(plant: MultibodyPlant, shared: Path) -> None:
    published = yaml.safe_load((shared / "reference" / "baxter.yaml").read_text())
    for joint in published["joints"]:
        if joint["type"] != "revolute":
            continue
        ours = plant.GetJointByName(joint["name"])
        limit = joint["limit"]
        assert ours.position_lower_limit() == limit["lower"]
        assert ours.position_upper_limit() == limit["upper"]
        assert ours.velocity_upper_limit() == limit["velocity"]
        assert ours.default_damping() == joint["damping"]
        np.testing.assert_allclose(ours.revolute_axis(), joint["axis"], rtol=0.0, atol=1e-15)
    heavy = [link for link in published["links"] if link.get("mass", 0.0) > 0.001]
    assert len(heavy) == 20
    for link in heavy:
        inertia = plant.GetBodyByName(link["name"]).default_spatial_inertia()
        com = inertia.get_com()
        about_com = inertia.Shift(com).CalcRotationalInertia()
        i = link["inertia"]
        assert inertia.get_mass() == link["mass"]
        np.testing.assert_array_equal(com, link["com"])
        np.testing.assert_allclose(
            about_com.get_moments(), [i["ixx"], i["iyy"], i["izz"]], rtol=1e-12, atol=1e-15
        )
        np.testing.assert_allclose(
            about_com.get_products(), [i["ixy"], i["ixz"], i["iyz"]], rtol=1e-9, atol=1e-15
        )


def test_frames_of_published_fixed_joints(plant: MultibodyPlant, shared: Path) -> None:
    published = yaml.safe_load((shared / "reference" / "baxter.yaml").read_text())
    context = plant.CreateDefaultContext()
    still = np.zeros(1)
    checked = set()
    for joint in published["joints"]:
        names = joint["parent"], joint["child"]
        if joint["type"] != "fixed" or not all(map(plant.HasFrameNamed, names)):
            continue
        parent, child = map(plant.GetFrameByName, names)
        X_PC = child.CalcPose(context, parent).GetAsMatrix4()
        expected = transform(joint["xyz"], joint["rpy"], still)[0]
        np.testing.assert_allclose(X_PC, expected, rtol=0.0, atol=1e-12)
        checked.add(joint["child"])
    assert {"screen", "left_hand", "left_gripper", "right_hand", "right_gripper"} <= checked


def test_collision_shapes_are_named_and_within_the_real_shells() -> None:
    builder = RobotDiagramBuilder(time_step=0.0)
    (robot,) = builder.parser().AddModels(str(MODEL))
    builder.plant().Finalize()
    inspector = builder.scene_graph().model_inspector()
    plant = builder.plant()
    shapes = 0
    for index in plant.GetBodyIndices(robot):
        body = plant.get_body(index)
        ids = plant.GetCollisionGeometriesForBody(body)
        shapes += len(ids)
        names = {inspector.GetName(i).removeprefix("baxter::") for i in ids}
        assert len(names) == len(ids)
        assert all(names)
        extents = EXTENTS.get(body.name().removeprefix("left_").removeprefix("right_"))
        assert extents is not None or not ids
        for i in ids:
            box = inspector.GetObbInGeometryFrame(i)
            X_BO = inspector.GetPoseInFrame(i) @ box.pose()
            reach = np.abs(X_BO.rotation().matrix()) @ box.half_width()
            assert np.all(X_BO.translation() - reach >= np.array(extents[0]) - 1e-6), names
            assert np.all(X_BO.translation() + reach <= np.array(extents[1]) + 1e-6), names
    assert shapes == inspector.NumGeometriesWithRole(Role.kProximity) > 0


@pytest.mark.parametrize("head", [-H, 0.0, H])
@pytest.mark.parametrize("start", [POURING_START, SCOOPING_START], ids=["pouring", "scooping"])
def test_start_with_the_right_arm_parked_is_free(
    checker: SceneGraphCollisionChecker, start: tuple[float, ...], head: float
) -> None:
    q = positions(checker.plant(), np.array(start), np.array(PARKED), head)
    assert touching(checker, q) == set()


@pytest.mark.parametrize(
    ("bodies", "left"),
    [
        ({"left_hand", "torso"}, (-1.3, 0.9, -2.4, 1.9, 0.5, 2.0, -0.9)),
        ({"left_upper_forearm", "torso"}, (-0.2, -1.8, -1.8, 1.0, -0.2, -0.1, -0.7)),
        ({"left_hand", "screen"}, (0.3, -0.1, -2.5, 2.1, 2.7, -1.0, -0.5)),
        ({"left_upper_forearm", "head"}, (1.6, -1.8, 2.2, 1.5, -1.4, 1.2, -2.6)),
        ({"left_upper_forearm", "right_upper_shoulder"}, (-1.6, 0.5, -2.0, 1.2, 0.5, -1.3, -2.0)),
        ({"left_hand", "pedestal"}, (1.2, 0.5, 0.1, 1.5, -2.5, -1.2, -1.0)),
        ({"left_hand", "left_upper_shoulder"}, (0.3, -0.9, -0.7, 2.2, -0.3, 1.9, -0.6)),
        ({"left_upper_forearm", "left_upper_shoulder"}, (-0.1, 1.0, 0.8, 2.5, 2.8, 0.1, 1.1)),
        ({"left_hand", "world"}, (-0.6, -0.6, 0.2, 1.9, -1.9, -0.1, 0.0)),
    ],
    ids=lambda value: "-".join(sorted(value)) if isinstance(value, set) else "",
)
def test_arm_hits_what_is_in_its_way(
    checker: SceneGraphCollisionChecker, bodies: set[str], left: tuple[float, ...]
) -> None:
    q = positions(checker.plant(), np.array(left), np.array(PARKED))
    assert touching(checker, q) == {frozenset(bodies)}


def test_collision_filters_hide_no_contact() -> None:
    """The one or two joints between two filtered links set their distance: search all of it."""
    filters = r"<drake:collision_filter_group name.*?</drake:collision_filter_group>"
    sdf, removed = re.subn(filters, "", MODEL.read_text(), flags=re.DOTALL)
    assert removed == 7
    checker = collision_checker(sdf)
    plant = checker.plant()
    start = positions(plant, np.array(POURING_START), np.array(PARKED))
    searches = [("head_pan", "head_pan", "torso", "screen")]
    for side in MOUNTS:
        s0, s1, e0, _, _, _, w2 = (f"{side}_{name}" for name in ARM_JOINTS)
        searches += [
            (s0, s1, "torso", f"{side}_lower_shoulder"),
            (s1, e0, f"{side}_upper_shoulder", f"{side}_upper_elbow"),
            (w2, w2, f"{side}_lower_forearm", f"{side}_hand"),
        ]
    for first, second, *pair in searches:
        q = np.repeat(start, 15 * 15, axis=0)
        grids = np.meshgrid(np.linspace(0.0, 1.0, 15), np.linspace(0.0, 1.0, 15))
        for name, share in zip((first, second), grids, strict=True):
            joint = plant.GetJointByName(name)
            lower, upper = joint.position_lower_limit(), joint.position_upper_limit()
            q[:, joint.position_start()] = lower + share.ravel() * (upper - lower)
        assert frozenset(pair) not in touching(checker, q)


@pytest.mark.parametrize("side", ["left", "right"])
def test_elbow_and_wrist_bend_to_their_limits(
    checker: SceneGraphCollisionChecker, side: str
) -> None:
    bends = [(e1, w1) for e1 in (LOWER[3], UPPER[3]) for w1 in (LOWER[5], 0.0)]
    arm = np.array([(0.0, -0.5, 0.0, e1, 0.0, w1, 0.0) for e1, w1 in (*bends, (1.0, UPPER[5]))])
    arms = {"left": np.array(POURING_START), "right": np.array(PARKED), side: arm}
    pairs = touching(checker, positions(checker.plant(), arms["left"], arms["right"]))
    assert not any(all(body.startswith(side) for body in pair) for pair in pairs)


@pytest.mark.parametrize("task", ["pouring", "scooping"])
def test_recorded_demonstrations_touch_nothing(
    checker: SceneGraphCollisionChecker, shared: Path, task: str
) -> None:
    """As recorded, both arms, with a table on whose top the origin of the recorded bowl lies."""
    files = sorted((shared / "demos" / task).glob("*/joint_angles.csv"))
    assert len(files) == 16
    for file in files:
        rows = np.loadtxt(file, delimiter=",", skiprows=1)[::2]
        q = positions(checker.plant(), rows[:, 1:8], rows[:, 9:16])
        assert touching(checker, q) == set(), file.parent.name


def test_calibrated_arm_loads_through_the_same_door(plant: MultibodyPlant, shared: Path) -> None:
    calibrated = welded_plant(shared / "reference" / "baxter_left_calibrated.sdf")
    assert [calibrated.get_joint(i).name() for i in calibrated.GetJointIndices()][:7] == [
        f"left_{name}" for name in ARM_JOINTS
    ]
    p_WE = [
        each.GetFrameByName("left_hand").CalcPoseInWorld(each.CreateDefaultContext()).translation()
        for each in (plant, calibrated)
    ]
    assert 0.001 < np.linalg.norm(p_WE[0] - p_WE[1]) < 0.02
