"""Running a scenario: the acquisition loop, with its run directory as memory and listener."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Unpack

from numpy.typing import ArrayLike

from drake_screw.acquisition import (
    Event,
    Finished,
    InstancesExecuted,
    RegionsEvaluated,
    RoundFinished,
    Status,
)
from drake_screw.assembly.placing import PlaceLike
from drake_screw.assembly.ranked_plans import RankedPlan
from drake_screw.assembly.setup import Parts, Setup
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import RunDirectoryError, ScenarioError
from drake_screw.files import now
from drake_screw.holding import holding
from drake_screw.runs.begun_with import check_models, check_parts, check_ways_around, model_hashes
from drake_screw.runs.certificate import Certificate
from drake_screw.runs.certifying import certificate
from drake_screw.runs.codec import FORMAT
from drake_screw.runs.directory import PICTURE, SCENARIO, RunDirectory
from drake_screw.runs.html import certificate_html, run_html
from drake_screw.runs.kept_executions import KeptExecutions
from drake_screw.runs.mending import drop_damaged, find_damage
from drake_screw.runs.narration import describe
from drake_screw.runs.reader import RunReader
from drake_screw.runs.records import RunRecord
from drake_screw.runs.resuming import carry_on
from drake_screw.scenario.loader import dump_scenario, load_stored_scenario
from drake_screw.scenario.schema import Scenario
from drake_screw.typing import PathLike
from drake_screw.versions import versions

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

    @cached_property
    def reader(self) -> RunReader:
        """What the directory holds."""
        return RunReader(self.setup, self.directory)

    @property
    def demonstrations(self) -> tuple[Demonstration, ...]:
        """The demonstrations that the run has so far.

        Raises:
            RunDirectoryError: it has none.
            RecordingError: one cannot be read.
        """
        count = len(self.directory.record.demonstrations)
        if count == 0:
            raise RunDirectoryError(
                "this run has no demonstrations yet",
                remedy=f"Carry it on first: drake-screw run --resume {self.directory.path}",
                file=self.directory.path,
            )
        return self.reader.demonstrations(count)

    def plan(
        self,
        *,
        start: ArrayLike | Mapping[str, ArrayLike] | None = None,
        most: int = 5,
        **objects: PlaceLike,
    ) -> RankedPlan:
        """The best plan for a task instance with the run's demonstrations, in memory.

        Args:
            start: (n,) rad or m, where the arm is; the scenario's start if None. Of several arms as
                for `Setup.plan`.
            most: plans to return, the best one and its alternatives.
            objects: x, y in m and, where it varies, yaw in rad of each object, by its name:
                ``run.plan(bowl=(0.9, 0.1))``, or any axes, ``run.plan(bowl={"x": 0.9, ...})``.
                `Setup.plan` takes objects of any name.

        Raises:
            DrakeScrewError: the run has no demonstrations or cannot be read; the instance is not
                one; or there is no plan for it, and why.
        """
        return self.setup.plan(self.demonstrations, objects, start=start, most=most)

    @property
    def certificate(self) -> Certificate | None:
        """What the run states; None before its end."""
        return self.directory.record.certificate

    def events(self, listeners: Sequence[Listener] = ()) -> Iterator[Event]:
        """Carry the run out from where its directory leaves off, or from the start.

        What the directory holds is not computed again but replayed, as the same events.
        Interrupting it leaves a directory that can be carried on.

        Args:
            listeners: each is called with every event, in this order, and within a round with
                `RegionsEvaluated` and `InstancesExecuted`, which are not yielded.

        Yields:
            Events; the last is `Finished`.

        Raises:
            RunDirectoryError: another process is at work on the run; or it was begun with parts
                that were passed in from Python, and that it lacks now; or OMPL, which decides on
                plans, was there and is not, or the other way round.
        """
        with holding(self.directory.path, "run"):
            yield from self._carried_out(listeners)

    def _carried_out(self, listeners: Sequence[Listener]) -> Iterator[Event]:
        self.directory.refresh()
        drop_damaged(self.reader)
        check_parts(self.setup, self.directory)
        check_ways_around(self.setup, self.directory.record.led_around, "run", self.directory.path)

        def tell(event: Event | RegionsEvaluated | InstancesExecuted) -> None:
            for listener in listeners:
                listener(event)

        self.directory.save(status=Status.RUNNING, reason=None)
        try:
            for event in carry_on(self.reader, tell):
                self._record(event)
                tell(event)
                yield event
        except BaseException as error:
            if self.directory.record.status is Status.RUNNING:
                interrupted = isinstance(error, KeyboardInterrupt | GeneratorExit)
                reason = "interrupted" if interrupted else f"{type(error).__name__}: {error}"
                with suppress(RunDirectoryError):  # what ended it is what its user has to know
                    self.directory.save(status=Status.INTERRUPTED, reason=reason)
                    self.directory.log(reason)
            raise

    def replay(self) -> Iterator[Event]:
        """The stored events of a finished run; nothing is computed again, and nothing written.

        Raises:
            RunDirectoryError: the run has not finished, or what is stored of it is not whole.
        """
        if not self.directory.record.ended:
            raise RunDirectoryError(
                f"this run has not finished; its status is '{self.directory.record.status}'",
                remedy=f"Finish it first: drake-screw run --resume {self.directory.path}",
                file=self.directory.path,
            )
        yield from self.reader.events()

    def _record(self, event: Event) -> None:
        self.directory.log(describe(event, self.setup.regions))
        if isinstance(event, RoundFinished):
            if event.round >= self.reader.rounds:
                from drake_screw.runs.pictures import draw_round  # takes long to import

                self.directory.add_round(event, lambda e, stem: draw_round(self.setup, e, stem))
                KeptExecutions(self.directory.path).forget()
        elif isinstance(event, Finished):
            from drake_screw.runs.redrawing import draw_all

            draw_all(self.reader)
            rounds = self.directory.record.rounds
            self.directory.save(
                status=event.status,
                reason=event.reason,
                certificate=certificate(
                    self.setup,
                    event,
                    attempt=1 + sum(entry.verdict.attempted for entry in rounds[:-1]),
                    instances=sum(sum(entry.samples) for entry in rounds),
                    led_around=self.directory.record.led_around,
                ),
                finished=now(),
            )

    def _repr_html_(self) -> str:
        record, picture = self.directory.record, self.directory.path / PICTURE
        stated = record.certificate
        facts = (
            ("scenario", record.scenario),
            ("status", ": ".join(filter(None, (record.status, record.reason)))),
            ("demonstrations", len(record.demonstrations)),
            ("rounds", len(record.rounds)),
            ("directory", self.directory.path),
        )
        return run_html(
            facts,
            "" if stated is None else certificate_html(stated.certified, stated.statement),
            picture if record.ended and picture.is_file() else None,
        )


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
    for part in (setup.strategy, setup.bandit, setup.teacher, setup.ask, setup.initial):
        assert part is not None
    _ = setup.executing
    goal = scenario.coverage
    record = RunRecord(
        format=FORMAT,
        scenario=scenario.name,
        status=Status.RUNNING,
        reason=None,
        seed=scenario.seed,
        strategy=setup.bandit.name,
        beta=goal.beta,
        epsilon=goal.epsilon,
        delta=goal.delta,
        regions=setup.regions.K if setup.tree is None else "adaptive",
        passed_in=setup.passed_in,
        led_around=setup.leads_around,
        model=str(setup.workcell.model_file),
        hashes=model_hashes(setup),
        versions=versions(),
        started=now(),
        finished=None,
        certificate=None,
        demonstrations=(),
        rounds=(),
    )
    path = None if output is None else Path(output)
    return Run(setup, RunDirectory.create(path, dump_scenario(scenario), record))


def open_run(path: PathLike, **parts: Unpack[Parts]) -> Run:
    """Open a run directory.

    Args:
        path: of the directory.
        parts: passed on to `Setup`; those the run was begun with, to carry it on.

    Raises:
        RunDirectoryError: it is not one, is damaged, or a model or mesh is not the same any more.
    """
    path = Path(path)
    directory = RunDirectory.open(path)
    try:
        setup = Setup(load_stored_scenario(path / SCENARIO), **parts)
    except ScenarioError as error:
        why = error.message if (path / SCENARIO).is_file() else "the file is missing"
        raise RunDirectoryError(
            f"damaged: {why}",
            remedy="Restore the scenario of this run, or run it again from the original.",
            file=path / SCENARIO,
            line=error.line,
        ) from error
    check_models(setup, directory)
    return Run(setup, directory)


def resumable(run: Run) -> Run:
    """The run itself, if there is something left of it to do.

    Raises:
        RunDirectoryError: it has ended, and all of it can be read.
    """
    record, path = run.directory.record, run.directory.path
    if record.ended and find_damage(run.reader) is None:
        raise RunDirectoryError(
            f"this run has ended ({record.status}); there is nothing to resume",
            remedy=f"See it with: drake-screw report {path}",
            file=path,
        )
    return run
