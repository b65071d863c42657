"""What a finished run came to, in plain values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drake_screw.acquisition import Evaluation, RoundFinished, Status
from drake_screw.errors import RunDirectoryError, counted
from drake_screw.planning.touching import CollisionCounts, count_collisions
from drake_screw.runs.codec import plain
from drake_screw.runs.records import RunRecord
from drake_screw.runs.run import Run
from drake_screw.visualization.rounds import headline


@dataclass(frozen=True)
class RoundSummary:
    """A round: demonstrations in hand, instances drawn, the weakest region and its failure rate."""

    demonstrations: int
    instances: int
    weakest_region: int
    failure_rate: float
    certified: bool


def round_in_run(event: RoundFinished, record: RunRecord) -> str:
    """A round and how it ended, and how the run did: "...; the run: certified in round 4"."""
    words, last = headline(event), len(record.rounds)
    if event.round + 1 == last and record.status == Status.CERTIFIED:
        return f"{words}, the end of the run"
    if record.status == Status.CERTIFIED:
        return f"{words}; the run: certified in round {last}"
    if record.ended:
        return f"{words}; the run: {record.status}, ended after {counted(last, 'round')}"
    return f"{words}; the run: {record.status}, {counted(last, 'round')} so far"


@dataclass(frozen=True)
class ExecutionCounts:
    """How many plans were executed, and how many of these went wrong, by `Flaw`."""

    executed: int
    flaws: Mapping[str, int]

    def __str__(self) -> str:
        wrong = ", ".join(f"{name} {count:,}" for name, count in self.flaws.items())
        failed = f"{sum(self.flaws.values()):,} failed: {wrong}" if wrong else "none failed"
        return f"{counted(self.executed, 'plan')} executed, {failed}"


def count_executions(evaluation: Evaluation) -> ExecutionCounts | None:
    """What executing the plans of a round found; None where they are not."""
    ran = evaluation.executed
    return None if ran is None else ExecutionCounts(int(ran.ran.sum()), ran.counts())


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
        executions: of its last round how many plans were executed, and of these how many went
            wrong, by what explains it; None where plans are not executed.
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
    executions: ExecutionCounts | None = None

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
    collisions = executions = None
    if record.rounds:
        executions = count_executions(run.reader.evaluated(len(record.rounds) - 1)[0])
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
        executions=executions,
    )
