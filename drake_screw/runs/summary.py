"""What a finished run came to, in plain values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drake_screw.errors import RunDirectoryError
from drake_screw.planning.touching import CollisionCounts, count_collisions
from drake_screw.runs.codec import plain
from drake_screw.runs.run import Run


@dataclass(frozen=True)
class RoundSummary:
    """A round: demonstrations in hand, instances drawn, the weakest region and its failure rate."""

    demonstrations: int
    instances: int
    weakest_region: int
    failure_rate: float
    certified: bool


@dataclass(frozen=True)
class RunSummary:
    """What a run came to.

    Attributes:
        directory: of the run.
        scenario: its name.
        seed: of all its random draws.
        status: "certified" or "insufficient".
        reason: why it ended.
        certificate: what it states, as in run.json.
        statement: the same in sentences.
        demonstrations: their names, in the order of use.
        rounds: in their order.
        collisions: how the failing instances of its last round collide, each by its best attempt;
            None where collisions are not looked at.
    """

    directory: Path
    scenario: str
    seed: int
    status: str
    reason: str
    certificate: Mapping[str, Any]
    statement: tuple[str, ...]
    demonstrations: tuple[str, ...]
    rounds: tuple[RoundSummary, ...]
    collisions: CollisionCounts | None = None

    @property
    def certified(self) -> bool:
        """Whether it ended with a certificate."""
        return self.status == "certified"


def summarize_run(run: Run) -> RunSummary:
    """Sum a run up.

    Raises:
        RunDirectoryError: it has not ended.
    """
    record = run.directory.record
    if record.certificate is None:
        raise RunDirectoryError(
            f"this run has not finished; its status is '{record.status}'",
            remedy=f"Finish it first: drake-screw run --resume {run.directory.path}",
            file=run.directory.path,
        )
    collisions = None
    if run.setup.scenario.planner.collision and record.rounds:
        last, _ = run.reader.evaluated(len(record.rounds) - 1)
        collisions = count_collisions(last.outcomes, run.setup.workcell)
    return RunSummary(
        directory=run.directory.path,
        scenario=record.scenario,
        seed=record.seed,
        status=record.status.value,
        reason=record.reason or "",
        certificate=plain(record.certificate),
        statement=record.certificate.statement,
        demonstrations=tuple(entry.name for entry in record.demonstrations),
        rounds=tuple(
            RoundSummary(
                demonstrations=entry.demonstrations,
                instances=sum(entry.samples),
                weakest_region=entry.weakest_region,
                failure_rate=entry.failure_rates[entry.weakest_region],
                certified=entry.certified,
            )
            for entry in record.rounds
        ),
        collisions=collisions,
    )
