"""What symmetric objects bring: coverage of single demonstrations, and what trying turns costs.

For each task: the share of N instances that one demonstration solves, with the object as it stands
and with every turn of it; the share that the first turn solves; evaluations of J^+ V for a plan;
and answers a second, of all instances and of those that the first turn solves.

    python benchmarks/symmetry.py [--demonstrations DIR --model SDF] [--instances 2000]

DIR may have {task} in it. Without recordings the simulated teacher demonstrates, at 16 places.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from task import TASKS, in_folder

from drake_screw import Setup, load_scenario
from drake_screw.acquisition import Suggestion
from drake_screw.assembly.swap_model import swap_model
from drake_screw.demonstrations import Demonstration
from drake_screw.planning import BatchPlanner, Outcomes
from drake_screw.typing import Array

SETS = 16


def demonstrations(setup: Setup, folder: str | None) -> list[Demonstration]:
    """Those of a folder, or of the simulated teacher at random places."""
    if folder is not None:
        return [setup.learn(recording) for recording in setup.recordings(folder)]
    learned = []
    for number in range(SETS):
        rng = np.random.default_rng([3, number])
        place = rng.uniform(setup.area.lower, setup.area.upper)
        asked = Suggestion(int(setup.regions.index(place)), place)
        lesson = setup.teacher.demonstrate(asked, number=number, used=(), rng=rng)
        if lesson.recording is not None:
            learned.append(setup.learn(lesson.recording))
    return learned


def answers_per_second(
    planner: BatchPlanner, lessons: list[Demonstration], X_WO: Array, start: Array, found: Outcomes
) -> tuple[float, float]:
    """Of all pairs, and of those whose first turn succeeds, each demonstration by itself."""
    all_seconds = first_seconds = 0.0
    first_pairs = 0
    for d, lesson in enumerate(lessons):
        at_once = np.flatnonzero(found.success[:, d] & (found.variant[:, d] == 0))
        began = time.perf_counter()
        planner.any_success([lesson], X_WO, start)
        all_seconds += time.perf_counter() - began
        began = time.perf_counter()
        planner.any_success([lesson], X_WO[at_once], start)
        first_seconds += time.perf_counter() - began
        first_pairs += len(at_once)
    return found.cause.size / all_seconds, first_pairs / first_seconds


def main() -> None:
    """Print a line for each task, without symmetry and with it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--demonstrations", help="folder of recordings, perhaps with {task}")
    parser.add_argument("--model", help="model of the arm that made them")
    parser.add_argument("--instances", type=int, default=2000)
    given = parser.parse_args()
    print("task      symmetry  covered by one    first turn  evaluations  answers/s  at once/s")
    for task in TASKS:
        for name, change in (("none", "null"), ("any", "{turns: any}")):
            scenario = load_scenario(task, [f"objects.0.symmetry={change}"])
            setup = Setup(swap_model(scenario, given.model) if given.model else scenario)
            folder = given.demonstrations and in_folder(given.demonstrations, task)
            lessons = demonstrations(setup, folder)
            rng = np.random.default_rng(0)
            shape = (given.instances, *setup.area.lower.shape)
            X_WO = setup.area.X_WO(rng.uniform(setup.area.lower, setup.area.upper, shape))
            planner, start = setup.batch_planner, setup.workcell.start
            planner.any_success(lessons[:1], X_WO[:16], start)
            planner.evaluations = 0
            found = planner.all_outcomes(lessons, X_WO, start)
            work = planner.evaluations / found.cause.size
            speed = answers_per_second(planner, lessons, X_WO, start, found)
            covered = found.success.mean(axis=0)
            at_once = (found.success & (found.variant == 0)).mean()
            print(
                f"{task:9} {name:8}  {covered.mean():.3f} "
                f"({covered.min():.3f}..{covered.max():.3f})  {at_once:10.3f}  {work:11.0f}"
                f"  {speed[0]:9,.0f}  {speed[1]:9,.0f}"
            )


if __name__ == "__main__":
    main()
