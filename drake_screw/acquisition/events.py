"""What the acquisition loop reports to its listeners, in the order in which it happens."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from drake_screw.acquisition.tries import Executed
from drake_screw.bandits import Cell, Verdict
from drake_screw.demonstrations import Demonstration, Recording
from drake_screw.planning import Outcomes
from drake_screw.tasks import Regions, box_regions
from drake_screw.typing import Array


class Status(StrEnum):
    """How a run ended, or that it has not."""

    RUNNING = "running"
    CERTIFIED = "certified"
    INSUFFICIENT = "insufficient"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True, eq=False)
class Evaluation:
    """The instances of one round and what planning made of them.

    Attributes:
        coordinates: (N, k, c) m and rad, in the order of `WorkArea.axes`.
        region: (N,) the region each was drawn in.
        outcomes: (N, D), one column for each demonstration in hand.
        frontier: the cells of the tree in which the round ended, where the partition refines
            itself; `region` counts them.
        executed: what executing the plans found; None where a plan is a success.
    """

    coordinates: Array
    region: NDArray[np.int64]
    outcomes: Outcomes
    frontier: tuple[Cell, ...] = ()
    executed: Executed | None = None

    @property
    def failed(self) -> NDArray[np.bool_]:
        """(N,) no demonstration gives a plan, or one that is executed as it should be."""
        return ~self.outcomes.any_success

    def partition(self, start: Regions) -> Regions:
        """What `region` counts: the cells of the frontier, or `start` where there is none."""
        if not self.frontier:
            return start
        lower = [cell.lower for cell in self.frontier]
        return box_regions(start.area, lower, [cell.upper for cell in self.frontier])


@dataclass(frozen=True, eq=False)
class Suggestion:
    """Where the next demonstration should be given.

    Attributes:
        region: the region that needs it.
        coordinates: (k, c) the instance to demonstrate at.
        segment: screw segment, from 0, in which the best attempt there failed; None where there
            was no attempt (an initial demonstration).
        regions: what `region` counts; None for the run's own partition.
        failing: (M, k, c) instances that fail with the demonstrations in hand, drawn evenly from
            all of the work area where it fails; None where a suggestion is read from a file.
    """

    region: int
    coordinates: Array
    segment: int | None = None
    regions: Regions | None = None
    failing: Array | None = None


@dataclass(frozen=True, eq=False)
class RoundStarted:
    """A round of evaluation begins with these demonstrations in hand."""

    round: int
    demonstrations: tuple[Demonstration, ...]


@dataclass(frozen=True, eq=False)
class RegionsEvaluated:
    """Some more instances of a round were planned; the counts (K,) are of the round so far.

    Where the partition refines itself they are of the whole work area, (1,). `total` is how many
    instances the round will have in all; None where that depends on what they come to.
    """

    round: int
    samples: NDArray[np.int64]
    failures: NDArray[np.int64]
    total: int | None = None


@dataclass(frozen=True)
class InstancesExecuted:
    """So many of the plans that a round's strategy asked for at a time have been executed."""

    round: int
    done: int
    total: int


@dataclass(frozen=True, eq=False)
class RoundFinished:
    """A round's verdict on its regions, and the next suggestion unless it certified."""

    round: int
    demonstrations: tuple[Demonstration, ...]
    evaluation: Evaluation
    verdict: Verdict
    suggestion: Suggestion | None
    regions: Regions


@dataclass(frozen=True, eq=False)
class DemonstrationRequested:
    """The teacher is asked. `round` is the round the demonstration will first be used in."""

    round: int
    number: int
    suggestion: Suggestion


@dataclass(frozen=True, eq=False)
class DemonstrationAdded:
    """The teacher answered; `remark` is a human-readable comment on the answer."""

    round: int
    number: int
    recording: Recording
    demonstration: Demonstration
    remark: str


@dataclass(frozen=True, eq=False)
class Finished:
    """The run is over.

    Attributes:
        status: CERTIFIED or INSUFFICIENT.
        reason: why it ended, human-readable.
        verdict: of the last round; None if none was evaluated.
        demonstrations: all in hand.
    """

    status: Status
    reason: str
    verdict: Verdict | None
    demonstrations: tuple[Demonstration, ...]


Event = (
    RoundStarted
    | RegionsEvaluated
    | InstancesExecuted
    | RoundFinished
    | DemonstrationRequested
    | DemonstrationAdded
    | Finished
)
