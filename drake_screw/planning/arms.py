"""Several arms of one robot, of which one moves at a time: whichever can follows the screws."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.demonstrations import Demonstration
from drake_screw.planning.batch import BatchPlanner
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.planning.columns import furthest
from drake_screw.planning.outcomes import Outcomes
from drake_screw.typing import Array

OfOneArm = BatchPlanner | CollisionFreePlanner


class ArmsPlanner:
    """Answers as a planner of one arm does, for whichever of several arms can.

    Every arm is planned for from its own start, the others at rest, which is the business of its
    own planner. They are tried in their order until one succeeds: an instance has a plan if one of
    them has. Where approaches are led around what is in the way, all arms are tried without that
    first. An outcome names its arm (`Outcomes.arm`); of a failure that of the best attempt.

    Args:
        planners: of each arm, in the order in which they are tried.
    """

    def __init__(self, planners: Sequence[OfOneArm]) -> None:
        self.planners = tuple(planners)
        self._ends = np.cumsum([planner.chain.n for planner in planners])

    @property
    def evaluations(self) -> int:
        """As `BatchPlanner.evaluations`."""
        return sum(planner.evaluations for planner in self.planners)

    def starts(self, q_start: ArrayLike) -> tuple[Array, ...]:
        """Where each arm starts, (n,) rad or m each.

        Args:
            q_start: the same one after the other.

        Raises:
            ValueError: there are not as many numbers as the arms have joints.
        """
        q_start = np.asarray(q_start, dtype=float)
        if q_start.shape != (self._ends[-1],):
            raise ValueError(
                f"q_start has shape {q_start.shape}, expected ({self._ends[-1]},): "
                "the joints of one arm after those of another"
            )
        return tuple(np.split(q_start, self._ends[:-1]))

    def all_outcomes(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance with every demonstration; see `BatchPlanner.all_outcomes`.

        Args:
            demonstrations: D of them.
            X_WO: (N, k, 4, 4) object poses of the instances.
            q_start: (n,) rad or m, where all arms start, those of one after those of another.

        Returns:
            Outcomes (N, D).
        """
        X_WO, starts = np.asarray(X_WO, dtype=float), self.starts(q_start)
        found: Outcomes | None = None
        for arm, planner in self._passes():
            if found is None:
                found = planner.all_outcomes(demonstrations, X_WO, starts[arm]).of_arm(arm)
                continue
            for d, demonstration in enumerate(demonstrations):
                left = np.flatnonzero(~found.success[:, d])
                again = planner.all_outcomes([demonstration], X_WO[left], starts[arm])
                better = furthest(found[left, d], again[:, 0].of_arm(arm))
                found = found.replaced((left, d), better)
        assert found is not None
        return found

    def any_success(
        self, demonstrations: Sequence[Demonstration], X_WO: ArrayLike, q_start: ArrayLike
    ) -> Outcomes:
        """Plan every instance until one demonstration succeeds; see `BatchPlanner.any_success`.

        All demonstrations are tried with an arm before the next arm is. Takes and returns what
        `all_outcomes` does.
        """
        X_WO, starts = np.asarray(X_WO, dtype=float), self.starts(q_start)
        found: Outcomes | None = None
        for arm, planner in self._passes():
            if found is None:
                found = planner.any_success(demonstrations, X_WO, starts[arm]).of_arm(arm)
                continue
            left = np.flatnonzero(~found.any_success)
            again = planner.any_success(demonstrations, X_WO[left], starts[arm]).of_arm(arm)
            found = found.replaced(left, furthest(found[left], again))
        assert found is not None
        return found

    def _passes(self) -> Iterator[tuple[int, OfOneArm]]:
        """The planners in the order in which they are asked, those with ways around last."""
        for arm, planner in enumerate(self.planners):
            if isinstance(planner, CollisionFreePlanner) and planner.connects:
                yield arm, planner.checked
            else:
                yield arm, planner
        for arm, planner in enumerate(self.planners):
            if isinstance(planner, CollisionFreePlanner) and planner.connects:
                yield arm, planner
