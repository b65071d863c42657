"""What planning answers: success, or where and why it failed. Failing is a value, not an error."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drake_screw.typing import Array


class Cause(IntEnum):
    """Why a plan ended; EXECUTION, that it was simulated and did not go as it should."""

    SUCCESS = 0
    JOINT_LIMIT = 1
    UNREACHABLE = 2
    COLLISION = 3
    NOT_TRIED = 4
    EXECUTION = 5


@dataclass(frozen=True)
class Outcomes:
    """Outcomes of plans, arrays of one shape: (N, D) for N instances and D demonstrations, say.

    Attributes:
        cause: `Cause` values, uint8.
        segment: the screw segment that failed, from 0; -1 for a success.
        joint: the joint at its limit, from 0; -1 otherwise.
        fraction: how much of the failing segment was done, 0 to 1; 1 for a success.
        variant: which variant of the demonstration it is of, in the order in which they are tried,
            from 0: turns of symmetric bodies (see `Symmetries`), and where the approach is free
            all of them again from other configurations (see `BatchPlanner`). Of a failure it is the
            one that came furthest.
        pair: which pair of bodies touches, an index of `Workcell.pairs`; -1 where none does, or
            where it is not known.
        arm: which arm it is of, in the order in which they are tried, from 0. Of a failure it is
            the one that came furthest; joints are counted along it.
    """

    cause: NDArray[np.uint8]
    segment: NDArray[np.int16]
    joint: NDArray[np.int8]
    fraction: NDArray[np.float32]
    variant: NDArray[np.int16]
    pair: NDArray[np.int16] = field(default=None)  # type: ignore[arg-type]
    arm: NDArray[np.int8] = field(default=None)  # type: ignore[arg-type]

    def __post_init__(self) -> None:
        """Without pairs, none is known; without arms, all are of the first."""
        if self.pair is None:
            object.__setattr__(self, "pair", np.full(self.cause.shape, -1, dtype=np.int16))
        if self.arm is None:
            object.__setattr__(self, "arm", np.zeros(self.cause.shape, dtype=np.int8))

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the arrays."""
        return self.cause.shape

    @property
    def success(self) -> NDArray[np.bool_]:
        """Which plans succeeded."""
        return np.asarray(self.cause == np.uint8(Cause.SUCCESS))

    @property
    def any_success(self) -> NDArray[np.bool_]:
        """(N,) of outcomes (N, D): which instances some demonstration solves."""
        return np.asarray(self.success.any(axis=-1))

    @property
    def best_attempt(self) -> NDArray[np.int64]:
        """(N,) of outcomes (N, D): the demonstration that came furthest; -1 if none was tried.

        That is one that succeeds; else one that was executed; else the one that failed in the
        latest segment, and of several the one that did most of it. The first in order wins a tie.
        """
        progress = self.segment + 0.5 * self.fraction.astype(float)
        latest = float(np.iinfo(self.segment.dtype).max)
        progress = np.where(self.cause == Cause.EXECUTION, progress + latest, progress)
        progress = np.where(self.success, np.inf, progress)
        progress = np.where(self.cause == Cause.NOT_TRIED, -np.inf, progress)
        if self.shape[-1] == 0:
            return np.full(self.shape[:-1], -1)
        return np.where(np.isneginf(progress.max(axis=-1)), -1, progress.argmax(axis=-1))

    @property
    def best(self) -> Outcomes:
        """(N,) of outcomes (N, D): what became of `best_attempt`; NOT_TRIED if there was none."""
        best, none = self.best_attempt, one_outcome(Cause.NOT_TRIED, fraction=0.0)
        if self.shape[-1] == 0:
            return none._each(lambda value: np.full(self.shape[:-1], value))
        return self.take(np.maximum(best, 0)).replaced(best < 0, none)

    def take(self, index: NDArray[np.int64]) -> Outcomes:
        """(...) of outcomes (..., D): those of an index (...) in the last axis."""
        at = index[..., None]
        return self._each(lambda values: np.take_along_axis(values, at, axis=-1)[..., 0])

    def reshape(self, shape: tuple[int, ...]) -> Outcomes:
        """The same outcomes in arrays of another shape."""
        return self._each(lambda values: values.reshape(shape))

    def _each(self, change: Callable[[NDArray[Any]], NDArray[Any]]) -> Outcomes:
        return Outcomes(
            change(self.cause),
            change(self.segment),
            change(self.joint),
            change(self.fraction),
            change(self.variant),
            change(self.pair),
            change(self.arm),
        )

    def of_arm(self, arm: int) -> Outcomes:
        """The same outcomes, of the arm with that number."""
        return replace(self, arm=np.full(self.shape, arm, dtype=np.int8))

    @property
    def furthest_segment(self) -> NDArray[np.int64]:
        """(N,) of outcomes (N, D): the segment in which the best attempt failed, from 0.

        For an instance that succeeds it is the largest int16, later than any failure; -1 if
        nothing was tried.
        """
        best = self.best
        return np.where(best.success, np.iinfo(np.int16).max, best.segment.astype(np.int64))

    def replaced(self, where: Any, values: Outcomes) -> Outcomes:
        """A copy that has other outcomes at an index."""
        changed = self._each(np.copy)
        changed.cause[where] = values.cause
        changed.segment[where] = values.segment
        changed.joint[where] = values.joint
        changed.fraction[where] = values.fraction
        changed.variant[where] = values.variant
        changed.pair[where] = values.pair
        changed.arm[where] = values.arm
        return changed

    def __getitem__(self, index: Any) -> Outcomes:
        return self._each(lambda values: values[index])

    def codes(self) -> NDArray[np.str_]:
        """Short text of each outcome, as the paper's authors write it, counted from 1.

        ``0:0`` success; ``s:j`` failed in the s-th segment at joint j's limit; ``s:n`` unreachable;
        ``s:c`` collision; ``s:x`` in its execution; ``-`` not tried.
        """
        segment = (self.segment.astype(int) + 1).astype(str)
        joint = (self.joint.astype(int) + 1).astype(str)
        letters = {Cause.UNREACHABLE: "n", Cause.COLLISION: "c", Cause.EXECUTION: "x"}
        why = np.select([self.cause == cause for cause in letters], list(letters.values()), joint)
        text = np.char.add(np.char.add(segment, ":"), why)
        text = np.where(self.success, "0:0", text)
        return np.where(self.cause == Cause.NOT_TRIED, "-", text)


def concatenate(parts: Iterable[Outcomes], axis: int = 0) -> Outcomes:
    """Join outcomes along an axis."""
    parts = list(parts)
    return Outcomes(
        np.concatenate([p.cause for p in parts], axis=axis),
        np.concatenate([p.segment for p in parts], axis=axis),
        np.concatenate([p.joint for p in parts], axis=axis),
        np.concatenate([p.fraction for p in parts], axis=axis),
        np.concatenate([p.variant for p in parts], axis=axis),
        np.concatenate([p.pair for p in parts], axis=axis),
        np.concatenate([p.arm for p in parts], axis=axis),
    )


def one_outcome(
    cause: Cause, segment: int = -1, joint: int = -1, fraction: float = 1.0, variant: int = 0
) -> Outcomes:
    """A single outcome, arrays of shape ()."""
    return Outcomes(
        np.array(cause, dtype=np.uint8),
        np.array(segment, dtype=np.int16),
        np.array(joint, dtype=np.int8),
        np.array(fraction, dtype=np.float32),
        np.array(variant, dtype=np.int16),
    )


@dataclass(frozen=True)
class Plan:
    """A joint path through the screw segments of one transferred demonstration.

    Attributes:
        q: (m, n) rad or m, from the start configuration to where the plan ended.
        segment: (m,) the segment each point lies in, from 0.
        s: (m,) how far along that segment, 0 to 1.
        outcome: of shape ().
        guides: (g, 4, 4) X_WE where its segments end: the guiding poses, transferred and turned.
        angles: (k + 1,) rad, by which each of k symmetric objects, and last the tool, is turned
            about its axis; () where nothing is known of turns.
        approach: whether the first segment is any joint motion to the first guiding pose instead of
            a screw.
        free_axis: (3,) in the end effector's frame, about which its roll is free: at guiding poses
            it may be turned about that axis by any angle. None where its whole pose is followed.
    """

    q: Array
    segment: NDArray[np.int64]
    s: Array
    outcome: Outcomes
    guides: Array
    angles: Array = field(default_factory=lambda: np.zeros(0))
    approach: bool = False
    free_axis: Array | None = None

    @property
    def success(self) -> bool:
        """Whether all guiding poses were reached within the limits."""
        return bool(self.outcome.success)
