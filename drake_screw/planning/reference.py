"""The reference planner: ScLERP and the Jacobian pseudoinverse on the plant, step by step.

It defines the question that the batch planner answers quickly. Along one constant-screw segment
the end effector's spatial twist is constant, so the joint path solves dq/ds = J(q)^+ V for s in
[0, 1] (Mahalingam and Chakraborty, ICRA 2023). It is followed here by the classical Runge-Kutta
method in small steps, each aimed at the guiding pose again so that the path ends on it. The
contract in words is docs/numerical_contract.md.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.planning.contract import (
    ORIENTATION_MIN,
    POSITION_TOLERANCE,
    RATE_LIMIT,
    RESIDUAL_LIMIT,
    ROTATION_TOLERANCE,
    STILL,
    Redundancy,
    away_from_limits,
    motion_size,
)
from drake_screw.planning.outcomes import Cause, Outcomes, Plan, one_outcome
from drake_screw.planning.roll import along_roll_free, free_frame, rolled, turned_apart
from drake_screw.robot.arm import Arm
from drake_screw.screws import exp, inverse, log, shift, translation_distance
from drake_screw.typing import Array

CORRECTIONS = 4


class ReferencePlanner:
    """Plans one instance at a time on the MultibodyPlant.

    Args:
        arm: to plan for.
        step: end-effector motion in one step, rad and (divided by CHARACTERISTIC_LENGTH) m
            together.
        joint_step: rad (or m), joint motion in one step, so that steps shrink near
            singularities; at least half of `step`.
        redundancy: what more joints than six do with the motion that the end effector leaves free.
        free_axis: (3,) in the end effector's frame, about which its roll is free; None where its
            whole pose is followed.
    """

    def __init__(
        self,
        arm: Arm,
        *,
        step: float = 0.01,
        joint_step: float = 0.005,
        redundancy: Redundancy = "least_norm",
        free_axis: ArrayLike | None = None,
    ) -> None:
        self.arm = arm
        self.free_axis = None if free_axis is None else np.asarray(free_axis, dtype=float)
        self._X_EF = np.eye(4) if free_axis is None else free_frame(free_axis)
        self._directions = 6 if free_axis is None else 5
        self.redundancy = redundancy
        self.step = step
        self.joint_step = max(joint_step, step / 2.0)

    def plan(self, q_start: ArrayLike, guides: ArrayLike) -> Plan:
        """Follow constant screws from the start configuration through all guiding poses.

        Args:
            q_start: (n,) rad or m.
            guides: (g, 4, 4) guiding poses X_WE.

        Returns:
            The plan, up to where it failed if it did. A start that is not strictly inside the
            limits fails at once.

        Raises:
            ValueError: a number is not finite.
        """
        if not (np.isfinite(q_start).all() and np.isfinite(guides).all()):
            raise ValueError("the start and the guiding poses must be finite numbers")
        guides = np.asarray(guides, dtype=float)
        path, segments, fractions = [np.array(q_start, dtype=float)], [0], [0.0]
        outcome = one_outcome(Cause.SUCCESS)
        margin = self.arm.margin(path[0])
        if (margin <= 0.0).any():
            outcome = one_outcome(Cause.JOINT_LIMIT, 0, int(np.argmin(margin)), 0.0)
            return self._plan(path, segments, fractions, outcome, guides)
        begins = [self.arm.pose(path[0]), *guides]
        for segment, (X_WA, X_WG) in enumerate(zip(begins, guides, strict=False)):
            points, s, cause, joint = self._follow(path[-1], X_WA, X_WG)
            path += points
            segments += [segment] * len(points)
            fractions += s
            if cause != Cause.SUCCESS:
                outcome = one_outcome(cause, segment, joint, s[-1] if s else 0.0)
                break
        return self._plan(path, segments, fractions, outcome, guides)

    def _plan(
        self,
        path: list[Array],
        segments: list[int],
        fractions: list[float],
        outcome: Outcomes,
        guides: Array,
    ) -> Plan:
        """A plan of its points."""
        where = np.array(path), np.array(segments), np.array(fractions)
        return Plan(*where, outcome, guides, free_axis=self.free_axis)

    def _follow(
        self, q: Array, X_WA: Array, X_WG: Array
    ) -> tuple[list[Array], list[float], Cause, int]:
        """One segment from A to G: its path after q, how far along each is, cause and joint."""
        points: list[Array] = []
        fractions: list[float] = []
        size, s = self._twist(q, self._target(q, X_WA, X_WG, 0.0))[1], 0.0
        while s < 1.0:
            V = self._twist(q, self._target(q, X_WA, X_WG, s))[0] / (1.0 - s)
            velocities, residual = self._velocities_and_residual(q, V)
            rate = float(np.linalg.norm(velocities))
            if rate > RATE_LIMIT * size or residual * (1.0 - s) > RESIDUAL_LIMIT * size:
                return points, fractions, Cause.UNREACHABLE, -1
            h = min(self.step / max(size, 1e-12), self.joint_step / max(rate, 1e-12), 1.0 - s)
            moved = self._runge_kutta(q, h * V)
            if self._passes_singularity(q, moved):
                return points, fractions, Cause.UNREACHABLE, -1
            margin, before = self.arm.margin(moved), self.arm.margin(q)
            if (margin <= 0.0).any():
                crossing, over = np.full_like(margin, np.inf), margin <= 0.0
                crossing[over] = before[over] / (before[over] - margin[over])
                joint, part = int(np.argmin(crossing)), float(crossing.min())
                points.append(q + part * (moved - q))
                fractions.append(s + part * h)
                return points, fractions, Cause.JOINT_LIMIT, joint
            q, s = moved, s + h
            if 1.0 - s < 1e-9:
                q, s = self._corrected(q, X_WG), 1.0
            points.append(q)
            fractions.append(s)
        if (self.arm.margin(q) <= 0.0).any():
            return points, fractions, Cause.JOINT_LIMIT, int(np.argmin(self.arm.margin(q)))
        arrived = self._near(q, X_WG, 1.0)
        return points, fractions, Cause.SUCCESS if arrived else Cause.UNREACHABLE, -1

    def _corrected(self, q: Array, X_WG: Array) -> Array:
        """Newton's method onto the guiding pose, well within the tolerances."""
        for _ in range(CORRECTIONS):
            if self._near(q, X_WG, 0.1):
                break
            X_WT = self._target(q, X_WG, X_WG, 1.0)
            q = q + self._joint_velocities(q, self._twist(q, X_WT)[0])
        return q

    def _near(self, q: Array, X_WG: Array, part: float) -> bool:
        """Whether the guiding pose is met within a part of the contract's tolerances."""
        X_WE = self.arm.pose(q)
        return bool(
            translation_distance(X_WE, X_WG) <= part * POSITION_TOLERANCE
            and turned_apart(X_WE, X_WG, self.free_axis) <= part * ROTATION_TOLERANCE
        )

    def _target(self, q: Array, X_WA: Array, X_WG: Array, s: float) -> Array:
        """The pose to aim at: G, rolled as far as the hand is rolled at s of the screw from A."""
        if self.free_axis is None:
            return X_WG
        X_WS = exp(s * log(X_WG @ inverse(X_WA))) @ X_WA
        X_WF, X_EF = self.arm.pose(q) @ self._X_EF, self._X_EF
        return rolled(X_WF, X_WS @ X_EF, X_WG @ X_EF) @ inverse(X_EF)

    def _twist(self, q: Array, X_WG: Array) -> tuple[Array, float]:
        """The constant twist from here to the goal, and its size at the end effector."""
        X_WE = self.arm.pose(q)
        V = log(X_WG @ inverse(X_WE))
        size = self._size(self._along(X_WE), shift(V, X_WE[:3, 3]))
        return V, size if self.free_axis is None else float(np.hypot(size, STILL))

    def _along(self, X_WE: Array) -> Array:
        """(d, 6) the directions that are followed, of twists about E's origin: all six, or five."""
        return np.eye(6) if self.free_axis is None else along_roll_free(X_WE @ self._X_EF)

    def _size(self, P: Array, V_WE: Array) -> float:
        """The size of a twist about E's origin in directions P."""
        return float(motion_size(P.T @ (P @ V_WE)))

    def _joint_velocities(self, q: Array, V: Array) -> Array:
        """dq/ds of the twist V about W's origin: J^+ V, the minimum-norm joint velocities.

        With `away_from_limits` it is J^+ (V - J z) + z, where z is what `contract` says.
        """
        return self._velocities_and_residual(q, V)[0]

    def _velocities_and_residual(self, q: Array, V: Array) -> tuple[Array, float]:
        """`_joint_velocities`, and the size of the residual V - J dq/ds."""
        X_WE, J_WE = self.arm.pose_and_jacobian(q)
        V_WE, P = shift(V, X_WE[:3, 3]), self._along(X_WE)
        J = P @ J_WE
        velocities = np.linalg.lstsq(J, P @ V_WE, rcond=None)[0]
        if self.redundancy == "away_from_limits" and self.arm.n > self._directions:
            z = away_from_limits(velocities, q, self.arm.lower, self.arm.upper)
            velocities += z - np.linalg.lstsq(J, J @ z, rcond=None)[0]
        return velocities, self._size(P, V_WE - J_WE @ velocities)

    def _passes_singularity(self, q: Array, moved: Array) -> bool:
        """Whether J's columns change their orientation, for arms that cannot get around that.

        det(J(q)^T J(moved)) is the inner product of the volumes that the columns span (Cauchy and
        Binet).
        """
        if self.arm.n > self._directions:
            return False
        J, J_moved = (
            self._along(X_WE) @ J_WE for X_WE, J_WE in map(self.arm.pose_and_jacobian, (q, moved))
        )
        return bool(np.linalg.det(J.T @ J_moved) < -ORIENTATION_MIN)

    def _runge_kutta(self, q: Array, V: Array) -> Array:
        k1 = self._joint_velocities(q, V)
        k2 = self._joint_velocities(q + k1 / 2, V)
        k3 = self._joint_velocities(q + k2 / 2, V)
        k4 = self._joint_velocities(q + k3, V)
        return q + (k1 + 2 * k2 + 2 * k3 + k4) / 6
