from __future__ import annotations

import re

import numpy as np
import pytest

from drake_screw.bandits import STRATEGIES, BanditError, Goal, clopper_pearson, make_strategy
from drake_screw.errors import DrakeScrewError
from tests.bandits.bernoulli import GOAL, arms, at_most_plausible, worst

SEQUENTIAL = [name for name in STRATEGIES if name not in ("naive_pac", "median_elimination")]


@pytest.mark.parametrize("name", STRATEGIES)
def test_certifies_regions_that_never_fail(name: str) -> None:
    verdict = make_strategy(name, GOAL).decide(arms(np.zeros(16), 0), 16, attempt=1)
    assert verdict.certified
    assert verdict.attempted
    assert verdict.coverage >= GOAL.beta
    assert verdict.upper.max() <= 0.12
    assert (verdict.failures == 0).all()


@pytest.mark.parametrize("name", STRATEGIES)
@pytest.mark.parametrize("region", [0, 7, 15])
def test_finds_a_region_that_often_fails(name: str, region: int) -> None:
    mu = np.full(16, 0.01)
    mu[region] = 0.6
    verdict = make_strategy(name, GOAL).decide(arms(mu, 1), 16, attempt=1)
    assert not verdict.certified
    assert verdict.region == region
    assert verdict.lower[region] > GOAL.q
    assert verdict.coverage <= 0.5
    assert ((verdict.lower <= mu) & (mu <= verdict.upper)).all()
    assert verdict.gap is not None


REASONS = {
    "naive_pac": ("<= 1 - epsilon - beta = 0.03", "> 1 - epsilon - beta = 0.03"),
    "median_elimination": ("<= 1 - epsilon - beta = 0.03", "> 1 - epsilon - beta = 0.03"),
    "eprocess": ("all regions cleared", "region flagged"),
    "clopper_pearson": ("all regions cleared", "region flagged"),
}


@pytest.mark.parametrize("name", STRATEGIES)
def test_a_verdict_states_why_and_what(name: str) -> None:
    certain, stuck = (
        make_strategy(name, GOAL).decide(arms(mu, 3), 4, attempt=1)
        for mu in (np.zeros(4), worst(0.5, 0.0, 4))
    )
    bounds = ("all upper bounds at most 1 - beta", "an epsilon-worst region found")
    for verdict, expected in zip((certain, stuck), REASONS.get(name, bounds), strict=True):
        assert verdict.reason.endswith(expected)
    assert certain.claim.startswith("every region succeeds at least 0.95 of the time")
    if name == "naive_pac":
        assert stuck.claim.startswith("no region fails more often than this one by over 0.02")
    else:
        least = f"{stuck.lower[0]:.4f}"
        assert stuck.claim.startswith(f"this region fails at least {least} of the time")


@pytest.mark.parametrize("name", STRATEGIES)
@pytest.mark.parametrize("K", [1, 3])
def test_any_number_of_regions(name: str, K: int) -> None:
    strategy = make_strategy(name, GOAL)
    assert strategy.decide(arms(np.zeros(K), 0), K, attempt=2).certified
    verdict = strategy.decide(arms(np.eye(K)[K - 1], 0), K, attempt=2)
    assert (verdict.certified, verdict.region) == (False, K - 1)


@pytest.mark.parametrize("name", STRATEGIES)
def test_same_answers_give_the_same_verdict(name: str) -> None:
    mu = np.linspace(0.0, 0.08, 16)
    one, other = (make_strategy(name, GOAL).decide(arms(mu, 5), 16, attempt=3) for _ in range(2))
    assert one.reason == other.reason
    assert (one.certified, one.region, one.gap) == (other.certified, other.region, other.gap)
    np.testing.assert_array_equal(one.samples, other.samples)
    np.testing.assert_array_equal(one.failures, other.failures)
    np.testing.assert_array_equal(one.upper, other.upper)


@pytest.mark.parametrize("name", STRATEGIES)
def test_asks_only_for_whole_nonnegative_numbers_of_samples(name: str) -> None:
    inner = arms(np.linspace(0, 0.07, 5), 2)

    def pull(counts: np.ndarray) -> np.ndarray:
        assert counts.shape == (5,)
        assert counts.dtype == np.int64
        assert (counts >= 0).all()
        assert counts.sum() > 0
        failures = inner(counts)
        counts[:] = -1
        return failures

    verdict = make_strategy(name, GOAL).decide(pull, 5, attempt=1)
    assert (verdict.failures <= verdict.samples).all()


@pytest.mark.parametrize("name", SEQUENTIAL)
def test_seldom_certifies_a_region_at_the_limit(name: str) -> None:
    runs = 1_500 if name == "clopper_pearson" else 120
    options = {"rank_budget": 0} if name == "eprocess" else {}
    strategy = make_strategy(name, GOAL, spend=False, **options)
    pull = arms(worst(0.05, 0.0, K=4), 4)
    certified = sum(strategy.decide(pull, 4, attempt=1).certified for _ in range(runs))
    assert at_most_plausible(certified, runs, GOAL.delta)


@pytest.mark.parametrize(
    ("name", "mu", "expected"),
    [
        ("successive_elimination", np.zeros(16), 3_300),
        ("successive_elimination", np.full(16, 0.01), 6_100),
        ("successive_elimination", np.full(16, 0.03), 32_000),
        ("successive_elimination", worst(0.6, 0.04), 1_300),
        ("successive_elimination", worst(0.06, 0.01), 6_900),
        ("lucb", np.zeros(16), 6_400),
        ("ucb", np.zeros(16), 3_300),
        ("ucb", np.full(16, 0.01), 9_200),
        ("ucb", np.full(16, 0.03), 53_000),
        ("ucb", worst(0.6, 0.04), 800),
    ],
)
def test_mean_samples_of_a_round(name: str, mu: np.ndarray, expected: float) -> None:
    strategy = make_strategy(name, GOAL, spend=False)
    pull = arms(mu, 6)
    totals = [
        strategy.decide(pull, 16, attempt=1).total_samples
        for _ in range(60 if expected < 2_000 else 6)
    ]
    assert np.mean(totals) == pytest.approx(expected, rel=0.25)


def test_median_elimination_states_its_cost() -> None:
    verdict = make_strategy("median_elimination", GOAL, spend=False).decide(
        arms(np.zeros(16), 0), 16, attempt=1
    )
    assert verdict.total_samples == pytest.approx(49.6e6, rel=2e-3)
    assert verdict.total_samples / 516_928 == pytest.approx(96, abs=0.5)


@pytest.mark.parametrize("spends", [True, False])
def test_clopper_pearson_has_to_spend_over_its_looks(
    spends: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not spends:
        monkeypatch.setattr(clopper_pearson, "look_delta", lambda delta, look: delta + 0 * look)
    strategy = make_strategy("clopper_pearson", Goal(0.95, 0.002, 0.05), spend=False)
    pull = arms(np.array([0.05]), 9)
    certified = sum(strategy.decide(pull, 1, attempt=1).certified for _ in range(1_000))
    assert at_most_plausible(certified, 1_000, GOAL.delta) is spends


def test_successive_elimination_samples_eliminated_regions_no_more() -> None:
    mu = np.array([0.6, 0.6, 0.2, 0.2])
    verdict = make_strategy("successive_elimination", GOAL).decide(arms(mu, 0), 4, attempt=1)
    assert verdict.samples[0] == verdict.samples[1] > 20 * verdict.samples[2:].max()


def test_unknown_strategy_lists_the_valid_ones() -> None:
    with pytest.raises(BanditError) as caught:
        make_strategy("e_process", GOAL)
    assert "Did you mean 'eprocess'?" in str(caught.value)
    assert all(name in str(caught.value) for name in STRATEGIES)


def test_unknown_option_lists_the_valid_ones() -> None:
    with pytest.raises(BanditError, match="no option 'budget' in bandit 'eprocess'") as caught:
        make_strategy("eprocess", GOAL, budget=3)
    assert "rank_budget" in str(caught.value)
    assert "goal" not in str(caught.value)


@pytest.mark.parametrize(
    ("beta", "epsilon", "delta", "names"),
    [
        (0.0, 0.02, 0.05, "beta"),
        (1.0, 0.02, 0.05, "beta"),
        (0.95, 0.05, 0.05, "epsilon"),
        (0.9, 0.1, 0.05, "epsilon"),
        (0.95, 0.0, 0.05, "epsilon"),
        (0.95, 0.02, 0.0, "delta"),
        (0.95, 0.02, float("nan"), "delta"),
        (0.95, float("nan"), 0.05, "epsilon"),
    ],
)
def test_refuses_goals_out_of_range(beta: float, epsilon: float, delta: float, names: str) -> None:
    with pytest.raises(DrakeScrewError, match=names):
        Goal(beta, epsilon, delta)


@pytest.mark.parametrize(
    "answer",
    [
        lambda counts: counts + 1,
        lambda counts: -counts,
        lambda counts: counts[:2],
        lambda counts: counts / 2,
        lambda counts: int(counts.sum()),
    ],
)
def test_refuses_answers_that_are_not_counts(answer) -> None:
    with pytest.raises(BanditError, match="pull answered"):
        make_strategy("eprocess", GOAL).decide(answer, 3, attempt=1)


def test_refuses_no_regions_and_attempts_before_the_first() -> None:
    with pytest.raises(BanditError, match="0 regions"):
        make_strategy("eprocess", GOAL).decide(lambda counts: counts, 0, attempt=1)
    with pytest.raises(BanditError, match="attempt 0"):
        make_strategy("eprocess", GOAL).decide(lambda counts: counts, 3, attempt=0)


@pytest.mark.parametrize("name", ["beta", "delta"])
@pytest.mark.parametrize("value", [0.0, 1e-320, 9e-13, 1.0, 2.0, float("nan")])
def test_goals_whose_numbers_mean_nothing_are_refused(name: str, value: float) -> None:
    with pytest.raises(BanditError, match=f"{name} is"):
        Goal(**{"beta": 0.9, "epsilon": 0.02, "delta": 0.05, name: value})


@pytest.mark.parametrize("delta", [1e-12, 1e-7, 0.004])
def test_a_confidence_is_never_rounded_up_to_certainty(delta: float) -> None:
    goal = Goal(beta=0.5, epsilon=0.3, delta=delta)
    claim = make_strategy("eprocess", goal).decide(lambda n: 0 * n, 1, attempt=1).claim
    (level,) = re.findall(r"confidence ([0-9.]+)", claim)
    assert 1.0 - float(level) == pytest.approx(delta, rel=2e-3)
