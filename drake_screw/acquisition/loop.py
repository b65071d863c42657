"""The self-evaluation loop: evaluate, ask for a demonstration where it is needed, repeat.

It is Algorithm 1 of Das et al. (arXiv 2410.18275) with any strategy in the place of Algorithm 2,
written as a generator of events: progress bars, files and Meshcat are listeners, and unknown here.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from drake_screw.acquisition.asking import AskingRule, earliest
from drake_screw.acquisition.events import (
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
from drake_screw.acquisition.suggestion import initial_suggestions, suggest
from drake_screw.acquisition.teacher import Teacher
from drake_screw.bandits import Verdict
from drake_screw.demonstrations import Demonstration, Recording
from drake_screw.errors import counted
from drake_screw.tasks import Regions
from drake_screw.typing import Array

Evaluate = Callable[[int, tuple[Demonstration, ...], int], tuple[Evaluation, Verdict]]
"""(round, demonstrations, attempt) to what was seen and what it shows; see `Evaluator.evaluate`."""

TRIES = 3
"""Failed instances a teacher is asked about before a run gives up."""

# Apart from every (round, region, chunk) of the task instances:
_TIES, _LESSON, _PLACE = 2**31, 2**31 + 1, 2**31 + 2


class _Acquired(NamedTuple):
    recordings: tuple[Recording, ...]
    demonstrations: tuple[Demonstration, ...]


def acquire(
    evaluate: Evaluate,
    teacher: Teacher,
    learn: Callable[[Recording], Demonstration],
    regions: Regions,
    *,
    initial: int | Sequence[Recording],
    budget: int,
    seed: int,
    ask: AskingRule = earliest,
    first: Array | None = None,
) -> Iterator[Event]:
    """Acquire demonstrations until every region is covered, or as far as it goes.

    Args:
        evaluate: one round of self-evaluation.
        teacher: gives demonstrations.
        learn: turns a recording into a demonstration.
        regions: the bandit's arms; where they refine themselves, what they start from.
        initial: recordings to start from, or how many to ask for before the first round.
        budget: most demonstrations in total.
        seed: of the run; with the arguments it determines everything.
        ask: chooses the failed instance at which the next one is asked for.
        first: (k, c) where the first of the initial ones is asked for, as of `first_place`; None,
            and for the others, at random.

    Yields:
        Events; the last is `Finished`.
    """
    acquired = _Acquired((), ())
    if isinstance(initial, int):
        for number in range(initial):
            places = initial_places(regions, seed, number, first)
            added, remark = yield from _ask(teacher, learn, acquired, 0, places, seed)
            if added is None:
                yield _finished(f"no initial demonstration: {remark}", None, acquired)
                return
            acquired = added
    else:
        recordings = tuple(initial)
        acquired = _Acquired(recordings, tuple(learn(r) for r in recordings))
    attempt = 1
    for round in range(budget + 1):
        yield RoundStarted(round, acquired.demonstrations)
        evaluation, verdict = evaluate(round, acquired.demonstrations, attempt)
        attempt += verdict.attempted
        here = evaluation.partition(regions)
        ties = _rng(seed, round, _TIES)
        places = (
            ()
            if verdict.certified
            else suggest(evaluation, verdict.region, here, ties, rule=ask, count=TRIES)
        )
        yield RoundFinished(
            round,
            acquired.demonstrations,
            evaluation,
            verdict,
            places[0] if places else None,
            here,
        )
        if verdict.certified:
            yield Finished(Status.CERTIFIED, verdict.reason, verdict, acquired.demonstrations)
            return
        if len(acquired.demonstrations) >= budget:
            reason = f"the budget of {counted(budget, 'demonstration')} is used up"
            yield _finished(reason, verdict, acquired)
            return
        added, remark = yield from _ask(teacher, learn, acquired, round + 1, places, seed)
        if added is None:
            yield _finished(remark, verdict, acquired)
            return
        acquired = added


def initial_places(
    regions: Regions, seed: int, number: int, first: Array | None
) -> tuple[Suggestion, ...]:
    """Where initial demonstration `number`, from 0, is asked for, one place after the other."""
    return initial_suggestions(regions, _rng(seed, number, _PLACE), number, first)


def _ask(
    teacher: Teacher,
    learn: Callable[[Recording], Demonstration],
    acquired: _Acquired,
    round: int,
    places: Sequence[Suggestion],
    seed: int,
) -> Generator[Event, None, tuple[_Acquired | None, str]]:
    """Ask the teacher at one place after the other; the generator's value is (acquired, remark)."""
    number, remark = len(acquired.recordings), "there is no failed instance to demonstrate"
    for i, place in enumerate(places):
        yield DemonstrationRequested(round, number, place)
        lesson = teacher.demonstrate(
            place, number=number, used=acquired.recordings, rng=_rng(seed, number, _LESSON, i)
        )
        remark = lesson.remark
        if lesson.recording is not None:
            demonstration = learn(lesson.recording)
            yield DemonstrationAdded(round, number, lesson.recording, demonstration, remark)
            return (
                _Acquired(
                    (*acquired.recordings, lesson.recording),
                    (*acquired.demonstrations, demonstration),
                ),
                remark,
            )
    return None, remark


def _finished(reason: str, verdict: Verdict | None, acquired: _Acquired) -> Finished:
    return Finished(Status.INSUFFICIENT, reason, verdict, acquired.demonstrations)


def _rng(seed: int, *key: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))
