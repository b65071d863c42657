"""Events of a run in words, for logs and terminals."""

from __future__ import annotations

from drake_screw.acquisition import (
    DemonstrationAdded,
    DemonstrationRequested,
    Event,
    Finished,
    InstancesExecuted,
    RegionsEvaluated,
    RoundFinished,
    RoundStarted,
    Suggestion,
)
from drake_screw.errors import counted
from drake_screw.tasks import Regions


def describe(event: Event, regions: Regions) -> str:
    """One line on an event."""
    match event:
        case RoundStarted():
            return f"round {event.round + 1}: evaluating {_count(len(event.demonstrations))}"
        case RegionsEvaluated():
            return f"round {event.round + 1}: {counted(int(event.samples.sum()), 'instance')}"
        case InstancesExecuted():
            return f"round {event.round + 1}: executed {event.done:,} of {event.total:,}"
        case RoundFinished():
            verdict, region = event.verdict, event.verdict.weakest
            worst = "none fails"
            if region is not None:
                worst = f"weakest region {region} ({event.regions.name(region)}) fails "
                worst += f"{verdict.estimates[region]:.2%}"
            return (
                f"round {event.round + 1}: {counted(len(event.evaluation.region), 'instance')}; "
                f"{worst}; {verdict.reason}"
            )
        case DemonstrationRequested():
            return f"demonstration {event.number + 1} wanted at {place(event.suggestion, regions)}"
        case DemonstrationAdded():
            demonstration = event.demonstration
            known = (*event.recording.notes, *demonstration.notes, *demonstration.fidelity)
            notes = "".join(f"; {note}" for note in known)
            return (
                f"demonstration {event.number + 1} is {event.recording.name} "
                f"({event.recording.duration:.1f} s, {len(event.demonstration.X_OE)} guiding "
                f"poses): {event.remark}{notes}"
            )
        case Finished():
            return f"{event.status.value}: {event.reason}"


def place(suggestion: Suggestion, regions: Regions) -> str:
    """Where a demonstration is wanted."""
    area = regions.area
    where = ", ".join(
        f"{o.name} {area.words(i, suggestion.coordinates, turned=True)}"
        for i, o in enumerate(area.objects)
    )
    failed = "" if suggestion.segment is None else f", segment {suggestion.segment + 1} fails"
    return f"{where} (region {suggestion.region}{failed})"


def _count(n: int) -> str:
    return f"{n} demonstration{'' if n == 1 else 's'}"
