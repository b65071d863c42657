"""A run's files as its events, its instances, and any of its attempts planned again."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from zipfile import BadZipFile

from drake_screw.acquisition import (
    DemonstrationAdded,
    DemonstrationRequested,
    Evaluation,
    Event,
    Finished,
    RoundFinished,
    RoundStarted,
    Status,
    Suggestion,
)
from drake_screw.acquisition.loop import initial_places
from drake_screw.assembly.attempting import judged_attempt
from drake_screw.assembly.setup import Setup
from drake_screw.bandits import Verdict
from drake_screw.demonstrations import Demonstration, Recording
from drake_screw.errors import RunDirectoryError, ScenarioError, counted
from drake_screw.planning import Cause, Outcomes
from drake_screw.runs.codec import REMEDY, load_evaluation
from drake_screw.runs.directory import INSTANCES, SCENARIO, RunDirectory
from drake_screw.visualization.attempt import Attempt, executed
from drake_screw.visualization.browsing import Catalogue, catalogue
from drake_screw.visualization.cells import cells


class DamagedRound(RunDirectoryError):
    """The instances of a round are missing, or cannot be read."""


class RunReader:
    """What the directory of a run holds, finished or still growing. It writes nothing.

    Rounds, demonstrations and instances are counted from 0.

    Args:
        setup: of the scenario in the directory.
        directory: of the run.
    """

    def __init__(self, setup: Setup, directory: RunDirectory) -> None:
        self.setup = setup
        self.directory = directory
        self._learned: list[Demonstration] = []
        self.event = lru_cache(maxsize=8)(self._event)
        self.catalogue = lru_cache(maxsize=8)(self._catalogue)
        self.attempt = lru_cache(maxsize=64)(self._attempt)

    @property
    def rounds(self) -> int:
        """How many rounds are finished."""
        return len(self.directory.record.rounds)

    def all_rounds(self) -> list[RoundFinished]:
        """All finished rounds."""
        return [self.event(round) for round in range(self.rounds)]

    def refresh(self) -> bool:
        """Look for new rounds of a run that is still going on; returns whether there are any."""
        before = self.rounds
        self.directory.refresh()
        return self.rounds > before

    def events(self) -> Iterator[Event]:
        """The events of a finished run, from its files.

        Raises:
            RunDirectoryError: what is stored of it is not whole.
        """
        record, block = self.directory.record, self.setup.scenario.demonstrations
        wanted = block.initial
        given = not isinstance(wanted, int)
        initial = len(wanted) if isinstance(wanted, tuple) else wanted
        known = len(record.demonstrations)
        if given and known < initial:
            raise self._lacks("the initial demonstrations")
        for number in range(0 if given else min(initial, known)):
            setup = self.setup
            places = initial_places(setup.regions, record.seed, number, setup.first)
            yield from self._lesson(0, number, places[0])
        verdict = None
        for round in range(self.rounds):
            event = self.event(round)
            if len(event.demonstrations) != initial + round:
                raise self._odd(
                    f"round {round + 1} is said to have {len(event.demonstrations)} "
                    f"demonstrations, not {initial + round}"
                )
            yield RoundStarted(round, event.demonstrations)
            yield event
            verdict = event.verdict
            if round + 1 < self.rounds:
                if event.suggestion is None:
                    raise self._odd(f"round {round + 1} asks for no demonstration")
                yield from self._lesson(round + 1, initial + round, event.suggestion)
        if known >= initial and known != initial + self.rounds - 1:
            raise self._lacks(f"round {self.rounds + 1}")
        ends = verdict is not None and verdict.certified
        status = Status.CERTIFIED if ends else Status.INSUFFICIENT
        if status != record.status:
            raise self._odd(
                f"it ends as '{status}' after {counted(self.rounds, 'round')}; run.json says "
                f"'{record.status}'"
            )
        yield Finished(status, record.reason or "", verdict, self.demonstrations(known))

    def recording(self, number: int) -> Recording:
        """The recording of a demonstration, under the name that it has in the run.

        Raises:
            RunDirectoryError: there is no such demonstration.
            RecordingError: it cannot be read.
        """
        entries = self.directory.record.demonstrations
        if number >= len(entries):
            raise self._lacks(f"demonstration {number + 1}")
        recorder = self.setup.recorder_of(entries[number].robot)
        stored = recorder.read(self.directory.path / entries[number].folder)
        return replace(stored, name=entries[number].name)

    def demonstrations(self, count: int) -> tuple[Demonstration, ...]:
        """The first demonstrations of the run; see `recording` for what is raised."""
        for number in range(len(self._learned), count):
            self._learned.append(self.setup.learn(self.recording(number)))
        return tuple(self._learned[:count])

    def evaluated(self, round: int) -> tuple[Evaluation, Verdict]:
        """The instances of a round, and what it found.

        Raises:
            DamagedRound: they are missing, or damaged.
            RunDirectoryError: they do not belong to the scenario.
        """
        entry = self.directory.record.rounds[round]
        file = self.directory.round_folder(round) / INSTANCES
        try:
            evaluation = load_evaluation(file)
            N, D = evaluation.outcomes.shape
            if len(evaluation.coordinates) != N or len(evaluation.region) != N:
                raise ValueError("its columns are not equally long")
            if entry.demonstrations != D:
                raise ValueError(f"it has outcomes of {D} demonstrations, not as run.json says")
        except FileNotFoundError as error:
            raise DamagedRound(
                f"round {round + 1} is damaged: the file is missing", remedy=REMEDY, file=file
            ) from error
        except (
            OSError,
            EOFError,
            ValueError,
            KeyError,
            TypeError,
            BadZipFile,
            zlib.error,
        ) as error:
            words = f"no {error}" if isinstance(error, KeyError) else str(error).split(". ")[0]
            raise DamagedRound(
                f"round {round + 1} is damaged: {words}", remedy=REMEDY, file=file
            ) from error
        K = evaluation.partition(self.setup.regions).K
        if len(entry.verdict.samples) != K or (evaluation.region >= K).any():
            raise RunDirectoryError(
                f"round {round + 1} does not fit the scenario beside it",
                remedy="Restore the directory, or run the scenario again.",
                file=file.parent,
            )
        return evaluation, entry.verdict.verdict

    def check_round(self, number: int | None) -> int:
        """A round's index from its number as people count, or the one to begin with.

        That is the last one that asked for a demonstration, or the last one if none did.

        Raises:
            RunDirectoryError: no round is finished yet.
            ScenarioError: there is no such round.
        """
        record = self.directory.record
        if self.rounds == 0 and record.ended:
            raise RunDirectoryError(
                f"this run ended before its first round: {record.reason}",
                remedy="Look at meshcat.html in it, change its scenario where that is in the way, "
                f"and see what drake-screw check says of {self.directory.path / SCENARIO}.",
                file=self.directory.path,
            )
        if self.rounds == 0:
            raise RunDirectoryError(
                "no round of this run is finished yet",
                remedy="Wait for its first round, or carry it on with: drake-screw run --resume "
                f"{self.directory.path}",
                file=self.directory.path,
            )
        if number is None:
            asked = [
                i
                for i, entry in enumerate(self.directory.record.rounds)
                if entry.next_demonstration is not None
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
        total = len(self.event(round).evaluation.coordinates)
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
        best = int(self.outcomes(round, instance).best_attempt)
        return None if best < 0 else best

    def attempts(self, round: int, instance: int) -> list[Attempt]:
        """All demonstrations of a round tried at an instance."""
        count = len(self.event(round).demonstrations)
        return [self.attempt(round, instance, d) for d in range(count)]

    def _attempt(self, round: int, instance: int, number: int) -> Attempt:
        """One demonstration tried at an instance, cut short where the run saw it go wrong.

        Where plans are executed, it is planned for where the objects were measured.
        """
        event = self.event(round)
        ran = event.evaluation.executed
        places = event.evaluation.coordinates if ran is None else ran.measured
        X_WO = self.setup.area.X_WO(places[instance])
        demonstration = event.demonstrations[number]
        found = event.evaluation.outcomes[instance][number]
        if found.cause == Cause.NOT_TRIED:
            planner = self.setup.planner
            found = planner.all_outcomes([demonstration], X_WO[None], self.setup.start)[0, 0]
        tried = judged_attempt(self.setup, number, demonstration, X_WO, found)
        names = [o.name for o in self.setup.area.objects]
        symmetries = self.setup.arm_of(found).symmetries
        turned = symmetries.named(demonstration, X_WO, tried.plan.angles, names)
        tried = replace(tried, turned=turned)
        if found.cause == Cause.EXECUTION and ran is not None:
            return executed(tried, found, str(ran.words[instance]))
        return tried

    def _event(self, round: int) -> RoundFinished:
        """A round as the run had it; without drawing or planning anything."""
        evaluation, verdict = self.evaluated(round)
        entry = self.directory.record.rounds[round]
        regions = evaluation.partition(self.setup.regions)
        wanted = entry.next_demonstration
        try:
            suggestion = None if wanted is None else wanted.suggestion(regions)
        except KeyError as error:
            raise self._odd(f"round {round + 1} asks for no place of {error}") from error
        hand = self.demonstrations(entry.demonstrations)
        return RoundFinished(round, hand, evaluation, verdict, suggestion, regions)

    def _lesson(self, round: int, number: int, place: Suggestion) -> Iterator[Event]:
        """A demonstration that was asked for, and the answer."""
        yield DemonstrationRequested(round, number, place)
        recording, learned = self.recording(number), self.demonstrations(number + 1)[-1]
        remark = self.directory.record.demonstrations[number].remark
        yield DemonstrationAdded(round, number, recording, learned, remark)

    def _catalogue(self, round: int) -> Catalogue:
        event = self.event(round)
        drawn = cells(event.regions, event.verdict.estimates)
        return catalogue(event, event.evaluation.region, drawn.axes)

    def _lacks(self, what: str) -> RunDirectoryError:
        return self._odd(f"{what} is missing")

    def _odd(self, what: str) -> RunDirectoryError:
        return RunDirectoryError(f"damaged: {what}", remedy=REMEDY, file=self.directory.path)
