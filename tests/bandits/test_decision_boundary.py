from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from drake_screw.bandits.clopper_pearson import at_most
from drake_screw.bandits.decision_boundary import ClearBoundary, clear_boundary, deciding_size
from drake_screw.bandits.mixture import ln_e_clear, ln_e_flag
from drake_screw.bandits.spending import attempt_delta, look_delta
from tests.bandits.bernoulli import GOAL, stopping_probability

C = float(np.log(1 / GOAL.delta))
C_FLAG = float(np.log(16 / GOAL.delta))
HORIZON = 5664


def test_boundary_reproduces_reference_values() -> None:
    assert clear_boundary(0.05, C)(np.arange(6)).tolist() == [74, 131, 174, 213, 249, 284]


def test_boundary_is_the_least_that_clears() -> None:
    s = np.arange(200)
    n = ClearBoundary(GOAL.tau, 4.0)(s)
    assert (ln_e_clear(n, s, GOAL.tau) >= 4.0).all()
    assert (ln_e_clear(n - 1, s, GOAL.tau) < 4.0).all()


def test_boundary_does_not_depend_on_the_order_of_questions() -> None:
    one, other = ClearBoundary(GOAL.tau, C), ClearBoundary(GOAL.tau, C)
    one(np.array([3]))
    one(np.array([150, 3, 0, 3]))
    np.testing.assert_array_equal(one(np.arange(151)), other(np.arange(151)))


@pytest.mark.parametrize(("K", "expected"), [(16, 5664), (64, 6133)])
def test_deciding_size_reproduces_reference_values(K: int, expected: int) -> None:
    assert deciding_size(GOAL.tau, C, GOAL.q, np.log(K / GOAL.delta)) == expected


def test_every_count_is_decided_at_the_deciding_size_and_not_before() -> None:
    def undecided(n: int) -> int:
        s = np.arange(n + 1)
        cleared = ln_e_clear(n, s, GOAL.tau) >= C
        return int((~cleared & (ln_e_flag(n, s, GOAL.q) < C_FLAG)).sum())

    n = deciding_size(GOAL.tau, C, GOAL.q, C_FLAG)
    assert undecided(n) == 0
    assert undecided(n - 1) == 1


# What the clear rules below are held to: at mu = tau they stop with probability at most delta.
def keeps_level(stops: Callable[[int, np.ndarray], np.ndarray], looks: range | list[int]) -> bool:
    return stopping_probability(stops, looks, GOAL.tau) <= GOAL.delta


def test_clearing_keeps_its_level_at_every_look() -> None:
    boundary = clear_boundary(GOAL.tau, C)
    looks = range(1, HORIZON + 1)
    assert keeps_level(lambda n, s: n >= boundary(s), looks)
    probability = stopping_probability(lambda n, s: n >= boundary(s), looks, GOAL.tau)
    assert probability == pytest.approx(0.0450, abs=5e-4)


def test_flagging_keeps_its_level_at_every_look() -> None:
    def flagged(n: int, s: np.ndarray) -> np.ndarray:
        return ln_e_flag(n, s, GOAL.q) >= C_FLAG

    probability = stopping_probability(flagged, range(1, 4000), GOAL.q)
    assert probability == pytest.approx(0.0017, abs=5e-5)
    assert 16 * probability <= GOAL.delta


def test_clopper_pearson_keeps_its_level_by_spending_and_peeking_does_not() -> None:
    looks = [16, *(85 * 2**i for i in range(8))]

    def spending(n: int, s: np.ndarray) -> np.ndarray:
        level = look_delta(GOAL.delta, 1 + looks.index(n))
        return at_most(np.full(len(s), n), s, GOAL.tau) <= level

    def peeking(n: int, s: np.ndarray) -> np.ndarray:
        return at_most(np.full(len(s), n), s, GOAL.tau) <= GOAL.delta

    assert keeps_level(spending, looks)
    assert not keeps_level(peeking, looks)
    assert not keeps_level(peeking, range(1, 2501))
    assert stopping_probability(peeking, range(1, 2501), GOAL.tau) == pytest.approx(0.29, abs=0.01)


def test_spending_over_attempts_keeps_the_level_of_a_run_and_not_spending_does_not() -> None:
    def certified(attempt: int, spend: bool) -> float:
        delta = attempt_delta(GOAL.delta, attempt, spend=spend)
        boundary = clear_boundary(GOAL.tau, float(np.log(1 / delta)))
        return stopping_probability(lambda n, s: n >= boundary(s), range(1, 5001), GOAL.tau)

    spending = 1 - np.prod([1 - certified(k, spend=True) for k in range(1, 8)])
    assert spending == pytest.approx(0.038, abs=1e-3)
    assert 1 - (1 - certified(7, spend=False)) ** 7 == pytest.approx(0.276, abs=2e-3)
