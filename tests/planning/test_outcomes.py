"""What planning answers, as arrays and as short text."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.planning import Cause, Outcomes, Plan, concatenate
from drake_screw.planning.outcomes import one_outcome

SUCCESS = one_outcome(Cause.SUCCESS)
LATEST = np.iinfo(np.int16).max


def outcomes(rows: list[list[tuple[Cause, int, int]]]) -> Outcomes:
    cause, segment, joint = np.moveaxis(np.array(rows, dtype=int), -1, 0)
    return Outcomes(
        cause.astype(np.uint8),
        segment.astype(np.int16),
        joint.astype(np.int8),
        np.where(cause == Cause.SUCCESS, 1.0, 0.5).astype(np.float32),
        np.zeros(cause.shape, dtype=np.int16),
    )


GOOD = (Cause.SUCCESS, -1, -1)
LIMIT = (Cause.JOINT_LIMIT, 2, 5)
FAR = (Cause.UNREACHABLE, 0, -1)
HIT = (Cause.COLLISION, 3, -1)
UNTRIED = (Cause.NOT_TRIED, -1, -1)


def test_causes_have_the_documented_numbers() -> None:
    assert [cause.value for cause in Cause] == [0, 1, 2, 3, 4, 5]


def test_codes_count_from_one() -> None:
    table = outcomes([[GOOD, LIMIT, FAR], [HIT, UNTRIED, (Cause.JOINT_LIMIT, 0, 0)]])
    np.testing.assert_array_equal(table.codes(), [["0:0", "3:6", "1:n"], ["4:c", "-", "1:1"]])
    assert one_outcome(Cause.JOINT_LIMIT, 11, 9).codes() == "12:10"
    assert SUCCESS.codes() == "0:0"


def test_success_per_plan_and_per_instance() -> None:
    table = outcomes([[GOOD, LIMIT], [FAR, LIMIT], [UNTRIED, GOOD], [UNTRIED, UNTRIED]])
    assert table.shape == (4, 2)
    np.testing.assert_array_equal(
        table.success, [[True, False], [False, False], [False, True], [False, False]]
    )
    np.testing.assert_array_equal(table.any_success, [True, False, True, False])


def test_furthest_segment_is_that_of_the_best_attempt() -> None:
    table = outcomes(
        [[FAR, LIMIT, HIT], [FAR, FAR, UNTRIED], [HIT, GOOD, UNTRIED], [UNTRIED, UNTRIED, UNTRIED]]
    )
    np.testing.assert_array_equal(table.furthest_segment, [3, 0, LATEST, -1])
    none = outcomes([[GOOD]])[:, :0]
    np.testing.assert_array_equal(none.furthest_segment, [-1])
    np.testing.assert_array_equal(none.any_success, [False])


def test_furthest_segment_orders_failures_before_successes() -> None:
    late = outcomes([[(Cause.JOINT_LIMIT, 300, 0)], [GOOD]])
    assert late.furthest_segment[0] < late.furthest_segment[1]


def test_the_best_attempt_is_the_one_that_came_furthest() -> None:
    """A success, then the latest segment, then the most of it, then the first in order."""
    early, late = (Cause.JOINT_LIMIT, 1, 0), (Cause.UNREACHABLE, 4, -1)
    table = outcomes(
        [
            [late, GOOD, GOOD],
            [early, late, HIT],
            [late, early, UNTRIED],
            [FAR, LIMIT, (Cause.COLLISION, 2, -1)],
            [UNTRIED, FAR, FAR],
            [UNTRIED, UNTRIED, UNTRIED],
        ]
    )
    np.testing.assert_array_equal(table.best_attempt, [1, 1, 0, 1, 1, -1])
    table.fraction[1] = [1.0, 0.0, 1.0]
    table.fraction[3] = [1.0, 0.5, 0.6]
    table.fraction[4] = [1.0, 0.2, 0.1]
    np.testing.assert_array_equal(table.best_attempt, [1, 1, 0, 2, 1, -1])
    assert table.best.codes().tolist() == ["0:0", "5:n", "5:n", "3:c", "1:n", "-"]
    assert table.best.fraction[3] == np.float32(0.6)
    assert int(table[1].best_attempt) == 1
    none = table[:, :0]
    np.testing.assert_array_equal(none.best_attempt, [-1] * 6)
    assert none.best.codes().tolist() == ["-"] * 6


def test_a_plan_that_was_executed_explains_more_than_one_that_never_was() -> None:
    ran = (Cause.EXECUTION, 1, -1)
    table = outcomes([[HIT, ran, LIMIT], [ran, GOOD, FAR]])
    np.testing.assert_array_equal(table.best_attempt, [1, 1])
    np.testing.assert_array_equal(table.any_success, [False, True])
    np.testing.assert_array_equal(table.furthest_segment, [1, np.iinfo(np.int16).max])
    assert table.best.codes().tolist() == ["2:x", "0:0"]


def test_other_outcomes_are_put_into_a_copy() -> None:
    table = outcomes([[GOOD, LIMIT], [GOOD, FAR]])
    changed = table.replaced(([0, 1], [0, 1]), outcomes([[HIT, GOOD]])[0])
    assert changed.codes().tolist() == [["4:c", "3:6"], ["0:0", "0:0"]]
    assert table.codes().tolist() == [["0:0", "3:6"], ["0:0", "1:n"]]


def test_indexing_and_concatenation() -> None:
    table = outcomes([[GOOD, LIMIT], [FAR, HIT], [UNTRIED, GOOD]])
    np.testing.assert_array_equal(table[1:].codes(), table.codes()[1:])
    np.testing.assert_array_equal(table[:, 0].codes(), table.codes()[:, 0])
    assert table[0, 1].codes() == "3:6"
    whole = concatenate(table[i : i + 1] for i in range(3))
    for name in ("cause", "segment", "joint", "fraction", "variant"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(table, name))
        assert getattr(whole, name).dtype == getattr(table, name).dtype


@pytest.mark.parametrize(("cause", "succeeds"), [(Cause.SUCCESS, True), (Cause.JOINT_LIMIT, False)])
def test_a_plan_knows_whether_it_succeeded(cause: Cause, succeeds: bool) -> None:
    plan = Plan(
        np.zeros((1, 7)),
        np.zeros(1, dtype=int),
        np.zeros(1),
        one_outcome(cause, 0, 0, 0.5),
        np.eye(4)[None],
    )
    assert plan.success is succeeds
