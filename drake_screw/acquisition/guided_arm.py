"""An arm that is guided by hand: it follows at bounded speed, and stays within its limits."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from pydrake.multibody.inverse_kinematics import (
    DifferentialInverseKinematicsParameters,
    DoDifferentialInverseKinematics,
)

from drake_screw.robot import Arm
from drake_screw.screws import inverse, log, shift
from drake_screw.typing import Array

LIMIT_MARGIN = 2e-3
"""rad or m. The arm is guided no nearer to a joint limit than this."""
LINEAR_SPEED, ANGULAR_SPEED = 0.25, 1.2
"""m/s and rad/s, the end effector's speed on the way to where it is guided."""
SPEED_FRACTION = 0.5
"""Of the joints' velocity limits."""
FREEING = 0.5
"""1/s. How fast the joints of an arm that is stuck at full speed go to their middles."""
FREELY = 0.1
"""How much that counts, beside the end effector's velocity."""


class GuidedArm:
    """An arm that follows where it is guided, and stays within its limits.

    Differential inverse kinematics by Drake's quadratic program: the end effector's velocity as
    asked, as far as joint limits and joint speeds let it. Where these let it go nowhere, the arm
    being stretched out say, a velocity that is as near as can be, by bounded least squares, with
    joints drawn to the middles of their ranges, so that it comes free again.

    Args:
        arm: to guide.
        q: (n,) rad or m, where it starts, strictly inside its limits.
        period: s, between steps.

    Attributes:
        q: (n,) rad or m, where it is.
        stuck: whether the last step could not go where it was guided, for a limit or a singularity.
    """

    def __init__(self, arm: Arm, q: ArrayLike, period: float) -> None:
        self.arm = arm
        self.q = np.array(q, dtype=float)
        self.period = period
        self.stuck = False
        self._speed = speed = arm.velocity_limits * SPEED_FRACTION
        parameters = DifferentialInverseKinematicsParameters(arm.n, arm.n)
        parameters.set_time_step(period)
        lower = np.minimum(arm.lower + LIMIT_MARGIN, self.q)
        upper = np.maximum(arm.upper - LIMIT_MARGIN, self.q)
        self._lower, self._upper = lower, upper
        parameters.set_joint_position_limits((lower, upper))
        parameters.set_joint_velocity_limits((-speed, speed))
        self._parameters = parameters

    def guide_end_effector(self, X_WE: ArrayLike) -> bool:
        """One step of the end effector towards a pose (4, 4); returns whether the arm moved."""
        X_WE_now, J_WE = self.arm.pose_and_jacobian(self.q)
        V = log(np.asarray(X_WE, dtype=float) @ inverse(X_WE_now))
        V_WE = shift(V, X_WE_now[:3, 3])
        turn, travel = np.linalg.norm(V_WE[:3]), np.linalg.norm(V_WE[3:])
        size = max(turn / ANGULAR_SPEED, travel / LINEAR_SPEED)
        if size < 1e-4:
            self.stuck = False
            return False
        V_WE /= max(size, self.period)
        result = DoDifferentialInverseKinematics(
            self.q, np.zeros(self.arm.n), V_WE, J_WE, self._parameters
        )
        v = result.joint_velocities
        self.stuck = v is None or np.linalg.norm(J_WE @ v - V_WE) > 0.5 * np.linalg.norm(V_WE)
        if self.stuck:
            v = self._nearest_velocities(V_WE, J_WE)
        return self._move(np.asarray(v) * self.period)

    def guide_joints(self, q: ArrayLike) -> bool:
        """One step of all joints towards a configuration (n,); returns whether the arm moved."""
        most = self._speed * self.period
        self.stuck = False
        return self._move(np.clip(np.asarray(q, dtype=float) - self.q, -most, most))

    def _nearest_velocities(self, V_WE: Array, J_WE: Array) -> Array:
        """Joint velocities (n,) that come near V_WE (6,) in any direction, and near the middles."""
        from scipy.optimize import lsq_linear  # takes long to import

        low = np.maximum(-self._speed, (self._lower - self.q) / self.period)
        high = np.minimum(self._speed, (self._upper - self.q) / self.period)
        share = max(
            np.linalg.norm(V_WE[:3]) / ANGULAR_SPEED, np.linalg.norm(V_WE[3:]) / LINEAR_SPEED
        )
        to_middle = FREEING * share * (self.arm.middle - self.q)
        A = np.vstack([J_WE, FREELY * np.eye(self.arm.n)])
        b = np.concatenate([V_WE, FREELY * to_middle])
        return np.asarray(lsq_linear(A, b, bounds=(low, high)).x)

    def _move(self, step: Array) -> bool:
        moved = np.clip(self.q + step, self._lower, self._upper)
        change = float(np.abs(moved - self.q).max())
        self.q = moved
        return change > 1e-7
