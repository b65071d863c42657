"""What the text files of a run hold, as `docs/file_formats.md` describes it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal

import numpy as np

from drake_screw.acquisition import RoundFinished, Status, Suggestion
from drake_screw.bandits import Verdict
from drake_screw.demonstrations import Fidelity, Recording
from drake_screw.runs.certificate import Certificate
from drake_screw.tasks import Regions

_MEASURES = ("position", "rotation", "time", "turn_shown", "turn_kept")


@dataclass(frozen=True)
class VerdictRecord:
    """The fields of a `Verdict`, its arrays (K,) as tuples."""

    certified: bool
    region: int
    reason: str
    claim: str
    samples: tuple[int, ...]
    failures: tuple[int, ...]
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    level: float
    simultaneous: bool
    gap: float | None
    coverage: float
    attempted: bool
    looks: int

    @classmethod
    def of(cls, verdict: Verdict) -> VerdictRecord:
        """The record of a verdict."""
        found = {field.name: getattr(verdict, field.name) for field in fields(cls)}
        arrays = {k: tuple(v.tolist()) for k, v in found.items() if isinstance(v, np.ndarray)}
        return cls(**found | arrays)

    @property
    def verdict(self) -> Verdict:
        """The verdict again."""
        found: dict[str, Any] = asdict(self)
        arrays = {name: np.array(v) for name, v in found.items() if isinstance(v, tuple)}
        return Verdict(**found | arrays)


@dataclass(frozen=True)
class SuggestionRecord:
    """Where the next demonstration is wanted; `failed_segment` is counted from 1.

    Of each of the `objects` there are x, y, yaw, and what else may vary, in m and rad.
    """

    region: int
    region_name: str
    objects: dict[str, dict[str, float]]
    failed_segment: int | None

    @classmethod
    def of(cls, suggestion: Suggestion, regions: Regions) -> SuggestionRecord:
        """The record of a suggestion in one of some regions."""
        area = regions.area
        objects: dict[str, dict[str, float]] = {o.name: {} for o in area.objects}
        for i, j in area.columns:
            objects[area.objects[i].name][area.axes[j]] = float(suggestion.coordinates[i, j])
        return cls(
            suggestion.region,
            regions.name(suggestion.region),
            objects,
            None if suggestion.segment is None else suggestion.segment + 1,
        )

    def suggestion(self, regions: Regions) -> Suggestion:
        """The suggestion again.

        Raises:
            KeyError: an object of the work area, or a coordinate of one, is missing.
        """
        area = regions.area
        coordinates = area.lower
        for i, j in area.columns:
            coordinates[i, j] = self.objects[area.objects[i].name][area.axes[j]]
        return Suggestion(
            self.region,
            coordinates,
            None if self.failed_segment is None else self.failed_segment - 1,
            regions,
        )


@dataclass(frozen=True)
class RoundRecord:
    """What run.json holds of a round, counted from 1; the rest is in the round's folder."""

    round: int
    demonstrations: int
    samples: tuple[int, ...]
    failure_rates: tuple[float, ...]
    weakest_region: int
    certified: bool
    reason: str
    next_demonstration: SuggestionRecord | None
    verdict: VerdictRecord

    def __post_init__(self) -> None:
        verdict = self.verdict
        of_regions = (
            *(self.samples, self.failure_rates, verdict.samples, verdict.failures),
            *(verdict.lower, verdict.upper),
        )
        K = len(self.samples)
        if {len(values) for values in of_regions} != {K} or K == 0:
            raise ValueError("of different numbers of regions")
        if not all(0 <= region < K for region in (self.weakest_region, verdict.region)):
            raise ValueError(f"of a weakest region that is none of its {K}")

    @classmethod
    def of(cls, event: RoundFinished) -> RoundRecord:
        """The record of a round."""
        verdict, regions, place = event.verdict, event.regions, event.suggestion
        return cls(
            round=event.round + 1,
            demonstrations=len(event.demonstrations),
            samples=tuple(np.bincount(event.evaluation.region, minlength=regions.K).tolist()),
            failure_rates=tuple(verdict.estimates.tolist()),
            weakest_region=verdict.region,
            certified=verdict.certified,
            reason=verdict.reason,
            next_demonstration=None if place is None else SuggestionRecord.of(place, regions),
            verdict=VerdictRecord.of(verdict),
        )


@dataclass(frozen=True, kw_only=True)
class FidelityRecord:
    """What run.json holds of a demonstration's fidelity to what was shown near one object.

    See `drake_screw.demonstrations.Fidelity`; deviations are None where no sample is kept.
    """

    object: str
    guiding_poses: int
    position: float | None
    rotation: float | None
    time: float
    turn_shown: float
    turn_kept: float

    @classmethod
    def of(cls, fidelity: Fidelity) -> FidelityRecord:
        """The record of a demonstration's fidelity."""
        values = {name: getattr(fidelity, name) for name in _MEASURES}
        finite: dict[str, Any] = {k: v if math.isfinite(v) else None for k, v in values.items()}
        return cls(object=fidelity.object, guiding_poses=fidelity.guiding_poses, **finite)

    def __str__(self) -> str:
        measures = {name: getattr(self, name) for name in _MEASURES}
        known = {k: math.inf if v is None else v for k, v in measures.items()}
        return str(Fidelity(object=self.object, guiding_poses=self.guiding_poses, **known))


@dataclass(frozen=True, kw_only=True)
class DemonstrationRecord:
    """What run.json holds of a demonstration; its recording is in `folder`."""

    name: str
    folder: str
    source: str | None = None
    robot: str | None = None
    remark: str
    notes: tuple[str, ...]
    fidelity: tuple[FidelityRecord, ...] = ()

    @classmethod
    def of(
        cls, recording: Recording, folder: str, remark: str, fidelity: Sequence[Fidelity] = ()
    ) -> DemonstrationRecord:
        """The record of a recording that is stored in a folder of the run."""
        return cls(
            name=recording.name,
            folder=folder,
            source=None if recording.source is None else str(recording.source),
            robot=recording.robot,
            remark=remark,
            notes=recording.notes,
            fidelity=tuple(FidelityRecord.of(each) for each in fidelity),
        )


@dataclass(frozen=True, kw_only=True)
class RunRecord:
    """What run.json holds."""

    format: int
    scenario: str
    status: Status
    reason: str | None
    seed: int
    strategy: str
    beta: float
    epsilon: float
    delta: float
    regions: int | Literal["adaptive"]
    passed_in: tuple[str, ...] = ()
    led_around: bool | None = None
    model: str
    hashes: dict[str, str]
    versions: dict[str, str]
    started: str
    finished: str | None
    certificate: Certificate | None
    demonstrations: tuple[DemonstrationRecord, ...]
    rounds: tuple[RoundRecord, ...]

    @property
    def ended(self) -> bool:
        """Whether the run has come to its end, with or without a certificate."""
        return self.status in (Status.CERTIFIED, Status.INSUFFICIENT)
