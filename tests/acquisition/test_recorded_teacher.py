from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest

from drake_screw.acquisition import RecordedTeacher, Suggestion
from drake_screw.tasks import grid_regions
from tests.acquisition.conftest import Disks, recording_at

LIBRARY = (
    recording_at("near", 0.6, 0.2),
    recording_at("far", 0.9, 0.1),
    recording_at("elsewhere", 0.45, 0.2),
)


@pytest.fixture
def teacher():
    return RecordedTeacher(LIBRARY, Disks(radius=1.0).regions)


def ask(teacher, x, y, used=()):
    place = np.array([[x, y, 0.0]])
    suggestion = Suggestion(int(teacher.regions.index(place)), place)
    return teacher.demonstrate(
        suggestion, number=len(used), used=used, rng=np.random.default_rng(0)
    )


def test_the_nearest_of_the_region_comes_first_even_if_another_region_has_a_nearer_one(
    teacher,
) -> None:
    lesson = ask(teacher, 0.51, 0.2)
    assert lesson.recording.name == "near"
    assert "nearest unused recording of region 1" in lesson.remark
    assert "9 cm" in lesson.remark


def test_used_recordings_are_not_given_again(teacher) -> None:
    assert ask(teacher, 0.51, 0.2, used=(LIBRARY[0],)).recording.name == "far"


def test_another_region_helps_out_and_it_says_so(teacher) -> None:
    lesson = ask(teacher, 0.51, 0.2, used=LIBRARY[:2])
    assert lesson.recording.name == "elsewhere"
    assert "no unused recording" in lesson.remark


def test_it_says_when_it_has_none_left(teacher) -> None:
    lesson = ask(teacher, 0.5, 0.2, used=LIBRARY)
    assert lesson.recording is None
    assert lesson.remark == "all 3 recordings are used"


def test_a_request_may_bring_its_own_regions(teacher) -> None:
    place = np.array([[0.51, 0.2, 0.0]])
    whole = grid_regions(teacher.regions.area, {})
    suggestion = Suggestion(0, place, regions=whole)
    lesson = teacher.demonstrate(suggestion, number=0, used=(), rng=np.random.default_rng(0))
    assert lesson.recording.name == "elsewhere"
    assert "nearest unused recording of region 0" in lesson.remark


class Elsewhere:
    """Of another robot, whose world is shifted by 0.3 m; named recordings work."""

    def __init__(self, *working: str) -> None:
        self.working = working

    def seen(self, recording):
        X_WO = recording.X_WO.copy()
        X_WO[:, 0, 3] += 0.3
        return X_WO

    def works(self, recordings, coordinates):
        named = [recording.name in self.working for recording in recordings]
        return np.tile(named, (len(coordinates), 1))


def test_of_another_robots_recordings_those_that_work_come_first(teacher) -> None:
    foreign = replace(teacher, foreign=Elsewhere("far", "elsewhere"))
    lesson = ask(foreign, 0.6, 0.2)
    assert lesson.recording.name == "elsewhere"
    assert lesson.remark == (
        "of the unused recordings that work there, the nearest, 15 cm from the suggestion"
    )
    assert ask(foreign, 0.6, 0.2, used=LIBRARY[2:]).recording.name == "far"


def test_where_none_works_the_nearest_is_given_though_it_stood_outside_the_work_area(
    teacher,
) -> None:
    lesson = ask(replace(teacher, foreign=Elsewhere()), 0.99, 0.1)
    assert lesson.recording.name == "near"
    assert "no unused recording works there" in lesson.remark
    assert not teacher.regions.area.contains([[1.2, 0.1, 0.0]])
    assert ask(replace(teacher, foreign=Elsewhere("far")), 0.99, 0.1).recording.name == "far"


class Strips:
    """Each recording works where x is in a strip of its own."""

    strips: ClassVar = {"near": (0.0, 0.3), "far": (0.3, 1.0), "elsewhere": (0.5, 1.0)}

    def seen(self, recording):
        return recording.X_WO

    def works(self, recordings, coordinates):
        lower, upper = np.array([self.strips[r.name] for r in recordings]).reshape(-1, 2).T
        x = coordinates[:, 0, 0, None]
        return (lower <= x) & (x < upper)


def failing(*x: float) -> np.ndarray:
    return np.array([[[each, 0.5, 0.0]] for each in x]).reshape(-1, 1, 3)


@pytest.fixture
def covering(teacher):
    return replace(teacher, covering=Strips())


def ask_for(teacher, x, used=(), *, at=(0.51, 0.2)):
    place = np.array([[*at, 0.0]])
    suggestion = Suggestion(int(teacher.regions.index(place)), place, failing=x)
    return teacher.demonstrate(
        suggestion, number=len(used), used=used, rng=np.random.default_rng(0)
    )


def test_the_recording_that_solves_most_of_what_fails_is_given_wherever_it_is(covering) -> None:
    lesson = ask_for(covering, failing(0.1, 0.2, 0.4, 0.6, 0.8))
    assert lesson.recording.name == "far"
    assert lesson.remark == (
        "the unused recording that solves most of what fails, 60% of it; 40 cm from the suggestion"
    )
    assert ask_for(covering, failing(0.1, 0.2, 0.6)).recording.name == "near"


def test_of_recordings_that_solve_as_much_the_nearest_is_given(covering) -> None:
    lesson = ask_for(covering, failing(0.6, 0.8), at=(0.51, 0.2))
    assert lesson.recording.name == "elsewhere"
    assert ask_for(covering, failing(0.6, 0.8), at=(0.95, 0.1)).recording.name == "far"


def test_what_used_recordings_solve_does_not_count(covering) -> None:
    """As at the second of several initial demonstrations, before anything is evaluated."""
    everywhere = failing(0.1, 0.2, 0.4, 0.6, 0.8)
    lesson = ask_for(covering, everywhere, used=(LIBRARY[1],))
    assert lesson.recording.name == "near"
    assert "100%" in lesson.remark


@pytest.mark.parametrize("what", [None, failing(), failing(2.0)])
def test_where_nothing_is_to_be_gained_the_nearest_of_the_region_is_given(covering, what) -> None:
    lesson = ask_for(covering, what)
    assert lesson.recording.name == "near"
    assert "nearest unused recording of region 1" in lesson.remark
