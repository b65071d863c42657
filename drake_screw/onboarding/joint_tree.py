"""The joints of a robot that move, and what each of them moves."""

from __future__ import annotations

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, Joint, JointIndex

from drake_screw.robot.names import called, scoped, shown_name


class JointTree:
    """Joints that move, by the bodies that they move."""

    def __init__(self, plant: MultibodyPlant) -> None:
        self.plant = plant
        self.inboard: dict[BodyIndex, Joint] = {}
        for index in plant.GetJointIndices():
            joint = plant.get_joint(index)
            self.inboard[joint.child_body().index()] = joint
        self.moving = [
            index
            for index in plant.GetJointIndices()
            if plant.get_joint(index).type_name() in ("revolute", "prismatic")
        ]
        self.way = {index: self._way(index) for index in self.moving}
        self.next: dict[JointIndex, list[JointIndex]] = {index: [] for index in self.moving}
        for index, way in self.way.items():
            if len(way) > 1:
                self.next[way[-2]].append(index)

    def joint(self, index: JointIndex) -> Joint:
        """By its index."""
        return self.plant.get_joint(index)

    def name(self, index: JointIndex) -> str:
        """Plain where that tells it from all others, else with its model's before it."""
        joint = self.plant.get_joint(index)
        alike = [
            i for i in self.plant.GetJointIndices() if called(self.plant.get_joint(i), joint.name())
        ]
        return str(joint.name()) if len(alike) == 1 else scoped(joint)

    def _way(self, index: JointIndex) -> tuple[JointIndex, ...]:
        """Moving joints from the root to this one."""
        return (*self._to(self.plant.get_joint(index).parent_body().index()), index)

    def _to(self, body: BodyIndex) -> tuple[JointIndex, ...]:
        """Moving joints from the root to a body."""
        way = []
        while body in self.inboard:
            joint = self.inboard[body]
            if joint.index() in self.moving:
                way.append(joint.index())
            body = joint.parent_body().index()
        return tuple(reversed(way))

    def root(self, index: JointIndex) -> str:
        """The link at the world, or the first that is fixed to it, on the way to a joint."""
        body = self.plant.get_joint(index).parent_body()
        world = self.plant.world_body().index()
        while body.index() in self.inboard:
            parent = self.inboard[body.index()].parent_body()
            if parent.index() == world:
                break
            body = parent
        return shown_name(body)

    def between(self, base: str, tip: str) -> tuple[JointIndex, ...]:
        """Moving joints on the way from a link to another one; none if there is no such way."""
        bodies = [self.plant.get_body(BodyIndex(i)) for i in range(self.plant.num_bodies())]
        begins = [self._to(body.index()) for body in bodies if called(body, base)]
        ends = [self._to(body.index()) for body in bodies if called(body, tip)]
        if not begins or not ends or ends[0][: len(begins[0])] != begins[0]:
            return ()
        return ends[0][len(begins[0]) :]

    def paths(self) -> list[tuple[JointIndex, ...]]:
        """From the root to each end."""
        return [self.way[index] for index in self.moving if not self.next[index]]

    def depth(self, index: JointIndex) -> int:
        """Joints of the longest chain from this one on."""
        return 1 + max((self.depth(j) for j in self.next[index]), default=0)

    def behind(self, index: JointIndex) -> list[JointIndex]:
        """Joints behind this one, nearest first."""
        return [j for child in self.next[index] for j in (child, *self.behind(child))]
