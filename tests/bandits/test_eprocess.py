from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from drake_screw.bandits import BanditError, Strategy, Verdict
from drake_screw.bandits.eprocess import EProcess
from tests.bandits.bernoulli import GOAL, arms, at_most_plausible, worst

ONE_ROUND = EProcess(GOAL, spend=False)
UNRANKED = EProcess(GOAL, spend=False, rank_budget=0)


def rounds(strategy: EProcess, mu: np.ndarray, runs: int, seed: int = 0) -> list[Verdict]:
    pull = arms(mu, seed)
    return [strategy.decide(pull, len(mu), attempt=1) for _ in range(runs)]


def mean_samples(verdicts: list[Verdict]) -> tuple[float, float]:
    totals = np.array([verdict.total_samples for verdict in verdicts])
    return totals.mean(), totals.std(ddof=1) / np.sqrt(len(totals))


@pytest.mark.parametrize(("K", "samples"), [(16, 1_184), (64, 4_736)])
def test_regions_that_never_fail_clear_at_the_second_look(K: int, samples: int) -> None:
    verdict = ONE_ROUND.decide(arms(np.zeros(K), 0), K, attempt=1)
    assert verdict.certified
    assert verdict.attempted
    assert verdict.total_samples == samples
    assert verdict.looks == 2
    assert verdict.gap is None
    assert verdict.coverage == pytest.approx(1 - 0.049867, abs=5e-7)


@pytest.mark.parametrize(
    ("mu", "samples"),
    [
        (np.repeat([1.0, 0.0], [7, 9]), 1_280),
        (np.array([0.6, 0.59] + [0.0] * 14), 4_352),
    ],
)
def test_cost_of_ranking(mu: np.ndarray, samples: int) -> None:
    assert all(verdict.total_samples == samples for verdict in rounds(ONE_ROUND, mu, 10))


@pytest.mark.parametrize(
    ("mu", "runs", "samples", "precision"),
    [
        (np.full(16, 0.01), 300, 2_205, 5),
        (np.full(16, 0.03), 300, 12_400, 50),
        (np.full(16, 0.04), 150, 26_000, 500),
    ],
)
def test_mean_samples_of_a_round(
    mu: np.ndarray, runs: int, samples: float, precision: float
) -> None:
    mean, error = mean_samples(rounds(ONE_ROUND, mu, runs))
    assert abs(mean - samples) <= 4 * error + precision


@pytest.mark.parametrize(("mu", "samples"), [(worst(0.6, 0.04), 928), (worst(0.06, 0.01), 6_507)])
def test_mean_samples_where_one_region_is_bad(mu: np.ndarray, samples: float) -> None:
    mean, _ = mean_samples(rounds(ONE_ROUND, mu, 100))
    assert mean == pytest.approx(samples, rel=0.12)


def test_seldom_certifies_a_region_at_the_limit() -> None:
    verdicts = rounds(UNRANKED, worst(0.05, 0.0), 1_500)
    certified = sum(verdict.certified for verdict in verdicts)
    assert at_most_plausible(certified, 1_500, GOAL.delta)
    assert certified > 25, "a test this far from its level asks for far too many demonstrations"


def test_seldom_flags_where_no_region_needs_it() -> None:
    verdicts = rounds(UNRANKED, np.full(16, 0.03), 250)
    assert at_most_plausible(sum(not v.certified for v in verdicts), 250, GOAL.delta)


def false_certificates(strategy: Strategy, runs: int, demonstrations: int = 7) -> int:
    """Runs that certify at some round although no demonstration ever helps and one mu is .05+."""
    mu = worst(0.05 + 1e-9, 0.0)
    pull = arms(mu, 11)
    certified = 0
    for _ in range(runs):
        attempt = 1
        for _ in range(demonstrations):
            verdict = strategy.decide(pull, len(mu), attempt=attempt)
            attempt += verdict.attempted
            if verdict.certified:
                certified += 1
                break
    return certified


@dataclass(frozen=True)
class ForgetsAttempts(EProcess):
    """The mutant: every round takes itself for the first and spends all of delta."""

    spend: bool = False


@pytest.mark.parametrize(
    ("strategy", "sound"),
    [(EProcess(GOAL, rank_budget=0), True), (ForgetsAttempts(GOAL, rank_budget=0), False)],
)
def test_a_run_of_useless_demonstrations_seldom_certifies(strategy: Strategy, sound: bool) -> None:
    assert at_most_plausible(false_certificates(strategy, 200), 200, GOAL.delta) is sound


@pytest.mark.parametrize("cap", [1, 50, 300])
@pytest.mark.parametrize("mu", [0.0, 0.04, 0.05])
def test_never_certifies_at_the_cap(cap: int, mu: float) -> None:
    strategy = EProcess(GOAL, cap=cap, rank_budget=0)
    for verdict in rounds(strategy, np.full(16, mu), 20):
        assert (verdict.samples <= cap).all()
        if "undecided" in verdict.reason:
            assert not verdict.certified
            assert verdict.samples.max() == cap
        if cap < 74:
            assert not verdict.certified
            assert not verdict.attempted


def test_names_an_epsilon_worst_region_where_samples_allow() -> None:
    mu = np.array([0.30, 0.29, 0.25, 0.2, 0.0])
    for verdict in rounds(EProcess(GOAL, rank_budget=None), mu, 8):
        assert verdict.gap is not None
        assert verdict.gap <= GOAL.epsilon
        assert mu.max() - mu[verdict.region] <= verdict.gap


def test_of_several_flagged_regions_the_one_that_fails_most_is_named() -> None:
    verdicts = rounds(ONE_ROUND, np.array([0.5, 0.6, 1.0, 0.0]), 20)
    assert all(verdict.region == 2 for verdict in verdicts)


def test_regions_with_failures_at_most_double() -> None:
    inner = arms(np.full(16, 0.03), 8)
    n, s = np.zeros(16, dtype=int), np.zeros(16, dtype=int)

    def pull(counts: np.ndarray) -> np.ndarray:
        nonlocal n, s
        assert (counts[s > 0] <= np.maximum(16, n[s > 0])).all()
        failures = inner(counts)
        n, s = n + counts, s + failures
        return failures

    for _ in range(10):
        n, s = 0 * n, 0 * s
        UNRANKED.decide(pull, 16, attempt=1)


def test_bounds_hold_for_all_regions_at_once() -> None:
    mu = np.linspace(0, 0.5, 16)
    verdicts = rounds(ONE_ROUND, mu, 200)
    missed = sum(bool(((v.lower > mu) | (mu > v.upper)).any()) for v in verdicts)
    assert at_most_plausible(missed, 200, GOAL.delta)
    assert at_most_plausible(sum(mu.max() - mu[v.region] > v.gap for v in verdicts), 200, 0.05)


def test_coverage_holds_where_the_run_is_stopped() -> None:
    mu = worst(0.3, 0.02)
    verdicts = rounds(ONE_ROUND, mu, 300)
    assert at_most_plausible(sum(v.coverage > 0.7 for v in verdicts), 300, GOAL.delta)
    assert np.median([v.coverage for v in verdicts]) > 0.5


def test_a_hopeless_region_is_asked_for_without_using_up_an_attempt() -> None:
    verdict = ONE_ROUND.decide(arms(worst(1.0, 0.0), 0), 16, attempt=1)
    assert verdict.region == 0
    assert not verdict.certified
    assert not verdict.attempted


def test_a_round_that_could_have_certified_uses_up_an_attempt() -> None:
    verdict = ONE_ROUND.decide(arms(worst(0.12, 0.0), 0), 16, attempt=1)
    assert not verdict.certified
    assert verdict.attempted


def test_later_attempts_ask_for_more_evidence() -> None:
    strategy = EProcess(GOAL)
    totals = [
        strategy.decide(arms(np.zeros(16), 0), 16, attempt=k).total_samples for k in (1, 2, 9)
    ]
    assert 1_184 < totals[0] < totals[1] < totals[2]


def test_one_region_alone() -> None:
    assert ONE_ROUND.decide(arms(np.zeros(1), 0), 1, attempt=1).certified
    verdict = ONE_ROUND.decide(arms(np.ones(1), 0), 1, attempt=1)
    assert (verdict.region, verdict.certified, verdict.total_samples) == (0, False, 16)


@pytest.mark.parametrize("option", [{"cap": 0}, {"rank_budget": -1}])
def test_refuses_options_out_of_range(option: dict[str, int]) -> None:
    with pytest.raises(BanditError, match=next(iter(option))):
        EProcess(GOAL, **option)
