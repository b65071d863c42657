"""What a recording holds, looked at before any run."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from drake_screw.demonstrations.demonstration import Demonstration, demonstration_of
from drake_screw.demonstrations.deviations import Deviations, runs_of
from drake_screw.demonstrations.faithful import FaithfulConfig
from drake_screw.demonstrations.recording import Recording
from drake_screw.demonstrations.refusal import NoMotionKept
from drake_screw.demonstrations.shown import Shown
from drake_screw.screws import Screw, screw_between, translation_distance
from drake_screw.typing import Array

if TYPE_CHECKING:
    from drake_screw.robot.arm import Arm


@dataclass(frozen=True, eq=False)
class ScrewSegment:
    """A constant screw between two guiding poses of one object that follow on each other.

    Attributes:
        object: index of that object.
        start, end: s, when the guiding poses were recorded.
        X_WA, X_WB: (4, 4) the guiding poses.
    """

    object: int
    start: float
    end: float
    X_WA: Array
    X_WB: Array

    @cached_property
    def screw(self) -> Screw:
        """Axis, angle and translation, in W; of shape ()."""
        return screw_between(self.X_WA, self.X_WB)


@dataclass(frozen=True)
class Stretch:
    """A part of a recording's time, from `start` to `end` in s, and why it is not kept."""

    start: float
    end: float
    why: str


@dataclass(frozen=True, eq=False)
class Look:
    """A recording, and what becomes of it.

    Attributes:
        shown: the recording, its names of objects, and where the end effector is near which.
        X_WE: (m, 4, 4) the end effector's path, and
        X_WO: (k, 4, 4) the objects, for the arm that is planned for.
        lower, upper: (n,) rad or m, joint limits of the arm that was led.
        units: n units of its joints, "rad" or "m"; none where the hand alone was recorded.
        demonstration: what is learned from it; None if it is refused.
        refused: why it is; None if it is not.
    """

    shown: Shown
    X_WE: Array
    X_WO: Array
    lower: Array
    upper: Array
    units: tuple[str, ...]
    demonstration: Demonstration | None
    refused: NoMotionKept | None = None

    def __str__(self) -> str:
        if self.demonstration is None:
            assert self.refused is not None
            return f"{self.name}: not used: {self.refused.message}"
        words = (*self.demonstration.fidelity, *self.demonstration.notes)
        return f"{self.name}: {'; '.join(map(str, words))}"

    @property
    def recording(self) -> Recording:
        """The recording itself."""
        return self.shown.recording

    @property
    def name(self) -> str:
        """The recording's."""
        return self.recording.name

    @property
    def t(self) -> Array:
        """(m,) s, from 0."""
        return self.recording.t

    @property
    def q(self) -> Array:
        """(m, n) rad or m."""
        return self.recording.q

    @cached_property
    def distance(self) -> Array:
        """(m, k) m, of the end effector from each object."""
        return translation_distance(self.X_WE[:, None], self.X_WO[None])

    @cached_property
    def margin(self) -> Array:
        """(m, n) rad or m, of each joint from its nearer limit."""
        return np.minimum(self.q - self.lower, self.upper - self.q)

    @property
    def radius(self) -> Array:
        """(k,) m, within which of each object its region of interest lies."""
        return self.shown.measure.region_of_interest * self.shown.regions.smallest

    @property
    def tolerances(self) -> tuple[float, float]:
        """Largest deviation from the screws that the segmentation allows; m and rad.

        The published method bounds the chordal distance of unit quaternions, 2 sin(angle / 4).
        """
        config = self.shown.config
        if isinstance(config, FaithfulConfig):
            return config.position_tolerance, config.rotation_tolerance
        angle = 4.0 * np.arcsin(min(config.rotation_tolerance / 2.0, 1.0))
        return config.position_tolerance, float(angle)

    @property
    def deviations(self) -> tuple[Deviations, ...]:
        """Of the samples kept from the screws, for each object; empty if it is refused."""
        return () if self.demonstration is None else self.demonstration.deviations

    @cached_property
    def guides(self) -> Array:
        """(g, 4, 4) X_WE, the guiding poses."""
        found = self.demonstration
        return np.zeros((0, 4, 4)) if found is None else found.transfer(self.X_WO)

    @cached_property
    def screws(self) -> tuple[ScrewSegment, ...]:
        """In the order of time. Between guiding poses of two objects there is none."""
        found = self.demonstration
        if found is None:
            return ()
        order = np.arange(len(found.objects))
        pairs = [
            (index, a, b)
            for index in np.unique(found.objects)
            for run in runs_of(order, found.objects, index)
            for a, b in pairwise(run)
        ]
        time = self.t[found.kept]
        return tuple(
            ScrewSegment(int(index), float(time[a]), float(time[b]), self.guides[a], self.guides[b])
            for index, a, b in sorted(pairs, key=lambda pair: int(pair[1]))
        )

    @cached_property
    def dropped(self) -> tuple[Stretch, ...]:
        """What lies between no two guiding poses, stretch by stretch, in the order of time."""
        why = np.full(len(self.t), "outside the region of interest", dtype=object)
        for visit in self.shown.regions.visits:
            why[visit.start : visit.stop - 1] = self._in_a_region(visit.object)
        for visit in self.shown.regions.left_out:
            name = self.shown.names[visit.object]
            why[visit.start : visit.stop - 1] = f"another visit to the {name}"
        for a, b in self._between_guides():
            why[a:b] = ""
        breaks = np.flatnonzero(why[1:-1] != why[:-2]) + 1
        bounds = pairwise([0, *breaks.tolist(), len(why) - 1])
        return tuple(
            Stretch(float(self.t[a]), float(self.t[b]), why[a]) for a, b in bounds if why[a]
        )

    def _between_guides(self) -> list[tuple[int, int]]:
        found = self.demonstration
        if found is None:
            return []
        return [
            (int(run[0]), int(run[-1]))
            for index in np.unique(found.objects)
            for run in runs_of(found.kept, found.objects, index)
        ]

    def _in_a_region(self, index: int) -> str:
        near = f"near the {self.shown.names[index]}"
        if self.demonstration is None:
            return f"{near}, where no motion is kept"
        return f"{near}, but before the first or after the last guiding pose"


def look_at(shown: Shown, arm: Arm) -> Look:
    """What a recording of an arm holds, and what becomes of it; see `shown.what_is_shown`."""
    found: Demonstration | None = None
    refused: NoMotionKept | None = None
    joints = shown.recording.X_WE is None
    try:
        found = demonstration_of(shown)
    except NoMotionKept as error:
        refused = error
    return Look(
        shown,
        shown.X_WE,
        shown.recording.X_WO,
        arm.lower if joints else arm.lower[:0],
        arm.upper if joints else arm.upper[:0],
        arm.units if joints else (),
        found,
        refused,
    )
