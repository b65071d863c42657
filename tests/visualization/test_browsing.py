from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drake_screw.planning import Outcomes
from drake_screw.visualization.browsing import SUCCESSES, Catalogue, catalogue

FAILURES = [0, 3, 10, 5, 0, 1]
PLANE = (0, 0), (0, 1)


@pytest.fixture
def book(make_round, regions) -> Catalogue:
    event = make_round(regions, FAILURES)
    segment = event.evaluation.outcomes.segment.copy()
    failed = np.flatnonzero(event.evaluation.failed)
    segment[failed[::2]] = 0
    segment[failed[::3], 1] = 2
    o = event.evaluation.outcomes
    outcomes = Outcomes(o.cause, segment, o.joint, o.fraction, o.variant)
    event = replace(event, evaluation=replace(event.evaluation, outcomes=outcomes))
    return catalogue(event, event.evaluation.region, PLANE)


def test_failing_instances_come_first_the_earliest_before_the_others(book) -> None:
    assert book.failing == sum(FAILURES)
    evaluation = book.event.evaluation
    assert evaluation.failed[book.instance[: book.failing]].all()
    assert not evaluation.failed[book.instance[book.failing :]].any()
    furthest = evaluation.outcomes[book.instance[: book.failing]].furthest_segment
    assert (np.diff(furthest) >= 0).all()
    assert len(set(furthest.tolist())) == 3


def test_of_a_region_only_its_own(book) -> None:
    for region, failures in enumerate(FAILURES):
        places = book.of_region(region)
        assert (book.event.evaluation.region[book.instance[places]] == region).all()
        assert np.count_nonzero(places < book.failing) == failures
    assert len(book.of_region(None)) == len(book.instance)


def test_many_successes_are_thinned_and_failures_are_not(make_round, regions) -> None:
    event = make_round(regions, [700, 0, 0, 0, 0, 0], each=1000)
    book = catalogue(event, event.evaluation.region, PLANE)
    assert book.failing == 700
    assert len(book.instance) == 700 + SUCCESSES


def test_the_nearest_on_the_map_prefers_those_that_fail(book) -> None:
    p = book.event.evaluation.coordinates[book.instance, 0, :2]
    for place in (0, book.failing - 1):
        assert book.nearest_to(*p[place]) == place
    distance = np.linalg.norm(p[book.failing :, None] - p[None, : book.failing], axis=-1)
    lonely = int(distance.min(axis=1).argmax())
    assert distance.min(axis=1)[lonely] > 0.03
    assert book.nearest_to(*p[book.failing + lonely]) == book.failing + lonely


def test_without_failures_it_begins_anywhere(make_round, regions) -> None:
    event = make_round(regions, [0] * 6)
    book = catalogue(event, event.evaluation.region, PLANE)
    assert book.suggested() is None
    assert book.first() == 0
    empty = make_round(regions, [0] * 6, samples=[0] * 6)
    assert catalogue(empty, empty.evaluation.region, PLANE).first() is None
