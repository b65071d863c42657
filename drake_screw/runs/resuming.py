"""The acquisition loop, which does not do again what a run's directory holds already."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from drake_screw.acquisition import (
    Evaluation,
    Event,
    Lesson,
    Suggestion,
    TreeEvaluator,
    UsableLessons,
    acquire,
)
from drake_screw.acquisition.grid_evaluator import Progress
from drake_screw.bandits import Verdict
from drake_screw.demonstrations import Demonstration, Recording
from drake_screw.runs.kept_executions import KeptExecutions
from drake_screw.runs.reader import RunReader


def carry_on(reader: RunReader, progress: Progress) -> Iterator[Event]:
    """The events of a run, from its beginning.

    Only demonstrations are put into the directory, before they are learned from; whoever takes the
    events is to put the rounds there.

    Args:
        reader: of the run.
        progress: called with every batch of instances within a round, and as they are executed.
    """
    setup, scenario = reader.setup, reader.setup.scenario
    evaluator = setup.evaluator(progress, KeptExecutions(reader.directory.path))

    def evaluate(
        round: int, demonstrations: tuple[Demonstration, ...], attempt: int
    ) -> tuple[Evaluation, Verdict]:
        if round >= reader.rounds:
            return evaluator.evaluate(round, demonstrations, attempt)
        evaluation, verdict = reader.evaluated(round)
        if isinstance(evaluator, TreeEvaluator):
            evaluator.remember(evaluation)
        return evaluation, verdict

    initial = setup.initial
    if not isinstance(initial, int):
        initial = tuple(
            _kept(reader, i, recording, "given in the scenario")
            for i, recording in enumerate(initial)
        )
    return acquire(
        evaluate,
        _KeptTeacher(reader),
        setup.learn,
        setup.regions,
        initial=initial,
        budget=scenario.demonstrations.budget,
        seed=scenario.seed,
        ask=setup.ask,
        first=setup.first,
    )


def _kept(reader: RunReader, number: int, recording: Recording, remark: str) -> Recording:
    """A recording as the run directory has it, where it is put first if it is new.

    What is learned from is always what the files say, so that a resumed run cannot differ.
    """
    if number >= len(reader.directory.record.demonstrations):
        setup = reader.setup
        fidelity = setup.learn(recording).fidelity
        held = {name: q for one in setup.arms for name, q in one.robot.parked.items()}
        reader.directory.add_demonstration(number, recording, remark, held, fidelity)
    return reader.recording(number)


@dataclass(frozen=True)
class _KeptTeacher:
    """Asks the scenario's teacher only what the run directory does not know yet."""

    reader: RunReader

    def demonstrate(
        self,
        suggestion: Suggestion,
        *,
        number: int,
        used: tuple[Recording, ...],
        rng: np.random.Generator,
    ) -> Lesson:
        reader = self.reader
        known = reader.directory.record.demonstrations
        if number < len(known):
            return Lesson(reader.recording(number), known[number].remark)
        teacher = UsableLessons(reader.setup.teacher, reader.setup.learn)
        lesson = teacher.demonstrate(suggestion, number=number, used=used, rng=rng)
        if lesson.recording is None:
            return lesson
        return Lesson(_kept(reader, number, lesson.recording, lesson.remark), lesson.remark)
