"""models/iiwa14.sdf against the maker's published numbers."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Role
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.planning import RobotDiagramBuilder, SceneGraphCollisionChecker

from drake_screw.robot import Arm
from drake_screw.screws import exp

MODEL = Path(__file__).parents[2] / "models" / "iiwa14.sdf"
JOINTS = tuple(f"iiwa_joint_{i}" for i in range(1, 8))
LINKS = ("base", *(f"link_{i}" for i in range(1, 8)), "hand")

# Heights of the joints above one another, and of the hand above the last (m).
OFFSETS = (0.1575, 0.2025, 0.2045, 0.2155, 0.1845, 0.2155, 0.081, 0.045)
# The data sheet's: floor to shoulder, on to the elbow, to the wrist, to the flange (m).
SHOULDER, UPPER_ARM, FOREARM, FLANGE = 0.36, 0.42, 0.40, 0.126
AXES = ((0, 0, 1), (0, 1, 0), (0, 0, 1), (0, -1, 0), (0, 0, 1), (0, 1, 0), (0, 0, 1))
LIMITS = (170, 120, 170, 120, 170, 120, 175)
SPEEDS = (85, 85, 100, 75, 130, 135, 135)
TORQUES = (320, 320, 176, 176, 110, 40, 40)


@pytest.fixture(scope="module")
def arm() -> Arm:
    plant = MultibodyPlant(time_step=0.0)
    Parser(plant).AddModels(str(MODEL))
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.Finalize()
    return Arm(plant, JOINTS, "hand")


def collision_checker(sdf: str) -> SceneGraphCollisionChecker:
    builder = RobotDiagramBuilder(time_step=0.0)
    (robot,) = builder.parser().AddModelsFromString(sdf, "sdf")
    plant = builder.plant()
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.Finalize()
    return SceneGraphCollisionChecker(
        model=builder.Build(), robot_model_instances=[robot], edge_step_size=0.1
    )


def touching(checker: SceneGraphCollisionChecker, q: np.ndarray) -> set[frozenset[str]]:
    clearance = checker.CalcRobotClearance(q, 0.0)
    bodies = zip(clearance.robot_indices(), clearance.other_indices(), strict=True)
    return {
        frozenset(checker.plant().get_body(body).name() for body in pair)
        for pair, distance in zip(bodies, clearance.distances(), strict=True)
        if distance < 0.0
    }


def published_pose(q: np.ndarray) -> np.ndarray:
    """The end effector by the published offsets and axes; q (7,) to (4, 4)."""
    X = np.eye(4)
    for i in range(8):
        up = np.eye(4)
        up[2, 3] = OFFSETS[i]
        X = X @ up
        if i < 7:
            X = X @ exp(np.array([*AXES[i], 0.0, 0.0, 0.0]) * q[i])
    return X


def test_base_is_free_and_every_joint_has_an_actuator() -> None:
    plant = MultibodyPlant(time_step=0.0)
    (robot,) = Parser(plant).AddModels(str(MODEL))
    plant.Finalize()
    assert plant.GetModelInstanceName(robot) == "iiwa14"
    assert plant.GetBodyByName("base").is_floating_base_body()
    assert tuple(plant.get_body(i).name() for i in plant.GetBodyIndices(robot)) == LINKS
    actuated = [plant.get_joint_actuator(i) for i in plant.GetJointActuatorIndices()]
    assert tuple(actuator.joint().name() for actuator in actuated) == JOINTS
    assert tuple(actuator.effort_limit() for actuator in actuated) == TORQUES


def test_limits_and_speeds_are_the_published_ones(arm: Arm) -> None:
    np.testing.assert_allclose(arm.upper, np.radians(LIMITS), atol=1e-9)
    np.testing.assert_array_equal(arm.lower, -arm.upper)
    np.testing.assert_allclose(arm.velocity_limits, np.radians(SPEEDS), atol=1e-9)


def test_hand_pose_is_that_of_the_published_offsets(arm: Arm) -> None:
    q = np.random.default_rng(0).uniform(arm.lower, arm.upper, (200, 7))
    expected = np.array([published_pose(each) for each in q])
    np.testing.assert_allclose(arm.pose(q), expected, atol=1e-9)


def test_stretched_out_it_is_as_long_as_the_data_sheet_says(arm: Arm) -> None:
    upright = arm.pose(np.zeros(7))
    np.testing.assert_allclose(upright[:3, :3], np.eye(3), atol=1e-12)
    np.testing.assert_allclose(
        upright[:3, 3], [0, 0, SHOULDER + UPPER_ARM + FOREARM + FLANGE], atol=1e-12
    )
    forward = arm.pose([0, np.pi / 2, 0, 0, 0, 0, 0])
    np.testing.assert_allclose(
        forward[:3, 3], [UPPER_ARM + FOREARM + FLANGE, 0, SHOULDER], atol=1e-12
    )
    np.testing.assert_allclose(forward[:3, 2], [1, 0, 0], atol=1e-12)  # z points out of the tool
    chain = arm.screw_chain()
    assert chain.reach == pytest.approx(UPPER_ARM + FOREARM + FLANGE)
    np.testing.assert_allclose(chain.shoulder, [0, 0, SHOULDER], atol=1e-12)


def test_shoulder_elbow_and_wrist_keep_their_distances(arm: Arm) -> None:
    context = arm.plant.CreateDefaultContext()
    places = [arm.plant.GetFrameByName(f"link_{i}") for i in (2, 4, 6)]
    for q in np.random.default_rng(1).uniform(arm.lower, arm.upper, (50, 7)):
        arm.plant.SetPositions(context, q)
        shoulder, elbow, wrist = (f.CalcPoseInWorld(context).translation() for f in places)
        assert np.linalg.norm(elbow - shoulder) == pytest.approx(UPPER_ARM)
        assert np.linalg.norm(wrist - elbow) == pytest.approx(FOREARM)
        assert np.linalg.norm(arm.pose(q)[:3, 3] - wrist) == pytest.approx(FLANGE)


def test_masses_add_up_to_about_the_published_weight(arm: Arm) -> None:
    masses = [arm.plant.GetBodyByName(name).default_mass() for name in LINKS[:-1]]
    assert min(masses) > 0.0
    assert sum(masses) == pytest.approx(29.9, rel=0.05)
    assert all(arm.plant.GetBodyByName(n).default_spatial_inertia().IsPhysicallyValid()
               for n in LINKS)  # fmt: skip


def test_every_link_has_named_shapes_for_the_eye_and_for_collisions() -> None:
    builder = RobotDiagramBuilder(time_step=0.0)
    builder.parser().AddModels(str(MODEL))
    builder.plant().Finalize()
    inspector, plant = builder.scene_graph().model_inspector(), builder.plant()
    for name in LINKS:
        frame = plant.GetBodyFrameIdOrThrow(plant.GetBodyByName(name).index())
        for role in (Role.kProximity, Role.kIllustration):
            found = [inspector.GetName(i) for i in inspector.GetGeometries(frame, role)]
            assert found, name
            assert len(set(found)) == len(found)
            assert all(re.fullmatch(r"(iiwa14::)?[a-z_]+", each) for each in found)


@pytest.mark.parametrize(
    ("bodies", "q"),
    [
        (set(), (0.0,) * 7),
        (set(), (0.7, 0.6, 0.0, -1.9, 0.0, -0.93, 0.0)),
        (set(), (0.0, 0.0, 0.0, -2.09, 0.0, 2.09, 0.0)),
        ({"base", "hand"}, (0.0, 1.44, 0.0, -2.09, 0.0, 1.56, 0.0)),
        ({"base", "link_6"}, (0.0, 1.86, 0.0, -2.04, 0.0, -1.32, 0.0)),
    ],
)
def test_it_touches_itself_only_where_it_folds_onto_its_foot(
    bodies: set[str], q: tuple[float, ...]
) -> None:
    found = touching(collision_checker(MODEL.read_text()), np.array(q))
    assert found == ({frozenset(bodies)} if bodies else set())


def test_the_collision_filter_hides_no_contact() -> None:
    filters = r"<drake:collision_filter_group name.*?</drake:collision_filter_group>"
    sdf, removed = re.subn(filters, "", MODEL.read_text(), flags=re.DOTALL)
    assert removed == 1
    checker = collision_checker(sdf)
    for tilt in np.linspace(*np.radians([-120.0, 120.0]), 41):
        for turn in np.linspace(-3.0, 3.0, 13):
            q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, tilt, turn])
            assert frozenset({"link_5", "link_7"}) not in touching(checker, q)
