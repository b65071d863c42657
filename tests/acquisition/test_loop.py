from __future__ import annotations

import numpy as np
import pytest

from drake_screw.acquisition import (
    DemonstrationAdded,
    DemonstrationRequested,
    Finished,
    Lesson,
    RoundFinished,
    RoundStarted,
    Status,
    acquire,
)
from drake_screw.acquisition.asking import densest, densest_anywhere
from drake_screw.bandits import Goal, make_strategy
from tests.acquisition.conftest import Disks, Obliging, learn, recording_at


def run(disks, teacher, **options):
    options = {"initial": 1, "budget": 20, "seed": 0} | options
    return list(acquire(disks.evaluate, teacher, learn, disks.regions, **options))


def test_asks_until_every_region_is_covered(disks) -> None:
    events = run(disks, Obliging())
    end = events[-1]
    assert isinstance(end, Finished)
    assert end.status is Status.CERTIFIED
    assert end.verdict.estimates.max() <= 1 - 0.2 - 0.7
    rounds = [e for e in events if isinstance(e, RoundFinished)]
    assert len(rounds) > 1
    assert all(not r.verdict.certified for r in rounds[:-1])
    assert [len(r.demonstrations) for r in rounds] == list(range(1, len(rounds) + 1))


def test_the_order_of_events(disks) -> None:
    kinds = [type(e) for e in run(disks, Obliging())]
    assert kinds[:3] == [DemonstrationRequested, DemonstrationAdded, RoundStarted]
    body, end = kinds[2:-1], kinds[-1]
    cycle = [RoundStarted, RoundFinished, DemonstrationRequested, DemonstrationAdded]
    assert body == (cycle * len(body))[: len(body)]
    assert body[-1] is RoundFinished
    assert end is Finished


def test_suggestions_fail_lie_in_the_weakest_region_and_failed_earliest(disks) -> None:
    for event in run(disks, Obliging()):
        if not isinstance(event, RoundFinished) or event.suggestion is None:
            continue
        place = event.suggestion.coordinates
        assert event.suggestion.region == event.verdict.region
        assert disks.regions.index(place) == event.verdict.region
        assert not disks.solves(place[None], event.demonstrations).any()
        seen, region = event.evaluation, event.verdict.region
        mine = seen.failed & (seen.region == region)
        assert event.suggestion.segment == seen.outcomes[mine].furthest_segment.min()


@pytest.mark.parametrize("rule", [densest, densest_anywhere])
def test_with_another_rule_a_run_ends_covered_and_asks_where_it_fails(rule) -> None:
    away = []
    for seed in range(4):
        disks = Disks(radius=0.3, seed=seed)
        events = run(disks, Obliging(), ask=rule, seed=seed)
        assert events[-1].status is Status.CERTIFIED
        asked = [e for e in events if isinstance(e, RoundFinished) and e.suggestion is not None]
        away += [e.suggestion.region != e.verdict.region for e in asked]
        for event in asked:
            place = event.suggestion.coordinates
            assert disks.regions.index(place) == event.suggestion.region
            assert not disks.solves(place[None], event.demonstrations).any()
            assert not disks.solves(event.suggestion.failing, event.demonstrations).any()
        assert trace(events) == trace(run(disks, Obliging(), ask=rule, seed=seed))
    assert any(away) == (rule is densest_anywhere)


def test_a_rule_that_finds_nothing_to_ask_for_ends_the_run(disks) -> None:
    end = run(disks, Obliging(), ask=lambda evaluation, region, regions, rng: [])[-1]
    assert end.status is Status.INSUFFICIENT
    assert end.reason == "there is no failed instance to demonstrate"
    assert len(end.demonstrations) == 1


def test_the_first_demonstration_is_asked_for_in_the_middle_if_wanted(disks) -> None:
    teacher = Obliging()
    run(disks, teacher, initial=3, first=np.array([[0.5, 0.5, np.nan]]))
    places = [place.coordinates.tolist() for place in teacher.asked]
    assert places[0] == [[0.5, 0.5, 0.0]]
    at_random = Obliging()
    run(disks, at_random, initial=3)
    assert at_random.asked[0].coordinates.tolist() != places[0]
    assert [place.coordinates.tolist() for place in at_random.asked[1:3]] == places[1:3]


class ShortArm(Obliging):
    """Cannot be led to the first place asked for."""

    def demonstrate(self, suggestion, *, number, used, rng):
        lesson = super().demonstrate(suggestion, number=number, used=used, rng=rng)
        return Lesson(None, "out of reach") if len(self.asked) == 1 else lesson


def test_where_the_first_place_is_out_of_reach_a_random_one_is_asked_for(disks) -> None:
    teacher, at_random = ShortArm(), Obliging()
    events = run(disks, teacher, first=np.array([[1.0, 1.0, np.nan]]))
    run(disks, at_random)
    assert events[-1].status is Status.CERTIFIED
    assert teacher.asked[0].coordinates.tolist() == [[1.0, 1.0, 0.0]]
    assert teacher.asked[1].coordinates.tolist() == at_random.asked[0].coordinates.tolist()
    kinds = [type(event) for event in events[:3]]
    assert kinds == [DemonstrationRequested, DemonstrationRequested, DemonstrationAdded]
    end = run(disks, ShortArm())[-1]
    assert end.reason == "no initial demonstration: out of reach"


def test_a_budget_ends_the_run_with_what_was_shown() -> None:
    disks = Disks(radius=0.2)
    end = run(disks, Obliging(), budget=3)[-1]
    assert end.status is Status.INSUFFICIENT
    assert len(end.demonstrations) == 3
    assert "budget of 3" in end.reason
    assert end.verdict.coverage == max(0.0, 1 - 0.2 - end.verdict.estimates.max())


def test_a_teacher_without_an_answer_ends_the_run() -> None:
    disks, teacher = Disks(radius=0.2), Obliging(most=2)
    end = run(disks, teacher)[-1]
    assert end.status is Status.INSUFFICIENT
    assert end.reason == "no more"
    refused = teacher.asked[2:]
    assert len(refused) == 3, "other failed instances are tried before giving up"
    assert len({tuple(s.coordinates[0]) for s in refused}) == 3


def test_a_teacher_who_cannot_begin_ends_the_run_before_any_round(disks) -> None:
    events = run(disks, Obliging(most=0))
    assert not any(isinstance(e, RoundStarted) for e in events)
    assert events[-1].status is Status.INSUFFICIENT
    assert events[-1].verdict is None


def test_initial_recordings_can_be_given(disks) -> None:
    given = [recording_at("a", 0.2, 0.2), recording_at("b", 0.8, 0.8)]
    events = run(disks, Obliging(), initial=given)
    assert isinstance(events[0], RoundStarted)
    assert [d.name for d in events[0].demonstrations] == ["a", "b"]


def test_a_run_can_begin_with_nothing(disks) -> None:
    first = next(e for e in run(disks, Obliging(), initial=0) if isinstance(e, RoundFinished))
    assert (first.verdict.estimates == 1.0).all()
    assert first.suggestion.segment is None


def trace(events):
    return [
        (
            r.verdict.failures.tolist(),
            None if r.suggestion is None else r.suggestion.coordinates.tolist(),
        )
        for r in events
        if isinstance(r, RoundFinished)
    ]


def test_a_run_is_a_function_of_its_seed(disks) -> None:
    again = Disks(radius=0.45)
    assert trace(run(disks, Obliging())) == trace(run(again, Obliging()))
    other = Disks(radius=0.45, seed=1)
    assert trace(run(other, Obliging(), seed=1)) != trace(run(again, Obliging()))


def test_every_round_has_fresh_instances(disks) -> None:
    rounds = [
        e.evaluation.coordinates for e in run(disks, Obliging()) if isinstance(e, RoundFinished)
    ]
    assert len(rounds) >= 2
    assert not np.intersect1d(rounds[0].ravel(), rounds[1][..., :2].ravel()).size > 1


def test_attempts_count_the_rounds_that_could_have_passed() -> None:
    disks = Disks(radius=0.2)
    disks.strategy = make_strategy("eprocess", Goal(0.7, 0.2, 0.1))
    events = run(disks, Obliging(), budget=4)
    rounds = [e for e in events if isinstance(e, RoundFinished)]
    expected = 1 + np.cumsum([0] + [r.verdict.attempted for r in rounds])
    assert [attempt for _, attempt in disks.log] == expected[: len(rounds)].tolist()


@pytest.mark.parametrize("seed", range(3))
def test_teachers_get_random_numbers_of_their_own(seed) -> None:
    draws = []

    class Drawing(Obliging):
        def demonstrate(self, suggestion, *, number, used, rng):
            draws.append(rng.random())
            return super().demonstrate(suggestion, number=number, used=used, rng=rng)

    run(Disks(radius=0.3), Drawing(), seed=seed, budget=5)
    assert len(set(draws)) == len(draws)


def test_a_second_place_is_asked_for_with_other_random_numbers() -> None:
    """A teacher that fails by bad luck must not fail by the same luck again."""
    draws: dict[int, list[float]] = {}

    class Unlucky(Obliging):
        def demonstrate(self, suggestion, *, number, used, rng):
            draws.setdefault(number, []).append(rng.random())
            if len(draws[number]) < 3 and number > 0:
                return Lesson(None, "missed")
            return super().demonstrate(suggestion, number=number, used=used, rng=rng)

    run(Disks(radius=0.3), Unlucky(), budget=3)
    assert [len(draws[number]) for number in sorted(draws)] == [1, 3, 3]
    assert len({value for values in draws.values() for value in values}) == 7
