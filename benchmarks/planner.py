"""How fast the batch planner is, next to the same method on Drake's and on Pinocchio's kinematics.

    python benchmarks/planner.py [--json FILE]

plans uniform instances of the shipped scenarios with simulated demonstrations, in about a minute.
For recorded demonstrations, made with an arm of another model, and outcomes on record:

    python benchmarks/planner.py --tasks pouring_paper scooping_paper \\
        --demonstrations 'demos/{task}' --model arm.sdf --outcomes 'outcomes_{task}.csv'

and to compare success and failure with the reference planner's small steps on N random pairs of
instance and demonstration in each scenario (20,000 take some minutes):

    python benchmarks/planner.py --agreement N
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from agreement import agreement, recorded_outcomes
from pinocchio_arm import PinocchioArm
from task import TASKS, Task, in_folder, load_task

from drake_screw.planning import BatchPlanner, ReferencePlanner
from drake_screw.typing import Array

BATCH = 16_384

RECORDED = """\
Recorded before, on this class of machine under other load: a scalar numba kernel with tolerance
1e-5 made about 4,700 to 9,000 plans/s with two threads, 124 to 166 evaluations a plan."""


def best_time(call: Callable[[], Any], repeats: int) -> float:
    """Seconds that the quickest of some calls takes."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        call()
        times.append(time.perf_counter() - begin)
    return min(times)


def batch_speed(task: Task, X_WO: Array, repeats: int) -> dict[str, Any]:
    """All outcomes, with one thread and with all."""
    plans = len(X_WO) * len(task.demonstrations)
    result: dict[str, Any] = {"plans": plans, "threads": {}}
    for threads in sorted({1, os.cpu_count() or 1}):
        planner = BatchPlanner(task.arm.screw_chain(), threads=threads)
        begin = time.perf_counter()
        planner.all_outcomes(task.demonstrations, X_WO[:1], task.q_start)
        result.setdefault("first_call_seconds", time.perf_counter() - begin)
        planner.evaluations = 0
        seconds = best_time(
            lambda planner=planner: planner.all_outcomes(task.demonstrations, X_WO, task.q_start),
            repeats,
        )
        evaluations = planner.evaluations / repeats
        result["threads"][threads] = plans / seconds
        result["evaluations_per_plan"] = evaluations / plans
        if threads == 1:
            result["ns_per_evaluation"] = 1e9 * seconds / evaluations
    result["plans_per_second"] = max(result["threads"].values())
    return result


class Counted:
    """An arm that counts how often its Jacobian is asked for."""

    def __init__(self, arm: Any) -> None:
        self._arm = arm
        self.evaluations = 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self._arm, name)

    def pose_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        self.evaluations += 1
        return self._arm.pose_and_jacobian(q)


def loop_speed(name: str, task: Task, arm: Any, X_WO: Array, count: int) -> dict[str, float]:
    """The reference planner, one plan after the other, on an arm's kinematics."""
    counted = Counted(arm)
    planner, D = ReferencePlanner(counted), len(task.demonstrations)
    guides = [task.demonstrations[i % D].transfer(X_WO[i]) for i in range(min(count, len(X_WO)))]
    seconds = best_time(lambda: [planner.plan(task.q_start, g) for g in guides], 1)
    return {
        f"{name}_plans_per_second": len(guides) / seconds,
        f"{name}_evaluations_per_plan": counted.evaluations / len(guides),
        f"{name}_ns_per_evaluation": 1e9 * seconds / counted.evaluations,
    }


def round_speed(task: Task, count: int, seed: int) -> dict[str, float]:
    """A round of evaluation: any success with two demonstrations, drawn batch by batch."""
    planner, rng = BatchPlanner(task.arm.screw_chain()), np.random.default_rng(seed)
    begin = time.perf_counter()
    for first in range(0, count, BATCH):
        X_WO = task.instances(min(BATCH, count - first), rng)
        planner.any_success(task.demonstrations[:2], X_WO, task.q_start)
    seconds = time.perf_counter() - begin
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {"instances": count, "seconds": seconds, "peak_memory_mb": memory}


def report(task: Task, result: dict[str, Any]) -> None:
    """Print a task's numbers."""
    print(f"\n{task.name}: {result['plans']:,} plans, {len(task.demonstrations)} demonstrations")
    print(f"{'':26}{'plans/s':>12}{'evaluations':>13}{'ns each':>11}")
    for threads, speed in result["threads"].items():
        row = f"  batch planner, {threads} thread{'s' if threads > 1 else ' '}"
        each = f"{result['ns_per_evaluation']:11.1f}" if threads == 1 else ""
        print(f"{row:26}{speed:12,.0f}{result['evaluations_per_plan']:13.1f}{each}")
    for name in ("reference", "pinocchio"):
        if f"{name}_plans_per_second" in result:
            speed, evaluations, each = (
                result[f"{name}_{what}"]
                for what in ("plans_per_second", "evaluations_per_plan", "ns_per_evaluation")
            )
            print(f"{f'  {name} loop':26}{speed:12,.2f}{evaluations:13,.0f}{each:11,.0f}")
    print(f"  first call {result['first_call_seconds']:.1f} s")
    for one in result.get("rounds", ()):
        rate = one["instances"] / one["seconds"]
        print(
            f"  any success of {one['instances']:>9,} instances {one['seconds']:8.2f} s "
            f"{rate:>10,.0f}/s, peak memory so far {one['peak_memory_mb']:,.0f} MB"
        )
    for name in ("recorded", "agreement"):
        if name in result:
            numbers = {k: v for k, v in result[name].items() if k != "disagreements"}
            print(f"  {name}: " + ", ".join(f"{k} {v:.6g}" for k, v in numbers.items()))
    for one in result.get("agreement", {}).get("disagreements", ()):
        print(
            f"    batch {one['batch']}, fine {one['fine']}, least margin "
            f"{1e3 * one['least_margin']:.2f} mrad, largest rate {one['largest_rate']:.1f}, "
            f"explained by {', '.join(one['explained_by']) or 'nothing'}"
        )


def measure(task: Task, arguments: argparse.Namespace) -> dict[str, Any]:
    """All that is asked about one task."""
    rng = np.random.default_rng(arguments.seed)
    X_WO = task.instances(arguments.instances, rng)
    result = batch_speed(task, X_WO, arguments.repeats)
    result |= loop_speed("reference", task, task.arm, X_WO, arguments.loops)
    try:
        arm = PinocchioArm(task.arm.screw_chain())
        result |= loop_speed("pinocchio", task, arm, X_WO, arguments.loops)
    except ImportError:
        print("Pinocchio is not installed (pip install 'drake-screw[benchmark]'): left out")
    result["rounds"] = [round_speed(task, n, arguments.seed) for n in arguments.rounds]
    if arguments.outcomes:
        planner = BatchPlanner(task.arm.screw_chain())
        result["recorded"] = recorded_outcomes(
            task,
            Path(in_folder(arguments.outcomes, task.name)),
            lambda X_WO: planner.all_outcomes(task.demonstrations, X_WO, task.q_start),
        )
    if arguments.agreement:
        result["agreement"] = agreement(
            task, arguments.agreement, arguments.verify, arguments.seed + 1
        )
    return result


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", default=TASKS, help="shipped scenarios")
    parser.add_argument("--demonstrations", metavar="DIR", help="a library; {task} is replaced")
    parser.add_argument("--model", type=Path, help="of the arm that they were recorded on")
    parser.add_argument("--outcomes", metavar="CSV", help="on record; {task} is replaced")
    parser.add_argument("--limit", type=int, help="most demonstrations of a task")
    parser.add_argument("--instances", type=int, default=4000)
    parser.add_argument("--repeats", type=int, default=3, help="the quickest counts")
    parser.add_argument("--loops", type=int, default=10, help="plans of the slow loops")
    parser.add_argument(
        "--rounds", type=int, nargs="*", default=[10_000, 100_000], help="instances in a round"
    )
    parser.add_argument("--agreement", type=int, metavar="N", help="random pairs to compare")
    parser.add_argument("--verify", type=int, default=100, help="of them on the plant as well")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path, help="also write the results to this file")
    arguments = parser.parse_args()
    results = {}
    for name in arguments.tasks:
        task = load_task(name, arguments.demonstrations, arguments.model, arguments.limit)
        results[name] = measure(task, arguments)
        report(task, results[name])
    print(f"\n{RECORDED}")
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
