"""A run opened to look at: its rounds, its instances, and any of its attempts planned again."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.acquisition import RoundFinished, Suggestion
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import RunDirectoryError, ScenarioError
from drake_screw.planning import Cause, Outcomes, ReferencePlanner
from drake_screw.runs.directory import RunDirectory
from drake_screw.runs.run import Run, open_run
from drake_screw.visualization.attempt import Attempt, attempt, cut_short
from drake_screw.visualization.browsing import Catalogue, catalogue
from drake_screw.visualization.rounds import cells

STEP = 0.02
"""Of the reference planner; twice its usual one, which outcomes hardly feel."""


class Inspection:
    """A run directory, finished or still growing.

    Args:
        run: opened.

    Raises:
        RunDirectoryError: no round is finished yet, or the directory is damaged.
    """

    def __init__(self, run: Run) -> None:
        self.run = run
        self.setup: Setup = run.setup
        self.planner = ReferencePlanner(self.setup.workcell.arm, step=STEP)
        self._demonstrations: list[Demonstration] = []
        self.event = lru_cache(maxsize=8)(self._event)
        self.catalogue = lru_cache(maxsize=8)(self._catalogue)
        self.attempt = lru_cache(maxsize=64)(self._attempt)
        if self.rounds == 0:
            raise RunDirectoryError(
                "no round of this run is finished yet",
                remedy="Wait for its first round, or carry it on with: drake-screw run --resume "
                f"{run.directory.path}",
                file=run.directory.path,
            )

    @property
    def rounds(self) -> int:
        """How many rounds are finished."""
        return len(self.run.directory.record["rounds"])

    def refresh(self) -> bool:
        """Look for new rounds of a run that is still going on; returns whether there are any."""
        before = self.rounds
        directory = RunDirectory.open(self.run.directory.path)
        self.run = Run(self.setup, directory)
        return self.rounds > before

    def check_round(self, number: int | None) -> int:
        """A round's index from its number as people count, or the one to begin with.

        That is the last one that asked for a demonstration, or the last one if none did.

        Raises:
            ScenarioError: there is no such round.
        """
        if number is None:
            asked = [
                i
                for i, entry in enumerate(self.run.directory.record["rounds"])
                if entry.get("next_demonstration") is not None
            ]
            return asked[-1] if asked else self.rounds - 1
        if not 1 <= number <= self.rounds:
            raise ScenarioError(
                f"no round {number}", remedy=f"This run has rounds 1 to {self.rounds}."
            )
        return number - 1

    def check_instance(self, round: int, instance: int | None) -> int | None:
        """A row of the round's instances, or the one to begin with.

        Raises:
            ScenarioError: there is no such row.
        """
        total = len(self.event(round).evaluation.x_y_yaw)
        if instance is None:
            place = self.catalogue(round).first()
            return None if place is None else int(self.catalogue(round).instance[place])
        if not 0 <= instance < total:
            raise ScenarioError(
                f"no instance {instance} in round {round + 1}",
                remedy=f"Its instances are numbered 0 to {total - 1}, as in instances.npz.",
            )
        return instance

    def outcomes(self, round: int, instance: int) -> Outcomes:
        """(D,) what the run itself found."""
        return self.event(round).evaluation.outcomes[instance]

    def best(self, round: int, instance: int) -> int | None:
        """The demonstration that comes furthest at an instance."""
        outcomes = self.outcomes(round, instance)
        if outcomes.shape[0] == 0:
            return None
        progress = outcomes.segment + np.clip(outcomes.fraction.astype(float), 0.0, 0.999)
        progress = np.where(outcomes.cause == Cause.NOT_TRIED, -1.0, progress)
        return int(np.where(outcomes.success, np.inf, progress).argmax())

    def attempts(self, round: int, instance: int) -> list[Attempt]:
        """All demonstrations of a round tried at an instance."""
        count = len(self.event(round).demonstrations)
        return [self.attempt(round, instance, d) for d in range(count)]

    def _attempt(self, round: int, instance: int, number: int) -> Attempt:
        """One demonstration tried at an instance, cut short where the run saw a collision."""
        event = self.event(round)
        X_WO = self.setup.area.X_WO(event.evaluation.x_y_yaw[instance])
        start, workcell = self.setup.workcell.start, self.setup.workcell
        tried = attempt(self.planner, number, event.demonstrations[number], X_WO, start)
        found = event.evaluation.outcomes[instance][number]
        if int(found.cause) == Cause.COLLISION and int(tried.cause) != Cause.COLLISION:
            tried = replace(tried, plan=cut_short(tried.plan, found))
        if tried.cause == Cause.COLLISION:
            tried = replace(tried, bodies=workcell.colliding_bodies(tried.plan.q[-1], X_WO))
        return tried

    def _event(self, round: int) -> RoundFinished:
        """A round as the run told it; without drawing or planning anything."""
        directory = self.run.directory
        try:
            remembered = self.run.remembered(round)
            entry: dict[str, Any] = directory.record["rounds"][round]
            count = int(entry["demonstrations"])
            suggestion = self._suggestion(entry["next_demonstration"])
            for number in range(len(self._demonstrations), count):
                recording, _ = self.run.stored(number)
                self._demonstrations.append(self.setup.learn(recording))
        except (KeyError, TypeError, ValueError, IndexError) as error:
            raise RunDirectoryError(
                f"what it says of round {round + 1} is damaged: {error!r}",
                remedy="Restore it, or run the scenario again.",
                file=directory.path,
            ) from error
        assert remembered is not None
        evaluation, verdict = remembered
        hand = tuple(self._demonstrations[:count])
        regions = evaluation.partition(self.setup.regions)
        return RoundFinished(round, hand, evaluation, verdict, suggestion, regions)

    def _suggestion(self, entry: dict[str, Any] | None) -> Suggestion | None:
        if entry is None:
            return None
        objects = [entry["objects"][o.name] for o in self.setup.area.objects]
        x_y_yaw = np.array([[o["x"], o["y"], o["yaw"]] for o in objects], dtype=float)
        segment = entry["failed_segment"]
        return Suggestion(int(entry["region"]), x_y_yaw, None if segment is None else segment - 1)

    def _catalogue(self, round: int) -> Catalogue:
        event = self.event(round)
        drawn = cells(event.regions, event.verdict.estimates)
        return catalogue(event, event.evaluation.region, drawn.object)


def open_inspection(path: Path) -> Inspection:
    """Open a run directory to look at it; see `open_run` and `Inspection` for what is raised."""
    return Inspection(open_run(path))
