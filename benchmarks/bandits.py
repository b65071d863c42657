"""Samples that each strategy needs for a verdict, and how often it certifies falsely.

16 simulated regions, beta 0.95, epsilon 0.02, delta 0.05, one round at a time (delta not spent over
attempts). Prints two tables; takes about a minute.

    python benchmarks/bandits.py [--runs 100] [--seed 0] [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

from drake_screw.bandits import STRATEGIES, Goal, Strategy, Verdict, make_strategy

K = 16
GOAL = Goal(beta=0.95, epsilon=0.02, delta=0.05)
FAST = ("eprocess", "clopper_pearson")


def means(*first: float, rest: float = 0.0) -> np.ndarray:
    """Failure probabilities (K,): some, and the rest."""
    return np.concatenate([first, np.full(K - len(first), rest)])


MEANS = {
    "seven at 1, rest 0": means(*[1.0] * 7),
    "one at .6, rest .04": means(0.6, rest=0.04),
    ".60 and .59, rest 0": means(0.60, 0.59),
    "one at .06, rest .01": means(0.06, rest=0.01),
    "all 0": means(),
    "all .01": means(rest=0.01),
    "all .03": means(rest=0.03),
    "all .04": means(rest=0.04),
}
LIMIT = means(GOAL.tau)  # One region as bad as a certificate allows: to certify it counts as false.


def verdicts(strategy: Strategy, mu: np.ndarray, runs: int, seed: int) -> Iterator[Verdict]:
    """So many first rounds, independent of one another."""
    rng = np.random.default_rng(seed)
    for _ in range(runs):
        yield strategy.decide(lambda counts: rng.binomial(counts, mu), len(mu), attempt=1)


def samples(name: str, mu: np.ndarray, runs: int, seed: int) -> dict[str, Any]:
    """Mean number of samples of a round, with its standard error."""
    start = time.perf_counter()
    results = list(verdicts(make_strategy(name, GOAL, spend=False), mu, runs, seed))
    seconds = time.perf_counter() - start
    totals = np.array([verdict.total_samples for verdict in results], dtype=float)
    return {
        "mean": totals.mean(),
        "standard_error": totals.std(ddof=1) / np.sqrt(runs),
        "certified": float(np.mean([verdict.certified for verdict in results])),
        "milliseconds": 1e3 * seconds / runs,
        "runs": runs,
    }


def false_certificates(name: str, runs: int, seed: int) -> dict[str, Any]:
    """Share of rounds that certify at the limit, with an exact 95 % interval."""
    options = {"rank_budget": 0} if name == "eprocess" else {}
    strategy = make_strategy(name, GOAL, spend=False, **options)
    events = sum(verdict.certified for verdict in verdicts(strategy, LIMIT, runs, seed))
    interval = binomtest(events, runs).proportion_ci()
    return {"rate": events / runs, "interval": [interval.low, interval.high], "runs": runs}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=100, help="of a fast strategy; others a tenth")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path, help="also write the results to this file")
    arguments = parser.parse_args()
    if arguments.runs < 20:
        parser.error("--runs must be at least 20")
    counts = {name: arguments.runs // (1 if name in FAST else 10) for name in STRATEGIES}

    columns = "".join(f"{name:>23}" for name in STRATEGIES)
    print(f"mean samples of a round, K = {K}\n{'':22}{columns}")
    table: dict[str, dict[str, dict[str, Any]]] = {}
    for row, mu in MEANS.items():
        table[row] = {name: samples(name, mu, counts[name], arguments.seed) for name in STRATEGIES}
        cells = (
            f"{cell['mean']:,.0f} ± {cell['standard_error']:,.0f}" for cell in table[row].values()
        )
        print(f"{row:22}" + "".join(f"{cell:>23}" for cell in cells))

    print(f"\ncertified with one region at {GOAL.tau:.2f}, rest 0 (at most {GOAL.delta} allowed)")
    rates = {
        name: false_certificates(name, 10 * counts[name], arguments.seed) for name in STRATEGIES
    }
    for name, rate in rates.items():
        low, high = rate["interval"]
        print(f"{name:22} {rate['rate']:.4f}   [{low:.4f}, {high:.4f}]   {rate['runs']} rounds")

    if arguments.json:
        result = {"samples": table, "false_certificates": rates}
        arguments.json.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
