"""A teacher who is a person at the screen: the arm as they lead it, and what is asked of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike
from pydrake.multibody.inverse_kinematics import (
    DifferentialInverseKinematicsParameters,
    DoDifferentialInverseKinematics,
)

from drake_screw.acquisition.events import Suggestion
from drake_screw.acquisition.teacher import Lesson
from drake_screw.demonstrations import Recording
from drake_screw.robot import Arm
from drake_screw.screws import inverse, log, shift
from drake_screw.typing import Array

KEEP_OFF = 2e-3
"""rad or m. The arm is led no nearer to a limit than this."""
SPEED, TURN = 0.25, 1.2
"""m/s and rad/s, the hand's speed on the way to where it is led."""
HASTE = 0.5
"""Of the joints' velocity limits."""


class Desk(Protocol):
    """Where a person is asked for a demonstration, and gives it."""

    def teach(self, suggestion: Suggestion, number: int) -> Recording | None:
        """The accepted recording of demonstration `number` (from 0); None if there will be none."""
        ...


@dataclass(frozen=True)
class InteractiveTeacher:
    """Asks a person.

    Attributes:
        desk: where they sit.
    """

    desk: Desk

    def demonstrate(
        self,
        suggestion: Suggestion,
        *,
        number: int,
        used: tuple[Recording, ...],
        rng: np.random.Generator,
    ) -> Lesson:
        """See `Teacher.demonstrate`; what a person does depends on them alone."""
        recording = self.desk.teach(suggestion, number)
        if recording is None:
            return Lesson(None, "the teacher has no demonstration for this place")
        away = np.linalg.norm(recording.X_WO[:, :2, 3] - suggestion.x_y_yaw[:, :2], axis=-1).sum()
        source = "dropped into the folder" if recording.source is not None else "led by hand"
        return Lesson(recording, f"{source}, {away * 100:.0f} cm from the suggestion")


class LedArm:
    """An arm that follows where it is led, and stays within its limits.

    Differential inverse kinematics by Drake's quadratic program: the hand's velocity as asked, as
    far as joint limits and joint speeds let it.

    Args:
        arm: to lead.
        q: (n,) rad or m, where it starts, strictly inside its limits.
        period: s, between steps.

    Attributes:
        q: (n,) rad or m, where it is.
        stuck: whether the last step could not go where it was led, for a limit or a singularity.
    """

    def __init__(self, arm: Arm, q: ArrayLike, period: float) -> None:
        self.arm = arm
        self.q = np.array(q, dtype=float)
        self.period = period
        self.stuck = False
        speed = np.where(np.isfinite(arm.velocity_limits), arm.velocity_limits, 2.0) * HASTE
        self._speed = speed
        parameters = DifferentialInverseKinematicsParameters(arm.n, arm.n)
        parameters.set_time_step(period)
        lower = np.minimum(arm.lower + KEEP_OFF, self.q)
        upper = np.maximum(arm.upper - KEEP_OFF, self.q)
        self._lower, self._upper = lower, upper
        parameters.set_joint_position_limits((lower, upper))
        parameters.set_joint_velocity_limits((-speed, speed))
        self._parameters = parameters

    def lead_hand(self, X_WE: ArrayLike) -> bool:
        """One step of the hand towards a pose (4, 4); returns whether the arm moved."""
        X_WE_now, J_WE = self.arm.pose_and_jacobian(self.q)
        V = log(np.asarray(X_WE, dtype=float) @ inverse(X_WE_now))
        V_WE = shift(V, X_WE_now[:3, 3])
        size = max(np.linalg.norm(V_WE[:3]) / TURN, np.linalg.norm(V_WE[3:]) / SPEED)
        if size < 1e-4:
            self.stuck = False
            return False
        V_WE /= max(size, self.period)
        result = DoDifferentialInverseKinematics(
            self.q, np.zeros(self.arm.n), V_WE, J_WE, self._parameters
        )
        rates = result.joint_velocities
        self.stuck = rates is None or np.linalg.norm(J_WE @ rates - V_WE) > 0.5 * np.linalg.norm(
            V_WE
        )
        return rates is not None and self._move(np.asarray(rates) * self.period)

    def lead_joints(self, q: ArrayLike) -> bool:
        """One step of all joints towards a configuration (n,); returns whether the arm moved."""
        most = self._speed * self.period
        self.stuck = False
        return self._move(np.clip(np.asarray(q, dtype=float) - self.q, -most, most))

    def _move(self, step: Array) -> bool:
        moved = np.clip(self.q + step, self._lower, self._upper)
        change = float(np.abs(moved - self.q).max())
        self.q = moved
        return change > 1e-7
