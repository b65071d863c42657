"""The arm as a person leads it on the teaching page, and what is recorded of its motion."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.acquisition.guided_arm import GuidedArm
from drake_screw.robot import Arm
from drake_screw.screws import (
    exp,
    log,
    pose,
    quaternion_from_rotation,
    rotation_angle,
    rotation_from_quaternion,
    translation_distance,
)
from drake_screw.tasks import WorkArea
from drake_screw.typing import Array

PERIOD = 0.02
"""s. Between steps of the arm, and between samples of a recording."""
TAKEN_BACK = 2.0
"""s. So much of a recording is taken back at a time."""
REACH = 0.6
"""m. How far the end effector's position may at least be wanted from where it starts."""
AROUND = 0.2
"""m. How far beyond the work area it may be wanted."""
PATIENCE = 0.5
"""s. An arm that has hardly moved for so long, and is not where it is wanted, is held back."""
CREEP = 5e-3, 0.02
"""m and rad. By less in that time the end effector hardly moves."""


class LedArm:
    """Where an arm is wanted, how far it has got, and what of that is recorded.

    The end effector is wanted at a pose, or the joints at a configuration. Where the arm is held
    back, by a limit or because it is stretched out, it is wanted where it has got to.

    Args:
        arm: to lead.
        start: (n,) rad or m, where it starts.
        area: where the objects may be; the end effector may be wanted anywhere around it.

    Attributes:
        arm: the arm.
        wanted: (6,) p_WE in m, and the rotation vector in rad from the start's E, in that frame.
        low, high: (6,) least and greatest of these; whole millimetres and degrees.
        held_back: whether it could not get where it was wanted last.
    """

    def __init__(self, arm: Arm, start: Array, area: WorkArea) -> None:
        self.arm = arm
        self._guided = GuidedArm(arm, start, PERIOD)
        self._X_WE_start = arm.pose(start)
        self.wanted = self._parts(self._X_WE_start)
        self.low, self.high = _range(self._X_WE_start[:3, 3], area)
        self.held_back = False
        self._q_wanted: Array | None = None
        self._samples: list[Array] | None = None
        self._paused = False
        self._X_WE_before, self._steps = self._X_WE_start, 0

    @property
    def q(self) -> Array:
        """(n,) rad or m, where the arm is."""
        return self._guided.q

    @property
    def X_WE(self) -> Array:
        """(4, 4) where the end effector is."""
        return self.arm.pose(self.q)

    @property
    def X_WE_wanted(self) -> Array:
        """(4, 4) where it is wanted."""
        turned = exp(np.concatenate([self.wanted[3:], np.zeros(3)]))[:3, :3]
        return pose(self._X_WE_start[:3, :3] @ turned, self.wanted[:3])

    @property
    def recording(self) -> bool:
        """Whether the arm's motion is being recorded."""
        return self._samples is not None

    @property
    def recorded(self) -> float:
        """s, how much has been recorded."""
        return max(len(self._samples or ()) - 1, 0) * PERIOD

    def want_part(self, part: int, value: float) -> None:
        """Want one of `wanted`, within its range."""
        self.wanted[part] = value
        self._want()

    def want_pose(self, p_WE: ArrayLike, quaternion: ArrayLike) -> None:
        """Want the end effector at p_WE (3,) m, turned by a quaternion (4,), w first, not zero."""
        q = np.asarray(quaternion, dtype=float)
        self.wanted = self._parts(pose(rotation_from_quaternion(q / np.linalg.norm(q)), p_WE))
        self._want()

    def jog(self, way: int, step: float) -> None:
        """Want it a step on: by so many m along x, y or z of the world, or rad about its own."""
        X = self.X_WE_wanted
        if way < 3:
            X[way, 3] += step
        else:
            X[:3, :3] = X[:3, :3] @ exp(step * np.eye(6)[way - 3])[:3, :3]
        self.want_pose(X[:3, 3], quaternion_from_rotation(X[:3, :3]))

    def want_joint(self, joint: int, value: float) -> None:
        """Want a joint at so many rad or m, and the others where they are."""
        wanted = self.q.copy() if self._q_wanted is None else self._q_wanted
        wanted[joint] = value
        self._q_wanted, self.held_back = wanted, False

    def step(self) -> bool:
        """One period of the arm's motion; returns whether it moved."""
        if self._q_wanted is not None:
            moved = self._guided.guide_joints(self._q_wanted)
            self.wanted = self._parts(self.X_WE)
        else:
            moved = self._guided.guide_end_effector(self.X_WE_wanted)
            self._give_way()
        self._paused &= not moved
        if self._samples is not None and not self._paused:
            self._samples.append(self.q.copy())
        return moved

    def record(self) -> None:
        """Begin to record from here."""
        self._samples, self._paused = [self.q.copy()], False

    def stop(self) -> Array:
        """End the recording; returns its joint positions (m, n), `PERIOD` apart."""
        samples, self._samples = np.array(self._samples), None
        return samples

    def take_back(self) -> None:
        """Take the last `TAKEN_BACK` seconds of the recording back, and the arm to where it was.

        The recording goes on as soon as the arm moves again.
        """
        assert self._samples is not None
        keep = max(1, len(self._samples) - round(TAKEN_BACK / PERIOD))
        self._samples = self._samples[:keep]
        self._guided.q = self._samples[-1].copy()
        self.wanted, self._q_wanted = self._parts(self.X_WE), None
        self.held_back, self._paused = False, True

    def _want(self) -> None:
        """Heed `wanted`, within its range."""
        self.wanted = np.clip(self.wanted, self.low, self.high)
        self._q_wanted, self.held_back = None, False

    def _give_way(self) -> None:
        """Want the end effector where it is, once it is held back."""
        self._steps += 1
        here, before, (moved, turned) = self.X_WE, self._X_WE_before, CREEP
        creeps = (
            translation_distance(here, before) < moved and rotation_angle(here, before) < turned
        )
        if not self._guided.stuck or not creeps:
            self._X_WE_before, self._steps = here, 0
        elif self._steps * PERIOD >= PATIENCE:
            self.wanted, self.held_back = self._parts(self.X_WE), True

    def _parts(self, X_WE: Array) -> Array:
        """`wanted` of a pose; the inverse of `X_WE_wanted`."""
        turned = pose(self._X_WE_start[:3, :3].T @ X_WE[:3, :3], np.zeros(3))
        return np.concatenate([X_WE[:3, 3], log(turned)[:3]])


def _range(p_WE: Array, area: WorkArea) -> tuple[Array, Array]:
    """(6,), (6,) the box around the start and the work area, and half a turn either way."""
    ends = np.array([area.lower, area.upper])
    chosen = np.array(list(product((0, 1), repeat=ends.shape[2])))
    corners = np.where(chosen[:, None, :] == 1, ends[1], ends[0])
    p_WO = area.X_WO(corners)[..., :3, 3].reshape(-1, 3)
    low = np.minimum(p_WE - REACH, p_WO.min(axis=0) - AROUND)
    high = np.maximum(p_WE + REACH, p_WO.max(axis=0) + AROUND)
    half = np.full(3, np.pi)
    return (
        np.concatenate([np.floor(low * 1e3) / 1e3, -half]),
        np.concatenate([np.ceil(high * 1e3) / 1e3, half]),
    )
