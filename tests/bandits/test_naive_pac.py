from __future__ import annotations

import numpy as np
import pytest

from drake_screw.bandits import Goal, OfFixedSize
from drake_screw.bandits.naive_pac import NaivePac, most_failures, sample_size
from tests.bandits.bernoulli import GOAL, arms, worst


@pytest.mark.parametrize(("K", "n"), [(16, 32_308), (64, 39_239)])
def test_sample_size_of_the_paper(K: int, n: int) -> None:
    assert sample_size(K, 0.02, 0.05) == n


@pytest.mark.parametrize("n", [100, 700, 10_000, 1_000_000])
@pytest.mark.parametrize(("beta", "epsilon"), [(0.95, 0.02), (0.9, 0.03), (0.8, 0.05)])
def test_stop_test_is_decided_on_integers(n: int, beta: float, epsilon: float) -> None:
    assert most_failures(n, Goal(beta, epsilon, 0.05)) == round(n * (100 - 100 * beta) / 100) - (
        round(n * epsilon)
    )


def answering(first: np.ndarray):
    """A pull that answers so many failures in all, as soon as it can."""
    left = np.array(first)

    def pull(counts: np.ndarray) -> np.ndarray:
        nonlocal left
        now = np.minimum(left, counts)
        left = left - now
        return now

    return pull


@pytest.mark.parametrize(("failures", "certified"), [(969, True), (970, False)])
def test_certifies_up_to_the_last_failure_allowed(failures: int, certified: bool) -> None:
    totals = np.zeros(16, dtype=int)
    totals[5] = failures
    verdict = NaivePac(GOAL).decide(answering(totals), 16, attempt=1)
    assert verdict.certified is certified
    assert verdict.region == 5
    assert verdict.total_samples == 516_928
    assert (verdict.samples == 32_308).all()
    np.testing.assert_array_equal(verdict.failures, totals)


def test_result_depends_on_totals_only() -> None:
    totals = np.arange(16) * 50
    early = NaivePac(GOAL).decide(answering(totals), 16, attempt=1)
    rest = 32_308 - totals
    late_pull = answering(rest)
    late = NaivePac(GOAL).decide(lambda counts: counts - late_pull(counts), 16, attempt=1)
    np.testing.assert_array_equal(early.failures, late.failures)
    assert (early.certified, early.region, early.reason) == (
        late.certified,
        late.region,
        late.reason,
    )


def test_is_drawn_in_parts_so_that_progress_can_be_shown() -> None:
    asked = []

    def pull(counts: np.ndarray) -> np.ndarray:
        asked.append(counts)
        return np.zeros_like(counts)

    NaivePac(GOAL).decide(pull, 3, attempt=1)
    assert len(asked) == 8
    assert (np.sum(asked, axis=0) == sample_size(3, 0.02, 0.05)).all()


def test_ties_go_to_the_first_region() -> None:
    verdict = NaivePac(GOAL).decide(answering(np.full(4, 2_000)), 4, attempt=1)
    assert verdict.region == 0
    assert not verdict.certified


def test_bounds_and_early_stop_are_those_of_the_paper() -> None:
    totals = np.array([0, 1_000, 16_154, 32_308])
    totals = np.concatenate([totals, np.zeros(12, dtype=int)])
    verdict = NaivePac(GOAL).decide(answering(totals), 16, attempt=1)
    np.testing.assert_allclose(verdict.upper[:4], [0.01, 1_000 / 32_308 + 0.01, 0.51, 1.0])
    np.testing.assert_allclose(verdict.lower[:4], [0.0, 1_000 / 32_308 - 0.01, 0.49, 0.99])
    assert verdict.gap == 0.02
    assert verdict.coverage == 0.0
    half = NaivePac(GOAL).decide(answering(totals // 2), 16, attempt=1)
    assert half.coverage == pytest.approx(1 - 0.02 - 0.5)


def test_attempts_cost_more_only_where_delta_is_spent() -> None:
    mu = worst(0.2, 0.01, K=2)
    paper = [NaivePac(GOAL).decide(arms(mu, 1), 2, attempt=k).total_samples for k in (1, 5)]
    spent = [
        NaivePac(GOAL, spend=True).decide(arms(mu, 1), 2, attempt=k).total_samples for k in (1, 5)
    ]
    assert paper[0] == paper[1]
    assert paper[0] < spent[0] < spent[1]
    assert spent[1] == 2 * sample_size(2, 0.02, 0.05 / 30)


def test_every_estimate_is_within_half_epsilon() -> None:
    mu = np.linspace(0, 1, 16)
    verdict = NaivePac(GOAL).decide(arms(mu, 3), 16, attempt=1)
    assert (np.abs(verdict.estimates - mu) <= 0.01).all()
    assert ((verdict.lower <= mu) & (mu <= verdict.upper)).all()


@pytest.mark.parametrize("spend", [False, True])
@pytest.mark.parametrize("attempt", [1, 3])
def test_how_many_samples_a_round_takes_is_known_beforehand(spend: bool, attempt: int) -> None:
    strategy = NaivePac(Goal(0.8, 0.1, 0.1), spend=spend)
    verdict = strategy.decide(np.zeros_like, 3, attempt=attempt)
    assert isinstance(strategy, OfFixedSize)
    assert strategy.total(3, attempt=attempt) == verdict.total_samples
