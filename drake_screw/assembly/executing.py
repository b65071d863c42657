"""Instances whose plans are executed in simulation: what a pull of the bandit does then."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Protocol

import numpy as np

from drake_screw.acquisition import Executed, InstancesExecuted
from drake_screw.acquisition.tries import Tried, Try
from drake_screw.assembly.ranked_plans import best_plan
from drake_screw.assembly.stations import check_masses, check_standing, station_config
from drake_screw.assembly.symmetries import object_symmetries
from drake_screw.assembly.ways import ways
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import ScenarioError
from drake_screw.execution.noise import Noise
from drake_screw.execution.parallel import Bench, Job, Judged, judge
from drake_screw.planning import Cause, Outcomes
from drake_screw.planning.outcomes import one_outcome
from drake_screw.planning.roll import turned_along
from drake_screw.screws import inverse
from drake_screw.sharing import Crew
from drake_screw.tasks import Symmetry
from drake_screw.typing import Array

if TYPE_CHECKING:
    from drake_screw.assembly.planning_setup import PlanningSetup

_MEASURES = ("position", "rotation", "displacement", "turn", "force")

Place = tuple[float, ...]
"""What tells an instance of a round from the others: its objects' places, and joint offsets."""


class Kept(Protocol):
    """Remembers executions of a round, so that an interrupted one does not do them again."""

    def known(self, round: int) -> dict[Place, Judged]:
        """Those of a round that are known."""
        ...

    def keep(self, round: int, place: Place, judged: Judged) -> None:
        """Remember one."""
        ...


@dataclass(frozen=True)
class ExecutedTries:
    """Executes the best plan of every instance that has one.

    What is executed is what `drake-screw execute --free-objects` would execute: the plan with the
    largest margin which touches nothing. Planning is done for where the objects are measured, and
    the end effector ought to go where the same plan would lead it if they were measured exactly.

    Attributes:
        setup: of the scenario.
        noise: what is not known exactly.
        progress: is told how many of the plans at hand are executed.
        kept: remembers them.
        workers: processes; as many as processors if None.
    """

    setup: PlanningSetup
    noise: Noise
    progress: Callable[[InstancesExecuted], None] | None = None
    kept: Kept | None = None
    workers: int | None = None

    @property
    def width(self) -> int:
        """How many numbers from [0, 1) an instance takes."""
        return self.noise.width(len(self.setup.area.objects), self.setup.workcell.arm.n)

    @contextmanager
    def begin(self, round: int, demonstrations: Sequence[Demonstration]) -> Iterator[Try]:
        """What tries instances in a round, in processes that end with the context."""
        config = station_config(self.setup, free_objects=True)
        with Crew(partial(Bench.of, config), self.workers) as crew:
            yield partial(self._try, crew, round, demonstrations)

    def told(
        self, progress: Callable[[InstancesExecuted], None] | None, kept: Kept | None
    ) -> ExecutedTries:
        """The same that tells its progress, and keeps what it finds."""
        return replace(self, progress=progress, kept=kept)

    def check(self) -> None:
        """Refuse what cannot be executed, before a run begins.

        Raises:
            ModelError: the model lacks inertia.
            ScenarioError: an object has nothing to stand on, or a planner was passed in.
        """
        if "planner" in self.setup.passed_in:
            raise ScenarioError(
                "plans are executed (coverage.success: execution), and those of a planner that is "
                "passed in cannot be",
                remedy="Leave the planner out, or write coverage.success: plan.",
                file=self.setup.scenario.source,
            )
        check_masses(self.setup.workcell)
        check_standing(self.setup, station_config(self.setup, free_objects=True))

    def _try(
        self,
        crew: Crew[Bench],
        round: int,
        demonstrations: Sequence[Demonstration],
        coordinates: Array,
        numbers: Array,
    ) -> Tried:
        setup = self.setup
        off, joint_offset = self.noise.drawn(numbers, self._symmetries, setup.workcell.arm.slides)
        measured = coordinates.copy()
        measured[..., : off.shape[-1]] += off
        X_WO, X_WM = setup.area.X_WO(coordinates), setup.area.X_WO(measured)
        start = setup.workcell.start
        outcomes = setup.careful_planner.any_success(demonstrations, X_WM, start)
        solved = np.flatnonzero(outcomes.any_success).tolist()
        jobs, chosen = [], []
        names, arms = [o.name for o in setup.area.objects], ways(setup.arms)
        for i in solved:
            best = best_plan(arms, demonstrations, X_WM[i], names, 1)
            moved = self.off_by(X_WM[i], X_WO[i])[best.demonstration.objects]
            jobs.append(Job(best.plan, X_WO[i], joint_offset[i], moved @ best.plan.guides))
            number = next(d for d, one in enumerate(demonstrations) if one is best.demonstration)
            chosen.append((number, int(best.plan.outcome.variant)))
        places = [(*coordinates[i].ravel().tolist(), *joint_offset[i].tolist()) for i in solved]
        judged = self._judged(crew, round, jobs, places)
        outcomes = _after(outcomes, solved, chosen, judged)
        return outcomes, _executed(measured, joint_offset, solved, judged)

    def off_by(self, X_WM: Array, X_WO: Array) -> Array:
        """Motions in the world from where objects are measured to where they stand, (k, 4, 4).

        A body of revolution is as well where it was measured to be turned: as what it stands on was
        measured wrongly, say.
        """
        found = [
            turned_along(M, X, s.axis if s is not None and s.turns is None else None) @ inverse(M)
            for M, X, s in zip(X_WM, X_WO, self._symmetries, strict=True)
        ]
        return np.stack(found)

    @property
    def _symmetries(self) -> list[Symmetry | None]:
        return object_symmetries(self.setup.scenario)

    def _judged(
        self, crew: Crew[Bench], round: int, jobs: Sequence[Job], places: Sequence[Place]
    ) -> list[Judged]:
        known = {} if self.kept is None else self.kept.known(round)
        found = {i: known[place] for i, place in enumerate(places) if place in known}
        left = [i for i in range(len(jobs)) if i not in found]
        tell = self.progress or (lambda event: None)
        if left:
            tell(InstancesExecuted(round, len(found), len(jobs)))
        for at, judged in crew.share(judge, [jobs[i] for i in left]):
            found[left[at]] = judged
            if self.kept is not None:
                self.kept.keep(round, places[left[at]], judged)
            tell(InstancesExecuted(round, len(found), len(jobs)))
        return [found[i] for i in range(len(jobs))]


def _after(
    outcomes: Outcomes,
    solved: Sequence[int],
    chosen: Sequence[tuple[int, int]],
    judged: Sequence[Judged],
) -> Outcomes:
    """Outcomes (N, D) of planning, after the plans of some instances were executed.

    Of an instance with a plan, the demonstration that the executed one is of has what came of it;
    others that have a plan, too, are not tried.
    """
    for i, (number, variant), found in zip(solved, chosen, judged, strict=True):
        others = np.flatnonzero(outcomes.success[i])
        outcomes = outcomes.replaced((i, others), one_outcome(Cause.NOT_TRIED, fraction=0.0))
        came_of_it = one_outcome(Cause.SUCCESS, variant=variant)
        if found.flaw:
            came_of_it = one_outcome(
                Cause.EXECUTION, found.segment, fraction=found.fraction, variant=variant
            )
        outcomes = outcomes.replaced((i, number), came_of_it)
    return outcomes


def _executed(
    measured: Array, joint_offset: Array, solved: Sequence[int], judged: Sequence[Judged]
) -> Executed:
    N = len(measured)
    flaw, words = np.full(N, "", dtype=object), np.full(N, "", dtype=object)
    numbers = {name: np.full(N, np.nan) for name in _MEASURES}
    ran = np.zeros(N, dtype=bool)
    for i, found in zip(solved, judged, strict=True):
        ran[i], flaw[i], words[i] = True, found.flaw, found.words
        for name, values in numbers.items():
            values[i] = getattr(found, name)
    return Executed(measured, joint_offset, ran, flaw.astype(str), words.astype(str), **numbers)
