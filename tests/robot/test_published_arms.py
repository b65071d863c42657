"""models/panda.sdf and models/ur5e.sdf against their makers' published numbers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Role
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.planning import RobotDiagramBuilder

from drake_screw.assembly.setup import Setup
from drake_screw.robot import Arm
from drake_screw.scenario.loader import load_scenario

MODELS = Path(__file__).parents[2] / "models"
QUARTER = np.pi / 2


def turn(axis: int, angle: float) -> np.ndarray:
    """X (4, 4) about x (0) or z (2)."""
    c, s = np.cos(angle), np.sin(angle)
    X = np.eye(4)
    i, j = {0: (1, 2), 2: (0, 1)}[axis]
    X[i, i], X[i, j], X[j, i], X[j, j] = c, -s, s, c
    return X


def along(axis: int, length: float) -> np.ndarray:
    X = np.eye(4)
    X[axis, 3] = length
    return X


def panda(q: np.ndarray) -> np.ndarray:
    """The flange by the maker's table, in Craig's convention: a, d, alpha before each joint."""
    table = [
        (0.0, 0.333, 0.0),
        (0.0, 0.0, -QUARTER),
        (0.0, 0.316, QUARTER),
        (0.0825, 0.0, QUARTER),
        (-0.0825, 0.384, -QUARTER),
        (0.0, 0.0, QUARTER),
        (0.088, 0.0, QUARTER),
    ]
    joints = [
        turn(0, alpha) @ along(0, a) @ turn(2, angle) @ along(2, d)
        for (a, d, alpha), angle in zip(table, q, strict=True)
    ]
    return reduce(np.matmul, joints) @ along(2, 0.107) @ turn(2, -np.pi / 4)


def ur5e(q: np.ndarray) -> np.ndarray:
    """The flange by the maker's table: a, d, alpha behind each joint."""
    table = [
        (0.0, 0.1625, QUARTER),
        (-0.425, 0.0, 0.0),
        (-0.3922, 0.0, 0.0),
        (0.0, 0.1333, QUARTER),
        (0.0, 0.0997, -QUARTER),
        (0.0, 0.0996, 0.0),
    ]
    joints = [
        turn(2, angle) @ along(2, d) @ along(0, a) @ turn(0, alpha)
        for (a, d, alpha), angle in zip(table, q, strict=True)
    ]
    return reduce(np.matmul, joints)


@dataclass(frozen=True)
class Published:
    name: str
    pose: object
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    speeds: tuple[float, ...]
    torques: tuple[float, ...]
    weight: tuple[float, float]
    usual: tuple[tuple[float, ...], ...]
    """Configurations in which the real arm touches nothing of itself."""


PANDA = Published(
    "panda",
    panda,
    (-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973),
    (2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973),
    (2.175,) * 4 + (2.61,) * 3,
    (87.0,) * 4 + (12.0,) * 3,
    (18.0, 25.0),
    (
        (0.0, -np.pi / 4, 0.0, -3 * np.pi / 4, 0.0, np.pi / 2, np.pi / 4),
        (0.0, 0.0, 0.0, -0.07, 0.0, 1.87, 0.79),
        (0.0, 1.75, 0.0, -0.07, 0.0, 1.87, 0.79),
        (0.0, -1.75, 0.0, -0.07, 0.0, 1.87, 0.79),
    ),
)
UR5E = Published(
    "ur5e",
    ur5e,
    (-2 * np.pi, -2 * np.pi, -np.pi, -2 * np.pi, -2 * np.pi, -2 * np.pi),
    (2 * np.pi, 2 * np.pi, np.pi, 2 * np.pi, 2 * np.pi, 2 * np.pi),
    (np.pi,) * 6,
    (150.0,) * 3 + (28.0,) * 3,
    (20.0, 25.0),
    (
        (0.0, -np.pi / 2, 0.0, -np.pi / 2, 0.0, 0.0),
        (0.0, -np.pi / 2, -np.pi / 2, -np.pi / 2, np.pi / 2, 0.0),
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    ),
)


@pytest.fixture(scope="module", params=[PANDA, UR5E], ids=lambda each: each.name)
def published(request: pytest.FixtureRequest) -> Published:
    return request.param


@pytest.fixture(scope="module")
def setup(published: Published) -> Setup:
    return Setup(load_scenario(f"pouring_{published.name}"))


@pytest.fixture(scope="module")
def arm(setup: Setup) -> Arm:
    return setup.workcell.arm


def test_the_hand_is_where_the_makers_table_has_it(published: Published, arm: Arm) -> None:
    q = np.random.default_rng(0).uniform(arm.lower, arm.upper, (200, arm.n))
    expected = np.array([published.pose(each) for each in q])
    np.testing.assert_allclose(arm.pose(q), expected, atol=1e-6)


def test_limits_speeds_and_torques_are_the_published_ones(published: Published, arm: Arm) -> None:
    np.testing.assert_allclose(arm.lower, published.lower, atol=1e-6)
    np.testing.assert_allclose(arm.upper, published.upper, atol=1e-6)
    np.testing.assert_allclose(arm.velocity_limits, published.speeds, atol=1e-6)
    plant = MultibodyPlant(time_step=0.0)
    Parser(plant).AddModels(str(MODELS / f"{published.name}.sdf"))
    plant.Finalize()
    assert plant.GetBodyByName("base").is_floating_base_body()
    actuators = [plant.get_joint_actuator(i) for i in plant.GetJointActuatorIndices()]
    assert tuple(a.effort_limit() for a in actuators) == published.torques
    bodies = [plant.get_body(i) for i in plant.GetBodyIndices(plant.GetModelInstanceByName(
        published.name))]  # fmt: skip
    assert all(body.default_spatial_inertia().IsPhysicallyValid() for body in bodies)
    assert published.weight[0] < sum(body.default_mass() for body in bodies) < published.weight[1]


def test_every_link_is_seen_and_can_be_touched(published: Published) -> None:
    builder = RobotDiagramBuilder(time_step=0.0)
    (robot,) = builder.parser().AddModels(str(MODELS / f"{published.name}.sdf"))
    builder.plant().Finalize()
    inspector, plant = builder.scene_graph().model_inspector(), builder.plant()
    for body in plant.GetBodyIndices(robot):
        frame = plant.GetBodyFrameIdOrThrow(body)
        for role in (Role.kProximity, Role.kIllustration):
            assert inspector.GetGeometries(frame, role), plant.get_body(body).name()


def test_it_touches_nothing_of_itself_as_it_usually_stands(
    published: Published, setup: Setup
) -> None:
    far = np.eye(4)[None].copy()
    far[0, :3, 3] = 5.0, 0.0, 5.0
    workcell = setup.workcell
    for q in (*published.usual, tuple(workcell.start)):
        found = workcell.colliding_bodies(np.array(q), far)
        assert [pair for pair in found if "table" not in pair] == []
    table = workcell.colliding_bodies(workcell.start, far)
    assert table == ()
    rng = np.random.default_rng(2)
    q = rng.uniform(workcell.arm.lower, workcell.arm.upper, (200, workcell.arm.n))
    named = {name for each in q for pair in workcell.colliding_bodies(each, far) for name in pair}
    assert "hand" in named  # shapes that never meet anything would pass, too
