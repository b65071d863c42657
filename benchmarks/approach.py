"""What a free approach brings: coverage of n demonstrations of a mug, for both approaches.

The bowl of a scenario stands for a mug with a handle: it has no symmetry, and its yaw varies by a
quarter turn to either side. The simulated teacher demonstrates at places drawn uniformly; the same
demonstrations are planned with at the same instances, with every motion along a screw and with a
free approach. Coverage is the share of instances that some demonstration solves.

    python benchmarks/approach.py [--sets 40] [--instances 1000] [--seeds 32]
"""

from __future__ import annotations

import argparse
import json

import numpy as np

from drake_screw import Setup, load_scenario
from drake_screw.acquisition import Suggestion
from drake_screw.demonstrations import Demonstration
from drake_screw.typing import Array

YAW = "[-1.5707963267948966, 1.5707963267948966]"
MOST = 8


def setup_of(task: str, approach: str, seeds: int) -> Setup:
    """A scenario with a mug in place of the bowl."""
    overrides = [
        f"objects.0.yaw={YAW}",
        "objects.0.symmetry=null",
        "regions.grid={x: 4, y: 4, yaw: 4}",
        f"planner.approach={approach}",
        f"planner.ik_seeds={seeds}",
    ]
    return Setup(load_scenario(task, overrides))


def demonstrations(setup: Setup, seed: int) -> list[Demonstration]:
    """As many as MOST by the simulated teacher, at random places of the work area."""
    rng, learned = np.random.default_rng([5, seed]), []
    for number in range(MOST):
        place = rng.uniform(setup.area.lower, setup.area.upper)
        asked = Suggestion(int(setup.regions.index(place)), place)
        lesson = setup.teacher.demonstrate(asked, number=number, used=(), rng=rng)
        if lesson.recording is not None:
            learned.append(setup.learn(lesson.recording))
    return learned


def coverage(setups: list[Setup], seed: int, instances: int) -> Array:
    """(approaches, MOST) share of instances that the first n demonstrations solve."""
    area, rng = setups[0].area, np.random.default_rng([6, seed])
    coordinates = rng.uniform(area.lower, area.upper, (instances, 1, 3))
    learned = demonstrations(setups[0], seed)
    found = []
    for setup in setups:
        solved = np.zeros((instances, MOST), dtype=bool)
        success = setup.evaluate(learned, coordinates).success
        solved[:, : len(learned)] = success
        found.append(np.logical_or.accumulate(solved, axis=1).mean(axis=0))
    return np.array(found)


def main() -> None:
    """Print the table and write it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=40, help="sets of demonstrations")
    parser.add_argument("--instances", type=int, default=1000)
    parser.add_argument("--seeds", type=int, default=32, help="planner.ik_seeds")
    parser.add_argument("--output", help="JSON file to write")
    given = parser.parse_args()
    record = {}
    for task in ("pouring", "scooping"):
        setups = [setup_of(task, approach, given.seeds) for approach in ("screw", "free")]
        found = np.array([coverage(setups, i, given.instances) for i in range(given.sets)])
        mean, error = found.mean(axis=0), found.std(axis=0, ddof=1) / np.sqrt(given.sets)
        print(f"{task}: coverage of n demonstrations, {given.sets} sets")
        print("   n   screw          free           free / screw")
        for n in range(MOST):
            screw, free = mean[:, n]
            print(
                f"  {n + 1:2d}   {screw:.3f} ±{error[0, n]:.3f}   {free:.3f} ±{error[1, n]:.3f}"
                f"   {free / screw:.2f}"
            )
        record[task] = {"screw": mean[0].tolist(), "free": mean[1].tolist()}
    if given.output:
        with open(given.output, "w") as file:
            json.dump(record, file, indent=2)


if __name__ == "__main__":
    main()
