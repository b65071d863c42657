"""Samples that each strategy needs for a verdict, and how often a run certifies falsely.

Beta 0.95, epsilon 0.02, delta 0.05, 16 regions. Three parts, each optional:

- samples: mean samples of one round on vectors of failure probabilities (delta not spent).
- real: the same on the rounds of real runs, given recordings. Runs of `eprocess` on the batch
  planner say which demonstrations are in hand in each round; a table of instances planned with
  every recording gives the failure probabilities of the regions then, and rounds draw from it.
- false: whole runs in which no demonstration helps: one region fails exactly 1 - beta of the time,
  the others never, and after 7 rounds the run is over. Any certificate counts as false. For the
  strategies that look hundreds of times a round it is an upper bound that is counted.

    python benchmarks/bandits.py samples [--runs 100]
    python benchmarks/bandits.py real --demonstrations DIR [--model FILE] [--seeds 50]
    python benchmarks/bandits.py false [--runs 10000]

DIR holds the folders pouring and scooping; a missing one is skipped. With --json FILE the results
are written to a file as well.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

from drake_screw.acquisition import RoundFinished
from drake_screw.bandits import STRATEGIES, Goal, Strategy, Verdict, make_strategy
from drake_screw.bandits.mixture import confidence_interval
from drake_screw.bandits.spending import attempt_delta
from drake_screw.bandits.tally import FIRST, STEP
from drake_screw.scenario.loader import load_scenario
from drake_screw.studies.experiment import Experiment, split
from drake_screw.tasks import draw

K = 16
GOAL = Goal(beta=0.95, epsilon=0.02, delta=0.05)
FAST = ("eprocess", "naive_pac", "clopper_pearson", "median_elimination")
ROUNDS = 7
PART = 250
TABLE = 32_768
LOOKS = 300
TASKS = ("pouring", "scooping")


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


def verdict(strategy: Strategy, mu: np.ndarray, seed: Any, attempt: int = 1) -> Verdict:
    """One round on regions that fail with probabilities mu (K,)."""
    rng = np.random.default_rng(seed)
    return strategy.decide(lambda counts: rng.binomial(counts, mu), len(mu), attempt=attempt)


def print_table(table: dict[str, dict[str, dict[str, Any]]]) -> None:
    """Rows of cells "mean ± standard error"."""
    print(f"{'mean samples of a round':28}" + "".join(f"{name:>23}" for name in STRATEGIES))
    for row, cells in table.items():
        texts = (f"{c['mean']:,.0f} ± {c['standard_error']:,.0f}" for c in cells.values())
        print(f"{row:28}" + "".join(f"{text:>23}" for text in texts))


def summary(verdicts: list[Verdict]) -> dict[str, Any]:
    """Mean number of samples with its standard error, and the share that certified."""
    totals = np.array([v.total_samples for v in verdicts], dtype=float)
    return {
        "mean": totals.mean(),
        "standard_error": totals.std(ddof=1) / np.sqrt(len(totals)),
        "certified": float(np.mean([v.certified for v in verdicts])),
        "rounds": len(verdicts),
    }


def samples(arguments: argparse.Namespace) -> dict[str, Any]:
    """Samples of one round on `MEANS`."""
    table: dict[str, dict[str, dict[str, Any]]] = {row: {} for row in MEANS}
    for row, mu in MEANS.items():
        for name in STRATEGIES:
            strategy = make_strategy(name, GOAL, spend=False)
            runs = arguments.runs if name in FAST else arguments.runs // 10
            began = time.perf_counter()
            cell = summary([verdict(strategy, mu, (arguments.seed, i)) for i in range(runs)])
            cell["milliseconds"] = 1e3 * (time.perf_counter() - began) / runs
            table[row][name] = cell
    print_table(table)
    return table


def real(arguments: argparse.Namespace) -> dict[str, Any]:
    """Samples and verdicts on the rounds of real runs."""
    results: dict[str, Any] = {}
    for task in TASKS:
        folder = (arguments.demonstrations or Path()) / task
        if arguments.demonstrations is None or not folder.is_dir():
            print(f"{task}: skipped, no recordings in {folder}")
            continue
        worlds = [list(run) for run in real_rounds(task, folder, arguments)]
        rounds = [mu for world in worlds for mu in world]
        few = [mu for world in worlds[: max(len(worlds) // 5, 1)] for mu in world]
        cells, judged = {}, {}
        for name in STRATEGIES:
            strategy = make_strategy(name, GOAL, spend=False)
            chosen = rounds if name in FAST else few
            verdicts = [verdict(strategy, mu, (arguments.seed, i)) for i, mu in enumerate(chosen)]
            cells[name] = summary(verdicts)
            judged[name] = verdicts
        print(f"\n{task}: {len(worlds)} runs, {len(rounds)} rounds")
        print_table({task: cells})
        results[task] = {
            "samples": cells,
            "agreement": agreement(judged["eprocess"], judged["naive_pac"], rounds),
        }
    return results


def real_rounds(
    task: str, folder: Path, arguments: argparse.Namespace
) -> Iterator[Iterator[np.ndarray]]:
    """Failure probabilities (K,) of every round of every run."""
    changes = ["teacher={kind: recorded}", f"teacher.folder={folder.resolve()}"]
    changes += [f"coverage.{key}={getattr(GOAL, key)}" for key in ("beta", "epsilon", "delta")]
    changes += ["coverage.strategy=eprocess", "demonstrations.budget=16", f"seed={arguments.seed}"]
    if arguments.model is not None:
        changes += [f"robot.model={arguments.model.resolve()}", "robot.parked={}"]
    experiment = Experiment(load_scenario(task, changes))
    setup = experiment.setup
    learned = {r.name: setup.learn(r) for r in setup.teacher.recordings}
    regions = split(setup.area, K)
    solved = np.empty((K, TABLE, len(learned)), dtype=bool)
    for j in range(K):
        places = draw(regions, j, seed=arguments.seed, round=2**30, start=0, count=TABLE)
        X_WO = setup.area.X_WO(places)
        outcomes = setup.planner.all_outcomes([*learned.values()], X_WO, setup.workcell.start)
        solved[j] = outcomes.success
    order = {name: i for i, name in enumerate(learned)}

    @cache
    def failing(names: frozenset[str]) -> np.ndarray:
        columns = [order[name] for name in names]
        return 1.0 - solved[:, :, columns].any(axis=-1).mean(axis=-1)

    for run in range(arguments.seeds):
        events = experiment.events(K, run)
        yield (
            failing(frozenset(d.name for d in event.demonstrations))
            for event in events
            if isinstance(event, RoundFinished)
        )


def agreement(first: list[Verdict], second: list[Verdict], rounds: list[np.ndarray]) -> Any:
    """How often two strategies' verdicts are both right, outside the indifference zone.

    Right: to certify if no region fails over 1 - beta of the time; else to name a region within
    epsilon of the worst. Where the worst is between 1 - beta - epsilon and 1 - beta both are right.
    """

    def right(v: Verdict, mu: np.ndarray) -> bool:
        if v.certified:
            return bool(mu.max() <= GOAL.tau)
        return bool(mu.max() > GOAL.q and mu[v.region] >= mu.max() - GOAL.epsilon)

    triples = list(zip(first, second, rounds, strict=True))
    zone = [GOAL.q < mu.max() <= GOAL.tau for mu in rounds]
    clear = [triple for triple, unclear in zip(triples, zone, strict=True) if not unclear]
    result = {
        "rounds": len(rounds),
        "in the indifference zone": sum(zone),
        "same verdict outside it": sum(
            a.certified == b.certified and right(a, mu) and right(b, mu) for a, b, mu in clear
        ),
        "wrong, first": sum(not right(a, mu) for a, _, mu in clear),
        "wrong, second": sum(not right(b, mu) for _, b, mu in clear),
        "samples, second over first": sum(b.total_samples for b in second)
        / sum(a.total_samples for a in first),
    }
    print("eprocess and naive_pac: " + ", ".join(f"{k} {v:,.6g}" for k, v in result.items()))
    return result


def false(arguments: argparse.Namespace) -> dict[str, Any]:
    """How many runs certify although one region fails just as often as must be ruled out."""
    results: dict[str, Any] = {}

    def show(title: str, events: int) -> None:
        interval = binomtest(events, arguments.runs).proportion_ci()
        low, high = interval.low, interval.high
        results[title] = {"events": events, "runs": arguments.runs, "interval": [low, high]}
        rate = f"{events / arguments.runs:.4f} [{low:.4f}, {high:.4f}]"
        print(f"{title:40} {events:5} of {arguments.runs:,}: {rate}", flush=True)

    print(f"runs of at most {ROUNDS} rounds that certify falsely (at most {GOAL.delta} claimed)")
    parts = [(min(PART, arguments.runs - i), i) for i in range(0, arguments.runs, PART)]
    cases = [*((name, True) for name in FAST), ("naive_pac", False), ("eprocess", False)]
    with ProcessPoolExecutor(arguments.workers, get_context("spawn")) as pool:
        for name, spend in cases:
            jobs = [
                pool.submit(false_in_part, name, spend, runs, (arguments.seed, i))
                for runs, i in parts
            ]
            title = f"{name}, delta {'' if spend else 'not '}spent"
            show(title, sum(job.result() for job in jobs))
    others = [name for name in STRATEGIES if name not in FAST]
    show(f"{', '.join(others)}", crossings(arguments.runs, arguments.seed))
    return results


def false_in_part(name: str, spend: bool, runs: int, seed: tuple[int, int]) -> int:
    """False certificates in some runs."""
    options = {"rank_budget": 0} if name == "eprocess" else {}
    strategy = make_strategy(name, GOAL, spend=spend, **options)
    rng = np.random.default_rng(seed)

    def pull(counts: np.ndarray) -> np.ndarray:
        failures = np.zeros(K, dtype=np.int64)
        failures[0] = rng.binomial(counts[0], GOAL.tau)
        return failures

    events = 0
    for _ in range(runs):
        attempt = 1
        for _ in range(ROUNDS):
            answer = strategy.decide(pull, K, attempt=attempt)
            attempt += answer.attempted
            if answer.certified:
                events += 1
                break
    return events


def crossings(runs: int, seed: int) -> int:
    """More false certificates than successive_elimination, lucb or ucb could give, in so many runs.

    All three look at a region after 16 samples and then every 64, and certify only when its upper
    bound at ln(K / delta) has fallen to 1 - beta. Here every look up to the `LOOKS`-th counts, also
    those after the strategy would have ended the round and asked.
    """
    rng = np.random.default_rng(seed)
    crossed = np.zeros(runs, dtype=bool)
    for attempt in range(1, ROUNDS + 1):
        c = float(np.log(K / attempt_delta(GOAL.delta, attempt, spend=True)))
        n, s = FIRST, rng.binomial(FIRST, GOAL.tau, runs)
        for _ in range(LOOKS):
            few = np.arange(int(GOAL.tau * n) + 1)
            passing = np.count_nonzero(confidence_interval(n, few, c)[1] <= GOAL.tau)
            crossed |= s < passing
            n, s = n + STEP, s + rng.binomial(STEP, GOAL.tau, runs)
    return int(crossed.sum())


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("part", choices=("samples", "real", "false"))
    parser.add_argument("--runs", type=int, help="default: 100 (samples), 10,000 (false)")
    parser.add_argument("--seeds", type=int, default=50, help="runs of part real")
    parser.add_argument("--demonstrations", type=Path, metavar="DIR")
    parser.add_argument("--model", type=Path, metavar="FILE", help="robot of the recordings")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--json", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    arguments.runs = arguments.runs or (100 if arguments.part == "samples" else 10_000)
    result = {"samples": samples, "real": real, "false": false}[arguments.part](arguments)
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=1, default=float) + "\n")


if __name__ == "__main__":
    main()
