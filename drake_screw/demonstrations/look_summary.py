"""A look at a recording in numbers and words: plain data for programs, lines for people."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from drake_screw.demonstrations.fidelity import Fidelity
from drake_screw.demonstrations.look import Look, ScrewSegment, Stretch
from drake_screw.robot.arm import comparable


@dataclass(frozen=True)
class JointSummary:
    """A joint's limits, what of them was used, and where it came nearest to one.

    Attributes:
        name: of the joint.
        unit: "rad" or "m", of what follows.
        lower, upper: limits; infinite of a joint that has none.
        least, greatest: positions recorded.
        margin: least distance from a limit.
        at: s, when that was.
    """

    name: str
    unit: str
    lower: float
    upper: float
    least: float
    greatest: float
    margin: float
    at: float

    @property
    def limit(self) -> str:
        """The limit that it comes nearest to, "lower" or "upper"."""
        return "lower" if self.least - self.lower <= self.upper - self.greatest else "upper"

    def __str__(self) -> str:
        if not np.isfinite(self.margin):
            return "none has limits"
        return (
            f"{self.name} comes nearest to a limit, {self.margin:.3f} {self.unit} from its "
            f"{self.limit} one at {self.at:.2f} s"
        )


@dataclass(frozen=True)
class VisitSummary:
    """A stretch of time, in s, in an object's region of interest, and whether it counts."""

    start: float
    end: float
    counts: bool


@dataclass(frozen=True)
class ObjectSummary:
    """An object, and how near the end effector came.

    Attributes:
        name: of the object.
        task: whether it belongs to the task.
        distance: m, the end effector's smallest.
        at: s, when that was.
        radius: m, within which of it the region of interest lies.
        visits: of the end effector to that region; none to a bystander.
    """

    name: str
    task: bool
    distance: float
    at: float
    radius: float
    visits: tuple[VisitSummary, ...]

    def __str__(self) -> str:
        nearest = f"{self.distance:.3f} m from the end effector at the nearest, at {self.at:.2f} s"
        if not self.task:
            return f"{nearest}; a bystander"
        visits = " and ".join(f"{v.start:.2f} to {v.end:.2f} s" for v in self.visits if v.counts)
        region = f"region of interest within {self.radius:.3f} m"
        return f"{nearest}; {region}{': ' if visits else ', never entered'}{visits}"


@dataclass(frozen=True)
class ScrewSummary:
    """A constant screw between two guiding poses of an object.

    Attributes:
        object: its name.
        start, end: s.
        angle: rad, about the axis.
        translation: m, along it.
        pitch: m/rad, infinite for a pure translation.
        axis: unit direction, in W.
        point: m, the point of the axis nearest to W's origin.
    """

    object: str
    start: float
    end: float
    angle: float
    translation: float
    pitch: float
    axis: tuple[float, float, float]
    point: tuple[float, float, float]

    @property
    def pitch_words(self) -> str:
        """The pitch with its unit."""
        return f"{self.pitch:.3g} m/rad" if np.isfinite(self.pitch) else "infinite"


@dataclass(frozen=True)
class DeviationSeries:
    """How far the samples kept near an object are from the screws: s, m and rad."""

    object: str
    t: tuple[float, ...]
    position: tuple[float, ...]
    rotation: tuple[float, ...]


@dataclass(frozen=True)
class Refusal:
    """Why a recording is not used: the kind of reason, in words, and what to do."""

    reason: str
    message: str
    remedy: str | None


@dataclass(frozen=True)
class LookSummary:
    """What a recording holds, and what is kept of it.

    Attributes:
        name: of the recording.
        line: what is kept of it, or why it is not used.
        source: folder it was read from, or None.
        robot: model it was made on; None for the arm that is planned for.
        samples, duration: how many, in s.
        rate: 1/s, median.
        longest_gap: s, between samples.
        notes: what the importer changed.
        joints: of the arm that was led.
        objects: in the scenario's order.
        refused: why it is not used; None if it is.
        fidelity: of what is kept, for each object of the task.
        remarks: what else should be known of it.
        position_tolerance, rotation_tolerance: m and rad that segmentation allows.
        screws: in the order of time.
        dropped: what is not kept of the recording's time.
        deviations: over time, for each object of the task.
    """

    name: str
    line: str
    source: str | None
    robot: str | None
    samples: int
    duration: float
    rate: float
    longest_gap: float
    notes: tuple[str, ...]
    joints: tuple[JointSummary, ...]
    objects: tuple[ObjectSummary, ...]
    refused: Refusal | None
    fidelity: tuple[Fidelity, ...]
    remarks: tuple[str, ...]
    position_tolerance: float
    rotation_tolerance: float
    screws: tuple[ScrewSummary, ...]
    dropped: tuple[Stretch, ...]
    deviations: tuple[DeviationSeries, ...]

    @property
    def tightest(self) -> JointSummary:
        """The joint that comes nearest to a limit."""
        margin, extent, slides = (
            np.array(of)
            for of in zip(
                *((j.margin, j.upper - j.lower, j.unit == "m") for j in self.joints), strict=True
            )
        )
        return self.joints[int(np.argmin(comparable(margin, extent, slides)))]

    def facts(self) -> Iterator[tuple[str, str]]:
        """Names and texts of what there is to say, but for fidelity and screws."""
        yield (
            "samples",
            f"{self.samples:,} in {self.duration:.2f} s, {self.rate:.0f} a second; longest gap "
            f"{self.longest_gap:.3g} s",
        )
        if self.robot is not None:
            yield "recorded on", self.robot
        yield from (("importer", note) for note in self.notes)
        yield "joints", str(self.tightest) if self.joints else "not recorded; the hand was"
        yield from ((item.name, str(item)) for item in self.objects)
        position, rotation = self.position_tolerance * 1e3, self.rotation_tolerance
        yield "tolerances", f"{position:g} mm and {rotation:.2g} rad from the screws"
        yield from (("dropped", text) for text in self.dropped_words())

    def dropped_words(self) -> Iterator[str]:
        """A text for each reason why a part of the recording's time is not kept."""
        for why in dict.fromkeys(stretch.why for stretch in self.dropped):
            parts = [s for s in self.dropped if s.why == why]
            seconds = sum(s.end - s.start for s in parts)
            times = " and ".join(f"{s.start:.2f} to {s.end:.2f} s" for s in parts)
            yield f"{seconds / self.duration:.0%} of the time, {why}: {times}"


def summarized(look: Look) -> LookSummary:
    """A look in plain data."""
    t, found, error = look.t, look.demonstration, look.refused
    names, source = look.shown.names, look.recording.source
    position, rotation = look.tolerances
    return LookSummary(
        name=look.name,
        line=str(look),
        source=None if source is None else str(source),
        robot=look.recording.robot,
        samples=len(t),
        duration=look.recording.duration,
        rate=float(1.0 / np.median(np.diff(t))),
        longest_gap=float(np.diff(t).max()),
        notes=look.recording.notes,
        joints=tuple(_joint(look, j) for j in range(len(look.units))),
        objects=tuple(_object(look, i) for i in range(len(names))),
        refused=None if error is None else Refusal(error.reason, error.message, error.remedy),
        fidelity=() if found is None else found.fidelity,
        remarks=() if found is None else found.notes,
        position_tolerance=position,
        rotation_tolerance=rotation,
        screws=tuple(_screw(look, segment) for segment in look.screws),
        dropped=look.dropped,
        deviations=tuple(
            DeviationSeries(
                names[d.object],
                tuple(t[d.samples].tolist()),
                tuple(d.position.tolist()),
                tuple(d.rotation.tolist()),
            )
            for d in look.deviations
        ),
    )


def _joint(look: Look, j: int) -> JointSummary:
    q, nearest = look.q[:, j], int(look.margin[:, j].argmin())
    return JointSummary(
        look.recording.joint_names[j],
        look.units[j],
        float(look.lower[j]),
        float(look.upper[j]),
        float(q.min()),
        float(q.max()),
        float(look.margin[nearest, j]),
        float(look.t[nearest]),
    )


def _object(look: Look, i: int) -> ObjectSummary:
    regions, t, nearest = look.shown.regions, look.t, int(look.distance[:, i].argmin())
    visits = sorted((*regions.visits, *regions.left_out), key=lambda visit: visit.start)
    return ObjectSummary(
        look.shown.names[i],
        bool(regions.task[i]),
        float(look.distance[nearest, i]),
        float(t[nearest]),
        float(look.radius[i]),
        tuple(
            VisitSummary(float(t[v.start]), float(t[v.stop - 1]), v in regions.visits)
            for v in visits
            if v.object == i
        ),
    )


def _screw(look: Look, segment: ScrewSegment) -> ScrewSummary:
    screw = segment.screw
    return ScrewSummary(
        look.shown.names[segment.object],
        segment.start,
        segment.end,
        float(screw.angle),
        float(screw.translation),
        float(screw.pitch),
        tuple(screw.axis.tolist()),
        tuple(screw.point.tolist()),
    )
