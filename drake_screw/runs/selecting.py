"""The smallest set of recordings in hand that suffices: chosen on a table, certified afresh."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Unpack

from drake_screw.acquisition import Finished, Status, TreeEvaluator
from drake_screw.acquisition.cover import smallest_cover
from drake_screw.acquisition.cover_table import Chosen, CoverTable
from drake_screw.assembly.setup import Parts, Setup
from drake_screw.bandits import Verdict
from drake_screw.demonstrations import Demonstration, NoMotionKept
from drake_screw.errors import DrakeScrewError, RecordingError
from drake_screw.runs.certifying import certificate
from drake_screw.runs.codec import plain
from drake_screw.runs.selection import Attempt, PassedOver, Selection, TableSummary
from drake_screw.runs.selection_events import Listener, Tried
from drake_screw.runs.selection_margins import Margins, certified_rates, short_rates
from drake_screw.runs.selection_table import ROUND, Asked, GrowingTable
from drake_screw.scenario.schema import Scenario
from drake_screw.steps import Step
from drake_screw.tasks import Regions
from drake_screw.typing import PathLike

INSTANCES = 400
"""In each region of the first table, if nothing else is asked for."""

TABLE = 6_400
"""In all regions of it together, unless that were less than `LEAST` in each."""

LEAST = 25

LOOKS = 6
"""Tables that are looked at, each with twice the instances of the one before; in each of them one
set at most is found and tried."""


def select(
    scenario: Scenario,
    demonstrations: PathLike,
    *,
    instances: int | None = None,
    listener: Listener | None = None,
    **parts: Unpack[Parts],
) -> Selection:
    """Find the smallest set of recordings that suffices for a scenario, and certify it.

    Sets are compared on a table of instances, planned with all recordings. The best of the smallest
    that solve enough of it is then certified as in a run: on fresh instances, by the scenario's
    strategy. If that fails, the table is doubled, and the next set has to have a recording that
    those tried did not have; the attempts share delta as the rounds of a run do.

    Args:
        scenario: says what is enough.
        demonstrations: a folder of recordings.
        instances: in each region of the first table; if None `INSTANCES`, and fewer where there
            are so many regions that these were more than `TABLE`.
        listener: called with what happens, as it happens.
        parts: passed on to `Setup`.

    Raises:
        DrakeScrewError: something that cannot be used, or nothing is learned from any recording.
    """
    began = time.perf_counter()
    if instances is not None and instances < 1:
        raise DrakeScrewError(f"{instances} instances a region", remedy="Give at least 1.")
    tell: Listener = listener or (lambda event: None)
    setup, source = Setup(scenario, **parts), Path(demonstrations)
    assert setup.bandit is not None
    library = _learned(setup, source, tell)
    asked = Asked.of(setup)
    each = instances or instances_in_each(asked.regions.K)
    growing = GrowingTable(setup, library.demonstrations, asked.regions, each, tell)
    trials = _Trials(setup, library.demonstrations, tell)
    end = _choose(asked, growing, trials, tell)
    tell(Step("comparing with other sets"))
    chosen = trials.sets[-1] if trials.sets else ()
    margins = Margins(end.table, asked, library.names, chosen, trials.sets, growing.looks)
    stated = certificate(
        setup,
        Finished(
            Status.CERTIFIED if end.certified else Status.INSUFFICIENT,
            end.reason,
            trials.verdict,
            trials.in_hand if chosen else library.demonstrations,
        ),
        attempt=trials.attempt_of_last,
        instances=sum(attempt.instances for attempt in trials.attempts),
        led_around=setup.leads_around,
    )
    return Selection(
        scenario=scenario.name,
        seed=scenario.seed,
        source=source,
        status=(Status.CERTIFIED if end.certified else Status.INSUFFICIENT).value,
        reason=end.reason,
        chosen=tuple(library.names[d] for d in chosen),
        folders=tuple(library.folders[d] for d in chosen),
        smallest=end.smallest,
        certificate=plain(stated),
        statement=stated.statement,
        on_table=margins.chosen,
        fewer=margins.fewer,
        fewer_ruled_out=margins.fewer_ruled_out(setup.goal.delta),
        runner_up=margins.runner_up,
        table=TableSummary(
            regions=asked.regions.K,
            instances_per_region=growing.each,
            success_asked=1.0 - asked.q,
            success_needed=1.0 - asked.tau,
            relaxed=int(asked.relaxed(end.table).sum()),
        ),
        recordings=margins.recordings(),
        passed_over=library.passed_over,
        regions=certified_rates(trials.verdict, trials.regions),
        short=short_rates(end.table, asked),
        attempts=tuple(trials.attempts),
        confidence=1.0 - setup.goal.delta,
        seconds=time.perf_counter() - began,
    )


def instances_in_each(K: int) -> int:
    """How many instances the first table has in each of K regions if nothing else is asked for.

    >>> [instances_in_each(K) for K in (1, 16, 64, 1024)]
    [400, 400, 100, 25]
    """
    return min(INSTANCES, max(LEAST, TABLE // K))


@dataclass(frozen=True, eq=False)
class _Library:
    """Recordings and what was learned of them, those passed over left out."""

    demonstrations: tuple[Demonstration, ...]
    folders: tuple[Path, ...]
    passed_over: tuple[PassedOver, ...]

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(d.name for d in self.demonstrations)


@dataclass(frozen=True, eq=False)
class _End:
    """How the search for a set ended, and the table as it was then."""

    certified: bool
    reason: str
    table: CoverTable
    smallest: bool = False


class _Trials:
    """Certifies one set after another.

    Attributes:
        setup: of the scenario.
        sets: tried, by number of the recordings.
        attempts: what became of each.
        verdict, regions, in_hand: the last one's, its regions, and the demonstrations it is of.
        attempt_of_last: as in `Strategy.decide`.
    """

    def __init__(
        self, setup: Setup, demonstrations: Sequence[Demonstration], tell: Listener
    ) -> None:
        self.sets: list[Chosen] = []
        self.attempts: list[Attempt] = []
        self.verdict: Verdict | None = None
        self.regions: Regions = setup.regions
        self.in_hand: tuple[Demonstration, ...] = ()
        self.attempt_of_last = 1
        self.setup = setup
        self._all = demonstrations
        self._tell = tell
        self._evaluator = setup.evaluator(tell)

    def certify(self, chosen: Chosen) -> Verdict:
        """Try to certify a set, on instances of its own."""
        if self.verdict is not None:
            self.attempt_of_last += self.verdict.attempted
        if isinstance(self._evaluator, TreeEvaluator):
            self._evaluator.start_over()
        self.sets.append(chosen)
        self.in_hand = tuple(self._all[d] for d in chosen)
        names, number = tuple(d.name for d in self.in_hand), len(self.sets)
        self._tell(Step(f"attempt {number}: certifying {', '.join(names)}"))
        evaluation, verdict = self._evaluator.evaluate(
            ROUND + number, self.in_hand, self.attempt_of_last
        )
        self.verdict, self.regions = verdict, evaluation.partition(self.setup.regions)
        tried = Attempt(names, len(evaluation.region), verdict.certified, verdict.reason)
        self.attempts.append(tried)
        self._tell(Tried(number, tried, verdict, self.regions))
        return verdict


def _learned(setup: Setup, source: Path, tell: Listener) -> _Library:
    recordings = setup.recordings(source)
    learned, folders, passed_over = [], [], []
    for i, recording in enumerate(recordings):
        tell(Step(f"learning from {source}", i, len(recordings)))
        try:
            learned.append(setup.learn(recording))
        except NoMotionKept as error:
            passed_over.append(PassedOver(recording.name, error.message))
        else:
            folders.append(recording.source or (source / recording.name).resolve())
    if not learned:
        first = passed_over[0]
        raise RecordingError(
            f"no recording here of which a motion is kept; {first.name}: {first.reason}",
            remedy=f"See each of them with: drake-screw look {source}",
            file=source,
        )
    return _Library(tuple(learned), tuple(folders), tuple(passed_over))


def _choose(asked: Asked, growing: GrowingTable, trials: _Trials, tell: Listener) -> _End:
    """Try one set after another, until one is certified or none is left to try."""
    delta, smallest = trials.setup.goal.delta, False
    while True:
        table = growing.grown()
        short, last = len(asked.short(table)), growing.looks == LOOKS
        if short and (last or asked.surely_short(table, delta)):
            everything = "all recordings together fail" if table.D > 1 else "the recording fails"
            reason = (
                f"{everything} more than {asked.tau:.4g} of the time in {short} of {table.K} "
                f"regions, on a table of {growing.each:,} instances in each"
            )
            return _End(False, reason, table)
        if not short:
            tell(Step("looking for the smallest set"))
            cover = smallest_cover(table, asked.allowed(table), beyond=trials.sets)
            if cover is None:
                return _End(False, "all recordings together were tried, and not certified", table)
            smallest = cover.smallest
            verdict = trials.certify(cover.chosen)
            if verdict.certified:
                return _End(True, verdict.reason, table, smallest)
        if last:
            reason = f"{len(trials.sets)} sets were tried, and none was certified"
            return _End(False, reason, table, smallest)
