"""How many demonstrations the paper's loop needs, by how ties between regions are settled.

With few demonstrations several regions fail always, so `naive_pac` names one of several equals. The
paper does not say which; with recordings, one for each region, the order in which they are tried
decides how many are needed. Estimates are drawn from a table of instances planned with every
recording.

    python benchmarks/ties.py TASK --demonstrations DIR [--model FILE] [--runs 1000]

DIR is a folder of recordings for scenario TASK.
"""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path

import numpy as np

from drake_screw.bandits.naive_pac import most_failures, sample_size
from drake_screw.scenario.loader import load_scenario
from drake_screw.studies.experiment import Experiment, split
from drake_screw.tasks import draw_in_all

K = 16
TABLE = 2048


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("task")
    parser.add_argument("--demonstrations", type=Path, required=True, metavar="DIR")
    parser.add_argument("--model", type=Path, metavar="FILE", help="robot of the recordings")
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    folder = arguments.demonstrations.resolve()
    changes = ["teacher={kind: recorded}", f"teacher.folder={folder}"]
    if arguments.model is not None:
        changes += [f"robot.model={arguments.model.resolve()}", "robot.parked={}"]
    setup = Experiment(load_scenario(arguments.task, changes)).setup
    regions, goal, recordings = split(setup.area, K), setup.goal, setup.teacher.recordings
    places, _ = draw_in_all(regions, TABLE, seed=0, round=0)
    learned = [setup.learn(recording) for recording in recordings]
    planned = setup.planner.all_outcomes(learned, setup.area.X_WO(places), setup.workcell.start)
    segment = np.where(planned.success, np.iinfo(np.int16).max, planned.segment)
    reached = segment.reshape(K, TABLE, -1)
    places = places.reshape(K, TABLE, -1, 3)
    stood = setup.area.coordinates(np.stack([recording.X_WO for recording in recordings]))
    home = regions.index(stood)
    n = sample_size(K, goal.epsilon, goal.delta)
    orders = {
        "first along x": np.arange(K),
        "first along y": np.lexsort((np.arange(K) // 4, np.arange(K) % 4)),
        "at random": None,
    }

    def give(region: int, place: np.ndarray, used: list[int]) -> None:
        away = np.linalg.norm((stood - place)[..., :2], axis=-1).sum(axis=-1)
        order = np.lexsort((away, home != region))
        used.append(next(int(i) for i in order if i not in used))

    for name, order in orders.items():
        rng = np.random.default_rng(arguments.seed)
        needed: Counter[int] = Counter()
        for _ in range(arguments.runs):
            used: list[int] = []
            place = rng.uniform(setup.area.lower, setup.area.upper)
            give(int(regions.index(place)), place, used)
            while len(used) < len(recordings):
                best = reached[:, :, used].max(axis=-1)
                failing = best < np.iinfo(np.int16).max
                failures = rng.binomial(n, failing.mean(axis=1))
                if failures.max() <= most_failures(n, goal):
                    break
                ranks = rng.permutation(K) if order is None else np.argsort(order)
                region = int(np.lexsort((ranks, -failures))[0])
                failed = np.flatnonzero(failing[region])
                earliest = failed[best[region, failed] == best[region, failed].min()]
                give(region, places[region, rng.choice(earliest)], used)
            needed[len(used)] += 1
        mean = sum(k * count for k, count in needed.items()) / arguments.runs
        shares = ", ".join(f"{k}: {needed[k] / arguments.runs:.1%}" for k in sorted(needed))
        print(f"ties {name:14} mean {mean:.2f}   {shares}", flush=True)


if __name__ == "__main__":
    main()
