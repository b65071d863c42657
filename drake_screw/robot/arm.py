"""One serial arm of a Drake plant: what planning needs of it, looked up by names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable

from drake_screw.errors import ModelError
from drake_screw.robot.names import Instances, find_frame, find_joint
from drake_screw.robot.screw_chain import ScrewChain
from drake_screw.robot.velocities import assumed_in_words
from drake_screw.robot.velocities import velocity_limits as resolved
from drake_screw.robot.wrist import Wrist, wrist_of
from drake_screw.screws import shift
from drake_screw.screws.endless import is_endless, middles
from drake_screw.typing import Array


class Arm:
    """Kinematics and limits of some revolute and prismatic joints of a finalized plant.

    `owner` keeps alive what owns the plant: a plant does not keep its diagram.

    Args:
        plant: finalized; it stays the source of truth for everything here.
        joint_names: the arm's n joints, base to end effector.
        end_effector: name of the frame E that follows the screws.
        parked: positions of other joints (rad, m) by name; the rest keep the plant's defaults.
        robot: the models that names are looked up in; all of the plant's if None. A name that
            several of them have is given with its model's, as "left::hand".
        velocity_limits: rad/s (m/s) of the arm's joints by name, in place of the plant's.

    Attributes:
        joints: the plant's own, in the arm's order.
        lower, upper: (n,) rad or m, position limits; infinite where there are none.
        endless: (n,) bool, which joints are without: only those that turn may be.
        velocity_limits: (n,) rad/s or m/s, finite and above 0.
        assumed_velocities: names of the joints whose velocity limit is a default, for want of one.

    Raises:
        ModelError: a name the plant does not have (the message lists those it has), a joint that
            is neither revolute nor prismatic, joints out of order, one with half its limits or a
            prismatic one without, or one that does not move E.
    """

    def __init__(
        self,
        plant: MultibodyPlant,
        joint_names: Sequence[str],
        end_effector: str,
        *,
        parked: Mapping[str, float] | None = None,
        robot: Instances | None = None,
        velocity_limits: Mapping[str, float] | None = None,
    ) -> None:
        self.plant = plant
        self.owner: object = None
        self.joint_names = tuple(joint_names)
        self.end_effector = end_effector
        self._context = plant.CreateDefaultContext()
        self._W = plant.world_frame()
        self._robot = robot
        self._E = find_frame(plant, end_effector, robot)
        joints = [find_joint(plant, name, robot) for name in self.joint_names]
        self.joints = tuple(joints)
        for joint in joints:
            if joint.type_name() not in ("revolute", "prismatic"):
                raise ModelError(
                    f"joint '{joint.name()}' is {joint.type_name()}",
                    remedy="An arm is made of revolute and prismatic joints.",
                )
        carried = [len(plant.GetBodiesKinematicallyAffectedBy([j.index()])) for j in joints]
        for i in np.flatnonzero(np.diff(carried) >= 0):
            raise ModelError(
                f"joint '{self.joint_names[i + 1]}' does not come after '{self.joint_names[i]}'",
                remedy="List the joints from the base to the end effector, each once.",
            )
        for name, value in (parked or {}).items():
            joint = find_joint(plant, name, robot)
            if joint.num_positions() != 1:
                raise ModelError(f"joint '{name}' cannot be parked: it does not have one position")
            plant.SetPositions(
                self._context,
                _with(plant.GetPositions(self._context), joint.position_start(), value),
            )
        self._q0 = plant.GetPositions(self._context)
        self._columns = np.array([joint.position_start() for joint in joints])
        self.lower = np.array([joint.position_lower_limits()[0] for joint in joints])
        self.upper = np.array([joint.position_upper_limits()[0] for joint in joints])
        self.velocity_limits, self.assumed_velocities = resolved(
            joints, velocity_limits or {}, self.joint_names
        )
        self.endless = is_endless(self.lower, self.upper) & ~self.slides
        limited = np.isfinite(self.lower) & np.isfinite(self.upper)
        if not (limited | self.endless).all():
            raise ModelError(
                f"joint '{self.joint_names[int(np.argmin(limited | self.endless))]}' has no "
                "position limits",
                remedy="Give it two finite limits in the model; only a joint that turns may do "
                "without both.",
            )
        moves = np.linalg.norm(self.jacobian(self.middle), axis=0) > 1e-9
        if not moves.all():
            raise ModelError(
                f"joint '{self.joint_names[int(np.argmin(moves))]}' does not move '{end_effector}'",
                remedy="List the joints between the base and the end effector.",
            )

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)

    @property
    def middle(self) -> Array:
        """(n,) rad or m, the middles of the joints' ranges; 0 of joints without limits."""
        return middles(self.lower, self.upper)

    @property
    def units(self) -> tuple[str, ...]:
        """The unit of each joint's position, "rad" or "m"."""
        return tuple("rad" if joint.type_name() == "revolute" else "m" for joint in self.joints)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What is taken for what the model does not state, a line each; none if it states all."""
        units = dict(zip(self.joint_names, self.units, strict=True))
        return assumed_in_words(self.assumed_velocities, units)

    def full_positions(self, q: ArrayLike) -> Array:
        """Positions of the whole plant; q (..., n) rad or m to (..., plant.num_positions())."""
        q = np.asarray(q, dtype=float)
        full = np.tile(self._q0, (*q.shape[:-1], 1))
        full[..., self._columns] = q
        return full

    def pose(self, q: ArrayLike) -> Array:
        """Forward kinematics; q (..., n) rad or m to X_WE (..., 4, 4)."""
        q = np.asarray(q, dtype=float)
        X_WE = np.empty((*q.shape[:-1], 4, 4))
        for index in np.ndindex(q.shape[:-1]):
            self._set(q[index])
            X_WE[index] = self._E.CalcPoseInWorld(self._context).GetAsMatrix4()
        return X_WE

    def jacobian(self, q: ArrayLike) -> Array:
        """``V_WE = jacobian(q) @ qdot``, E's spatial velocity in W [w; v]; (n,) to (6, n)."""
        self._set(np.asarray(q, dtype=float))
        return self._jacobian()

    def pose_and_jacobian(self, q: ArrayLike) -> tuple[Array, Array]:
        """`pose` and `jacobian` of one configuration (n,): X_WE (4, 4) and J_WE (6, n)."""
        self._set(np.asarray(q, dtype=float))
        return self._E.CalcPoseInWorld(self._context).GetAsMatrix4(), self._jacobian()

    def held(self, frame: str) -> Array:
        """X_EF (4, 4) of a frame that is fixed to the end effector.

        Raises:
            ModelError: there is no such frame, or it moves against the end effector.
        """
        F = find_frame(self.plant, frame, self._robot)
        if F.body() not in self.plant.GetBodiesWeldedTo(self._E.body()):
            raise ModelError(
                f"frame '{frame}' is not fixed to the end effector '{self.end_effector}'",
                remedy="Name a frame of the link that carries the end effector.",
            )
        self._set(np.zeros(self.n))
        return np.asarray(F.CalcPose(self._context, self._E).GetAsMatrix4())

    def margin(self, q: ArrayLike) -> Array:
        """Distance to the nearer limit, negative outside; (..., n) to (..., n), rad or m.

        Infinite for joints without limits.
        """
        q = np.asarray(q, dtype=float)
        return np.minimum(q - self.lower, self.upper - q)

    def margin_parts(self, q: ArrayLike) -> Array:
        """(n,) how near each joint comes to a limit along q (m, n), in parts of its range.

        It is 0 at the limit, 0.5 at most, and 0.5 of a joint without limits.
        """
        part, some = np.full(self.n, 0.5), ~self.endless
        ranges = self.upper[some] - self.lower[some]
        part[some] = self.margin(q).min(axis=0)[some] / ranges
        return part

    @property
    def slides(self) -> Array:
        """(n,) whether each joint is prismatic."""
        return np.array([unit == "m" for unit in self.units])

    def tightest(self, q: ArrayLike) -> int:
        """The joint that comes nearest to a limit at any of the configurations (..., n).

        Prismatic joints compare by the part of their range, which counts as half a turn.
        """
        least = self.margin(q).reshape(-1, self.n).min(axis=0)
        return int(np.argmin(comparable(least, self.upper - self.lower, self.slides)))

    @cached_property
    def wrist(self) -> Wrist | None:
        """Shoulder, wrist and reach, where the arm has them; see `wrist_of`."""
        return wrist_of(self.screw_chain())

    def screw_chain(self) -> ScrewChain:
        """The arm as a product of exponentials, read off the plant at q = 0."""
        X_WE, J_WE = self.pose_and_jacobian(np.zeros(self.n))
        screws = shift(J_WE.T, -X_WE[:3, 3])
        return ScrewChain(self.joint_names, screws, X_WE, self.lower.copy(), self.upper.copy())

    def _set(self, q: Array) -> None:
        if q.shape != (self.n,):
            raise ValueError(f"q has shape {q.shape}, expected ({self.n},)")
        full = self._q0.copy()
        full[self._columns] = q
        self.plant.SetPositions(self._context, full)

    def _jacobian(self) -> Array:
        J = self.plant.CalcJacobianSpatialVelocity(
            self._context, JacobianWrtVariable.kQDot, self._E, np.zeros(3), self._W, self._W
        )
        return J[:, self._columns]


def comparable(margin: Array, extent: Array, slides: Array) -> Array:
    """Distances from limits (..., n) in rad, for comparing: of slides, in parts of their range.

    Args:
        margin: rad, or m of slides.
        extent: (n,) of the joints' ranges, which may be infinite.
        slides: (n,) which joints are prismatic; their whole range counts as half a turn.
    """
    weight = np.where(slides & np.isfinite(extent), np.pi / extent, 1.0)
    return np.asarray(margin * weight)


def _with(q: Array, index: int, value: float) -> Array:
    q = q.copy()
    q[index] = value
    return q
