"""Running a scenario: the acquisition loop, with its run directory as memory and listener."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Unpack

import numpy as np

from drake_screw.acquisition import (
    Evaluation,
    Event,
    Finished,
    Lesson,
    RegionsEvaluated,
    RoundFinished,
    Status,
    Suggestion,
    TreeEvaluator,
    acquire,
)
from drake_screw.assembly.setup import Parts, Setup
from drake_screw.bandits import Verdict
from drake_screw.demonstrations import Demonstration, Recording
from drake_screw.errors import RunDirectoryError, ScenarioError
from drake_screw.runs.certificate import certificate
from drake_screw.runs.directory import LOG, SCENARIO, RunDirectory, file_hash
from drake_screw.runs.narration import describe
from drake_screw.runs.pictures import draw_round, draw_run
from drake_screw.scenario.loader import dump_scenario, load_scenario
from drake_screw.scenario.schema import Scenario
from drake_screw.typing import PathLike
from drake_screw.visualization.lifetime import scratch

Listener = Callable[[Event], None]
"""Is called with the events of a run, in their order."""


@dataclass(frozen=True)
class Run:
    """A run that can be carried out, or carried on.

    Attributes:
        setup: what its scenario describes.
        directory: where it is kept.
    """

    setup: Setup
    directory: RunDirectory

    def events(self, listeners: Sequence[Listener] = ()) -> Iterator[Event]:
        """Carry the run out from where its directory leaves off, or from the start.

        What the directory holds is not computed again but replayed, as the same events.
        Interrupting it leaves a directory that can be carried on.

        Args:
            listeners: each is called with every event, in this order, and with `RegionsEvaluated`
                for each batch of instances within a round, which is not yielded.

        Yields:
            Events; the last is `Finished`.

        Raises:
            RunDirectoryError: the run was begun with parts that were passed in from Python, and
                that it lacks now.
        """
        self._check_parts()

        def progress(event: RegionsEvaluated) -> None:
            for listener in listeners:
                listener(event)

        self.directory.save(status=Status.RUNNING.value, reason=None)
        try:
            for event in self._acquire(progress):
                self._record(event)
                for listener in listeners:
                    listener(event)
                yield event
        except BaseException as error:
            if self.directory.record["status"] == Status.RUNNING:
                interrupted = isinstance(error, KeyboardInterrupt | GeneratorExit)
                reason = "interrupted" if interrupted else f"{type(error).__name__}: {error}"
                self.directory.save(status=Status.INTERRUPTED.value, reason=reason)
                self._log(reason)
            raise

    def replay(self) -> Iterator[Event]:
        """Tell the stored events of a finished run again, and write nothing.

        Raises:
            RunDirectoryError: the run has not finished, or what is stored of it is not whole.
        """
        status = self.directory.record["status"]
        if status not in (Status.CERTIFIED, Status.INSUFFICIENT):
            raise RunDirectoryError(
                f"this run has not finished; its status is '{status}'",
                remedy=f"Finish it first: drake-screw run --resume {self.directory.path}",
                file=self.directory.path,
            )
        rounds = 0
        for event in self._acquire(None, told=True):
            rounds += isinstance(event, RoundFinished)
            if isinstance(event, Finished):
                if event.status != status or rounds != len(self.directory.record["rounds"]):
                    raise RunDirectoryError(
                        f"damaged: it ends as '{event.status}' after {rounds} rounds; run.json "
                        f"says '{status}' after {len(self.directory.record['rounds'])}",
                        remedy="Restore it, or run the scenario again.",
                        file=self.directory.path,
                    )
                event = replace(event, reason=self.directory.record["reason"])
            yield event

    def _check_parts(self) -> None:
        missing = set(self.directory.record.get("passed_in", ())) - set(self.setup.passed_in)
        if missing:
            parts = ", ".join(f"{name}=..." for name in sorted(missing))
            raise RunDirectoryError(
                f"this run was begun in Python with its own {' and '.join(sorted(missing))}",
                remedy=f"Carry it on from there: open_run(path, {parts}). Parts that the scenario "
                "names are found again by themselves.",
                file=self.directory.path,
            )

    def remembered(self, round: int) -> tuple[Evaluation, Verdict] | None:
        """What the directory knows of a round (from 0); None if it is not there.

        Raises:
            RunDirectoryError: it is damaged, or does not belong to the scenario beside it.
        """
        found = self.directory.remembered_round(round)
        if found is not None:
            evaluation, verdict = found
            K = evaluation.partition(self.setup.regions).K
            if len(verdict.samples) != K or (evaluation.region >= K).any():
                raise RunDirectoryError(
                    f"round {round + 1} does not fit the scenario beside it",
                    remedy="Restore the directory, or run the scenario again.",
                    file=self.directory.round_folder(round),
                )
        return found

    def _acquire(
        self, progress: Callable[[RegionsEvaluated], None] | None, *, told: bool = False
    ) -> Iterator[Event]:
        """The loop; where it is just `told` again, nobody is asked and nothing is evaluated."""
        setup, scenario = self.setup, self.setup.scenario
        evaluator = setup.evaluator(progress)

        def evaluate(
            round: int, demonstrations: tuple[Demonstration, ...], attempt: int
        ) -> tuple[Evaluation, Verdict]:
            remembered = self.remembered(round)
            if remembered is None:
                if told:
                    raise self._lacks(f"round {round + 1}")
                return evaluator.evaluate(round, demonstrations, attempt)
            if isinstance(evaluator, TreeEvaluator):
                evaluator.remember(remembered[0])
            return remembered

        initial = setup.initial
        if not isinstance(initial, int):
            if told and len(initial) > len(self.directory.record["demonstrations"]):
                raise self._lacks("the initial demonstrations")
            initial = tuple(
                self._kept(i, recording, "given in the scenario")
                for i, recording in enumerate(initial)
            )
        return acquire(
            evaluate,
            _KeptTeacher(self, told),
            setup.learn,
            setup.regions,
            initial=initial,
            budget=scenario.demonstrations.budget,
            seed=scenario.seed,
        )

    def _kept(self, number: int, recording: Recording, remark: str) -> Recording:
        """A recording as the run directory has it, where it is put first if it is new.

        What is learned from is always what the files say, so that a resumed run cannot differ.
        """
        if number >= len(self.directory.record["demonstrations"]):
            held = self.setup.scenario.robot.parked
            self.directory.add_demonstration(number, recording, remark, held)
        return self.stored(number)[0]

    def stored(self, number: int) -> tuple[Recording, str]:
        """A recording of the run directory, and what was remarked on it."""
        if number >= len(self.directory.record["demonstrations"]):
            raise self._lacks(f"demonstration {number + 1}")
        entry = self.directory.record["demonstrations"][number]
        recorder = self.setup.recorder_of(entry.get("robot"))
        stored = recorder.read(self.directory.path / entry["folder"])
        return replace(stored, name=entry["name"]), entry["remark"]

    def _record(self, event: Event) -> None:
        self._log(describe(event, self.setup.regions))
        if isinstance(event, RoundFinished):
            if event.round >= len(self.directory.record["rounds"]):
                self.directory.add_round(event, event.regions, draw_round(self.setup))
        elif isinstance(event, Finished):
            with scratch():
                draw_run(self.setup, self._rounds(), self.directory.path)
            self.directory.save(
                status=event.status.value,
                reason=event.reason,
                certificate=certificate(self.setup, event, self.directory.record["rounds"]),
                finished=datetime.now().astimezone().isoformat(timespec="seconds"),
            )

    def _rounds(self) -> list[RoundFinished]:
        """The run's rounds, told again from its directory."""
        return [e for e in self._acquire(None, told=True) if isinstance(e, RoundFinished)]

    def _lacks(self, what: str) -> RunDirectoryError:
        return RunDirectoryError(
            f"damaged: {what} is missing",
            remedy="Restore it, or run the scenario again.",
            file=self.directory.path,
        )

    def _log(self, text: str) -> None:
        stamp = datetime.now().astimezone().isoformat(timespec="seconds")
        with (self.directory.path / LOG).open("a") as log:
            log.writelines(f"{stamp} {line}\n" for line in text.splitlines())


@dataclass(frozen=True)
class _KeptTeacher:
    """Asks the scenario's teacher only what the run directory does not know yet."""

    run: Run
    told: bool

    def demonstrate(
        self,
        suggestion: Suggestion,
        *,
        number: int,
        used: tuple[Recording, ...],
        rng: np.random.Generator,
    ) -> Lesson:
        run = self.run
        if number < len(run.directory.record["demonstrations"]):
            return Lesson(*run.stored(number))
        if self.told:
            return Lesson(None, "the teacher had no more")
        lesson = run.setup.teacher.demonstrate(suggestion, number=number, used=used, rng=rng)
        if lesson.recording is None:
            return lesson
        return Lesson(run._kept(number, lesson.recording, lesson.remark), lesson.remark)


def new_run(scenario: Scenario, output: PathLike | None = None, **parts: Unpack[Parts]) -> Run:
    """Check a scenario to the bottom, then make its run directory.

    Args:
        scenario: to run.
        output: the directory, which must not exist or be empty; ``runs/NAME/TIME`` if None.
        parts: passed on to `Setup`.

    Raises:
        DrakeScrewError: anything it names cannot be used; nothing is written then.
    """
    setup = Setup(scenario, **parts)
    model = setup.workcell.model_file
    for part in (setup.strategy, setup.bandit, setup.teacher, setup.initial):
        assert part is not None
    facts = {
        "seed": scenario.seed,
        "strategy": setup.bandit.name,
        "beta": scenario.coverage.beta,
        "epsilon": scenario.coverage.epsilon,
        "delta": scenario.coverage.delta,
        "regions": setup.regions.K if setup.tree is None else "adaptive",
        "passed_in": list(setup.passed_in),
        "model": str(model),
        "hashes": {name: file_hash(file) for name, file in _models(setup).items()},
    }
    path = None if output is None else Path(output)
    return Run(setup, RunDirectory.create(path, scenario.name, dump_scenario(scenario), facts))


def open_run(path: PathLike, **parts: Unpack[Parts]) -> Run:
    """Open a run directory.

    Args:
        path: of the directory.
        parts: passed on to `Setup`; those the run was begun with, to carry it on.

    Raises:
        RunDirectoryError: it is not one, is damaged, or the robot model is not the same any more.
    """
    path = Path(path)
    directory = RunDirectory.open(path)
    try:
        setup = Setup(load_scenario(path / SCENARIO), **parts)
    except ScenarioError as error:
        missing = not (path / SCENARIO).is_file()
        raise RunDirectoryError(
            f"damaged: {'the file is missing' if missing else error.message}",
            remedy="Restore the scenario of this run, or run it again from the original.",
            file=path / SCENARIO,
            line=error.line,
        ) from error
    for name, model in _models(setup).items():
        if file_hash(model) != directory.record["hashes"].get(name):
            raise RunDirectoryError(
                f"the robot model {model} has changed since this run",
                remedy="Put the model back as it was, or run the scenario again.",
                file=path,
            )
    return Run(setup, directory)


def _models(setup: Setup) -> dict[str, Path]:
    """The model files that a run depends on."""
    other = setup.recorder.model_file
    return {"model": setup.workcell.model_file, **({} if other is None else {"recorded_on": other})}


def resumable(run: Run) -> Run:
    """The run itself, if there is something left of it to do.

    Raises:
        RunDirectoryError: it has ended.
    """
    status = run.directory.record["status"]
    if status in (Status.CERTIFIED, Status.INSUFFICIENT):
        raise RunDirectoryError(
            f"this run has ended ({status}); there is nothing to resume",
            remedy=f"See it with: drake-screw report {run.directory.path}",
            file=run.directory.path,
        )
    return run


def redraw(run: Run) -> list[RoundFinished]:
    """Draw all pictures of a finished run again; returns its rounds."""
    rounds = [e for e in run.replay() if isinstance(e, RoundFinished)]
    for event in rounds:
        draw_round(run.setup)(event, run.directory.round_folder(event.round) / "heat_map")
    with scratch():
        draw_run(run.setup, rounds, run.directory.path)
    return rounds
