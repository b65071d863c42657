"""The Drake side of a scenario: robot, table and objects in one plant, with collision queries."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from pydrake.geometry import HalfSpace, SceneGraph, Shape, Sphere
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex, RigidBody
from pydrake.planning import (
    CollisionCheckerParams,
    RobotDiagram,
    RobotDiagramBuilder,
    SceneGraphCollisionChecker,
)

from drake_screw.errors import ModelError
from drake_screw.robot.arm import Arm
from drake_screw.robot.ignored import let_links_touch
from drake_screw.robot.model_file import ModelFile
from drake_screw.robot.names import shown_name
from drake_screw.robot.obstacles import ObstacleConfig
from drake_screw.robot.parts import (
    ObjectConfig,
    RobotConfig,
    TableConfig,
    add_robot,
    add_surroundings,
)
from drake_screw.screws import pose, quaternion_from_rotation
from drake_screw.typing import Array

MANY = 100
"""Configurations from which on sharing them out among threads takes less time than it saves."""


FAR = 1e3
"""m, where objects are that are to touch nothing."""

GRAZE = 1e-9
"""m, between bodies that touch: rounding, since to be at a distance of 0 is to collide."""


@dataclass(frozen=True)
class Workcell:
    """Robot, table, obstacles and objects in one Drake diagram.

    Objects are free bodies of the plant, so that one workcell serves every task instance: give
    their poses X_WO with each query.

    Attributes:
        diagram, plant, scene_graph: finalized, without dynamics (continuous time).
        arm: the arm that is planned for.
        start: (n,) rad, its start configuration.
        objects: the objects' bodies.
        robot: the model instances of the robot, and of what it holds.
        model: what the robot was read from.
        checker: looks at collisions.
        obstacles: the obstacles' bodies.
        tool: the body of what the end effector holds, if that has a shape.
        unknown_links: named among the pairs that may touch, but none of the robot's.
    """

    diagram: RobotDiagram
    plant: MultibodyPlant
    scene_graph: SceneGraph
    arm: Arm
    start: Array
    objects: tuple[RigidBody, ...]
    robot: tuple[ModelInstanceIndex, ...]
    model: ModelFile
    checker: SceneGraphCollisionChecker
    obstacles: tuple[RigidBody, ...] = ()
    tool: RigidBody | None = None
    unknown_links: tuple[str, ...] = ()

    @property
    def model_file(self) -> Path:
        """Where the robot was read from."""
        return self.model.file

    def positions(self, q: ArrayLike, X_WO: ArrayLike) -> Array:
        """Positions of the whole plant.

        Args:
            q: (..., n) rad or m, of the arm.
            X_WO: (..., k, 4, 4) poses of the k objects; leading axes broadcast.

        Returns:
            (..., plant.num_positions()).
        """
        full, X_WO = self.arm.full_positions(q), np.asarray(X_WO, dtype=float)
        shape = np.broadcast_shapes(full.shape[:-1], X_WO.shape[:-3])
        full = np.broadcast_to(full, (*shape, full.shape[-1])).copy()
        for i, body in enumerate(self.objects):
            first = body.floating_positions_start()
            full[..., first : first + 4] = quaternion_from_rotation(X_WO[..., i, :3, :3])
            full[..., first + 4 : first + 7] = X_WO[..., i, :3, 3]
        return full

    @property
    def objects_away(self) -> Array:
        """(k, 4, 4) poses of the objects where they touch nothing."""
        return pose(np.eye(3), np.arange(1.0, len(self.objects) + 1)[:, None] * [0.0, 0.0, FAR])

    @cached_property
    def pairs(self) -> tuple[tuple[BodyIndex, BodyIndex], ...]:
        """Bodies that could touch, one of them the robot's, as far as Drake looks at them."""
        shaped = [
            i
            for i in map(BodyIndex, range(self.plant.num_bodies()))
            if len(self.plant.GetCollisionGeometriesForBody(self.plant.get_body(i))) > 0
        ]
        robot = {i for i in shaped if self.checker.IsPartOfRobot(i)}
        return tuple(
            (a, b)
            for a, b in itertools.combinations(shaped, 2)
            if (a in robot or b in robot) and not self.checker.IsCollisionFilteredBetween(a, b)
        )

    def touching(self, pair: int) -> tuple[str, str]:
        """Names of the two bodies of one of `pairs`, as `name` has them, the robot's first."""
        a, b = self.pairs[pair]
        if not self.checker.IsPartOfRobot(a):
            a, b = b, a
        return self.name(a), self.name(b)

    def name(self, body: BodyIndex) -> str:
        """A body's name as people see it: with its model's where two bodies share it."""
        return self._names[int(body)]

    @cached_property
    def _names(self) -> tuple[str, ...]:
        bodies = map(BodyIndex, range(self.plant.num_bodies()))
        return tuple(shown_name(self.plant.get_body(i)) for i in bodies)

    def keeping(self, clearance: float) -> SceneGraphCollisionChecker:
        """A checker for which nearer than a clearance in m is a collision."""
        checker = self.checker.Clone()
        checker.SetPaddingAllRobotEnvironmentPairs(clearance)
        checker.SetPaddingAllRobotRobotPairs(clearance)
        return checker

    def collides(
        self,
        q: ArrayLike,
        X_WO: ArrayLike,
        *,
        checker: SceneGraphCollisionChecker | None = None,
    ) -> Array:
        """Whether the robot touches itself, the table, an obstacle or an object.

        What the end effector holds counts as the robot where it has a shape.

        Args:
            q: (m, n).
            X_WO: (k, 4, 4) or (m, k, 4, 4).
            checker: by which; without clearance if None.

        Returns:
            (m,) bool.
        """
        full = self.positions(q, X_WO)
        parallel = len(full) >= MANY
        free = (checker or self.checker).CheckConfigsCollisionFree(list(full), parallelize=parallel)
        return ~np.array(free, dtype=bool)

    def colliding_bodies(
        self, q: ArrayLike, X_WO: ArrayLike, clearance: float = 0.0
    ) -> tuple[tuple[str, str], ...]:
        """Names of bodies that touch at q (n,), or are no farther apart than a clearance in m.

        In pairs, the robot's first; those that are nearest, or deepest in one another, come first.
        """
        reach = clearance + GRAZE
        found = self.checker.CalcRobotClearance(self.positions(q, X_WO), reach)
        distances = np.asarray(found.distances())
        robot, other = found.robot_indices(), found.other_indices()
        names = [
            (self.name(robot[i]), self.name(other[i]))
            for i in np.argsort(distances, kind="stable").tolist()
            if distances[i] <= reach
        ]
        return tuple(dict.fromkeys(names))


def build_workcell(
    robot: RobotConfig,
    *,
    table: TableConfig | None = None,
    objects: Sequence[ObjectConfig] = (),
    obstacles: Sequence[ObstacleConfig] = (),
) -> Workcell:
    """Build the diagram of a robot, a table, some objects and some obstacles.

    Raises:
        ModelError: the model cannot be read, or lacks a name the configuration asks for; a mesh
            cannot be read; two things have one name; Drake cannot tell whether two shapes touch.
    """
    builder = RobotDiagramBuilder(time_step=0.0)
    plant: MultibodyPlant = builder.plant()
    added = add_robot(builder.parser(), robot)
    fixed, bodies = add_surroundings(plant, table, objects, obstacles)
    plant.Finalize()
    arm = added.arm()
    if len(robot.start) != arm.n:
        raise ModelError(
            f"the start configuration has {len(robot.start)} angles for {arm.n} joints"
        )
    scene_graph = builder.scene_graph()
    if robot.tool is not None:
        arm.held(robot.tool.frame)
    added.let_tools_touch(scene_graph)
    unknown_links = let_links_touch(plant, scene_graph, added.models, robot)
    diagram = builder.Build()
    arm.owner = diagram
    checker = SceneGraphCollisionChecker(
        CollisionCheckerParams(
            model=diagram, robot_model_instances=list(added.instances), edge_step_size=0.05
        )
    )
    start = np.array(robot.start, dtype=float)
    workcell = Workcell(
        diagram, plant, scene_graph, arm, start, bodies, added.instances, added.model, checker,
        fixed, added.tool, unknown_links,
    )  # fmt: skip
    _check_planes(workcell)
    return workcell


def _check_planes(workcell: Workcell) -> None:
    """Refuse half spaces beside anything but balls: Drake knows no distance of these."""
    plant, inspector = workcell.plant, workcell.scene_graph.model_inspector()

    def shapes(body: BodyIndex) -> list[Shape]:
        geometries = plant.GetCollisionGeometriesForBody(plant.get_body(body))
        return [inspector.GetShape(geometry) for geometry in geometries]

    for a, b in itertools.chain.from_iterable((pair, pair[::-1]) for pair in workcell.pairs):
        if not any(isinstance(shape, HalfSpace) for shape in shapes(a)):
            continue
        for other in shapes(b):
            if not isinstance(other, Sphere):
                plane, beside = workcell.name(a), workcell.name(b)
                raise ModelError(
                    f"a collision shape of link '{plane}' is a plane, and Drake cannot tell "
                    f"whether it touches the {type(other).__name__.lower()} of '{beside}'",
                    remedy="Give the link a large box in place of the plane, its top where the "
                    "plane is.",
                    file=workcell.model_file,
                )
