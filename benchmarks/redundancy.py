"""What moving away from joint limits brings: coverage of n demonstrations of a mug, and its bound.

The bowl of a scenario stands for a mug with a handle, as in approach.py. The same demonstrations
are planned with at the same instances, along screws and with a free approach, by least-norm joint
velocities and away from the limits. Coverage is the share of instances that some of n
demonstrations solves, of random sets of n. Whatever the joints do, no more can be had than those
instances at which every guiding pose has inverse kinematics by itself: that bound is given, too, as
far as 64 start configurations find them.

    python benchmarks/redundancy.py [--instances 600] [--demonstrations 32] [--threads 1]
    python benchmarks/redundancy.py --recordings 'demos/{task}' --model arm.sdf
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
from approach import YAW
from task import in_folder

from drake_screw import Setup, load_scenario
from drake_screw.acquisition import Suggestion
from drake_screw.assembly.swap_model import swap_model
from drake_screw.demonstrations import Demonstration, read_library
from drake_screw.planning.batch import EVALUATIONS_PER_STEP
from drake_screw.typing import Array

MOST, SETS = 3, 300


def setup_of(task: str, model: Path | None, *overrides: str) -> Setup:
    """A scenario with a mug in place of the bowl."""
    mug = [f"objects.0.yaw={YAW}", "objects.0.symmetry=null", "regions.grid={x: 4, y: 4, yaw: 4}"]
    scenario = load_scenario(task, [*mug, *overrides])
    return Setup(scenario if model is None else swap_model(scenario, model))


def simulated(setup: Setup, count: int) -> list[Demonstration]:
    """Demonstrations by the simulated teacher, at random places of the work area."""
    rng, learned = np.random.default_rng(11), []
    while len(learned) < count:
        place = rng.uniform(setup.area.lower, setup.area.upper)
        asked = Suggestion(int(setup.regions.index(place)), place)
        lesson = setup.teacher.demonstrate(asked, number=len(learned), used=(), rng=rng)
        if lesson.recording is not None:
            learned.append(setup.learn(lesson.recording))
    return learned


def recorded(setup: Setup, folder: str, count: int) -> list[Demonstration]:
    """Demonstrations of a library."""
    arm = setup.workcell.arm
    recordings = read_library(folder, arm.joint_names, arm.lower, arm.upper)
    return [setup.learn(recording) for recording in recordings[:count]]


def bound(setup: Setup, learned: list[Demonstration], X_WO: Array) -> Array:
    """(N, D) whether every guiding pose has inverse kinematics by itself."""
    found = np.ones((len(X_WO), len(learned)), dtype=bool)
    planner, q_start = setup.batch_planner, setup.workcell.start
    for d, lesson in enumerate(learned):
        for g in range(len(lesson.X_OE)):
            own = slice(g, g + 1)
            alone = replace(lesson, X_OE=lesson.X_OE[own], objects=lesson.objects[own])
            left = np.flatnonzero(found[:, d])
            found[left, d] = planner.all_outcomes([alone], X_WO[left], q_start).success[:, 0]
    return found


def show(name: str, success: Array, cost: str = "") -> None:
    """Coverage of 1 to MOST demonstrations, of successes (N, D)."""
    rng, D = np.random.default_rng(0), success.shape[1]
    sets = [rng.permutation(D)[:MOST] for _ in range(SETS)]
    shares = [success.mean()]
    shares += [np.mean([success[:, s[:n]].any(axis=1).mean() for s in sets]) for n in (2, 3)]
    print(f"  {name:26s}" + "".join(f" {x:.3f}" for x in shares) + cost)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--instances", type=int, default=600)
    parser.add_argument("--demonstrations", type=int, default=32)
    parser.add_argument("--seeds", type=int, default=32, help="planner.ik_seeds")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--recordings", help="library; {task} is replaced")
    parser.add_argument("--model", type=Path, help="that they were recorded on")
    given = parser.parse_args()
    for task in ("pouring", "scooping"):
        base = setup_of(task, given.model)
        learned = (
            simulated(base, given.demonstrations)
            if given.recordings is None
            else recorded(base, in_folder(given.recordings, task), given.demonstrations)
        )
        rng = np.random.default_rng(12)
        shape = (given.instances, *base.area.lower.shape)
        X_WO = base.area.X_WO(rng.uniform(base.area.lower, base.area.upper, shape))
        print(f"{task}: {len(learned)} demonstrations, {given.instances} instances")
        print("                             n = 1     2     3      s   steps a plan")
        for approach, how in product(("screw", "free"), ("least_norm", "away_from_limits")):
            keys = [f"planner.approach={approach}", f"planner.redundancy={how}"]
            setup = setup_of(task, given.model, *keys, f"planner.ik_seeds={given.seeds}")
            planner, q_start = setup.batch_planner, setup.workcell.start
            planner.threads = given.threads
            planner.all_outcomes(learned[:1], X_WO[:1], q_start)
            before, began = planner.evaluations, time.perf_counter()
            success = planner.all_outcomes(learned, X_WO, q_start).success
            seconds, steps = (
                time.perf_counter() - began,
                (planner.evaluations - before) / EVALUATIONS_PER_STEP,
            )
            cost = f" {seconds:6.1f}"
            if approach == "screw":
                cost += f"   {steps / success.size:.1f}"
            show(f"{approach}, {how}", success, cost)
        keys = ["planner.approach=free", "planner.redundancy=away_from_limits"]
        setup = setup_of(task, given.model, *keys, "planner.ik_seeds=64")
        setup.batch_planner.threads = given.threads
        show("each guiding pose alone", bound(setup, learned, X_WO))


if __name__ == "__main__":
    main()
