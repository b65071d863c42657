"""What a pull of the bandit does with instances: it plans them, or executes their plans, too."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, fields
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Outcomes, Planner
from drake_screw.tasks import WorkArea
from drake_screw.typing import Array


@dataclass(frozen=True, eq=False)
class Executed:
    """What executing the plans of N instances found.

    Attributes:
        measured: (N, k, c) coordinates at which the objects were measured and planned for; where
            they stand is what `coordinates` of the instances say.
        joint_offset: (N, n) rad or m, how far the arm's joints were beyond what its encoders said.
        ran: (N,) whether there was a plan to execute.
        flaw: (N,) what went wrong, a `Flaw` by its text; "" where nothing did or nothing ran.
        words: (N,) the same in words.
        position, rotation: (N,) m and rad, greatest distance of the end effector from where it
            ought to be; these and the following are NaN where nothing ran.
        displacement, turn: (N,) m and rad, that an object was moved at most.
        force: (N,) N, greatest with which the robot touched something.
    """

    measured: Array
    joint_offset: Array
    ran: NDArray[np.bool_]
    flaw: NDArray[np.str_]
    words: NDArray[np.str_]
    position: Array
    rotation: Array
    displacement: Array
    turn: Array
    force: Array

    def counts(self) -> dict[str, int]:
        """How many had which flaw, the most frequent one first."""
        names, count = np.unique(self.flaw[self.flaw != ""], return_counts=True)
        order = np.argsort(-count, kind="stable").tolist()
        return {str(names[i]): int(count[i]) for i in order}


Tried = tuple[Outcomes, Executed | None]
Try = Callable[[Array, Array], Tried]
"""Coordinates (N, k, c) of instances and numbers from [0, 1) (N, width) to what became of them."""


class Executing(Protocol):
    """Executes the plans of instances, in simulation."""

    @property
    def width(self) -> int:
        """How many numbers from [0, 1) an instance takes, for what is not known exactly."""
        ...

    def begin(
        self, round: int, demonstrations: Sequence[Demonstration]
    ) -> AbstractContextManager[Try]:
        """What tries instances in a round; what it needs is there until the context is left."""
        ...


@contextmanager
def begin_tries(
    planner: Planner,
    executing: Executing | None,
    area: WorkArea,
    q_start: Array,
    round: int,
    demonstrations: Sequence[Demonstration],
) -> Iterator[Try]:
    """What tries instances in a round: `executing`, or the planner alone if that is None."""
    if executing is not None:
        with executing.begin(round, demonstrations) as tries:
            yield tries
        return
    yield lambda coordinates, _: (
        planner.any_success(demonstrations, area.X_WO(coordinates), q_start),
        None,
    )


def joined(parts: Sequence[Executed | None]) -> Executed | None:
    """Those of successive instances as one; None where nothing is executed."""
    some = [part for part in parts if part is not None]
    if not some:
        return None
    return Executed(
        **{f.name: np.concatenate([getattr(p, f.name) for p in some]) for f in fields(Executed)}
    )
