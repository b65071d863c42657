"""What looking for collisions along plans costs, and whether it overlooks any.

    python benchmarks/collisions.py [--demonstrations 'DIR/{task}'] [--json FILE]

plans uniform instances of the shipped scenarios with all demonstrations, simulated ones or those of
a library, one plan for every pair (symmetries are left out), and prints plans per second within the
joint limits alone, with collisions looked at all along them, and with two other checkers asked
every 10 mm of travel: Drake's own, and Coal through Pinocchio (extra `benchmark`). Coal stops at a
plan's first collision; it is asked about all of a plan at once, by one thread or by all of them,
whichever is quicker, and once more about one configuration a call. With

    --agreement N   N plans a task that keep the limits are also looked at by Drake every 2 mm of
                    travel (minutes for some thousand): collisions that only Drake finds, and
                    those that it does not find
    --meshes        all the arm's collision shapes are also given as meshes of 1,000 triangles
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from coal_checker import CoalChecker
from drake_agreement import agreement, depth, list_depths, report_agreement
from joint_paths import Noted, Spacing
from mesh_arm import mesh_arm
from task import TASKS, Task, load_task

from drake_screw.assembly.setup import Setup
from drake_screw.assembly.swap_model import swap_model
from drake_screw.planning import BatchPlanner
from drake_screw.robot import Workcell
from drake_screw.scenario.loader import load_scenario
from drake_screw.typing import Array

APART = 10e-3
"""m, of travel between configurations that the other checkers are asked about."""


def best_time(call: Callable[[], Any], repeats: int) -> float:
    """Seconds that the quickest of some calls takes."""
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        call()
        times.append(time.perf_counter() - began)
    return min(times)


def speed(task: Task, workcell: Workcell, X_WO: Array, arguments: argparse.Namespace) -> dict:
    """Plans per second with all threads: within limits, and with collisions looked at."""
    plans, given = len(X_WO) * len(task.demonstrations), (task.demonstrations, X_WO, task.q_start)
    batch, checker = BatchPlanner(task.arm.screw_chain()), Noted(workcell, keep=False)
    checked = batch.checked(checker)
    for planner in (batch, checked):
        planner.all_outcomes(task.demonstrations, X_WO[:2], task.q_start)
    seconds = {
        name: best_time(lambda planner=planner: planner.all_outcomes(*given), arguments.repeats)
        for name, planner in (("checked", checked), ("limits_only", batch))
    }
    checker.paths.clear()
    checker.in_doubt.clear()
    outcomes = checked.all_outcomes(*given)
    within = sum(checker.paths)
    return {
        "plans": plans,
        "demonstrations": len(task.demonstrations),
        "within_limits": within,
        "free": int(outcomes.success.sum()),
        "plans_per_second": {name: plans / spent for name, spent in seconds.items()},
        "checks_per_second": within / max(seconds["checked"] - seconds["limits_only"], 1e-9),
        "questions_per_checked_plan": sum(checker.in_doubt) / max(within, 1),
        "settled_by_bounds": 1.0 - len(checker.in_doubt) / max(within, 1),
    }


def paths_of(task: Task, workcell: Workcell, X_WO: Array) -> list[tuple[Array, Array]]:
    """Plans that keep the limits: configurations (m, n) every 10 mm, and objects (k, 4, 4)."""
    checker = Noted(workcell)
    points = Spacing(checker, APART)
    planner = BatchPlanner(task.arm.screw_chain()).checked(checker)
    planner.all_outcomes(task.demonstrations, X_WO, task.q_start)
    return [
        (points(steps[first[i] : first[i + 1]])[0], X)
        for steps, first, objects, _ in checker.noted
        for i, X in enumerate(objects)
    ]


def asked_all_along(
    paths: Sequence[tuple[Array, Array]], planned: float, asked: Callable[[Array, Array], object]
) -> float:
    """Seconds of plans with another checker, that of measuring travel left out.

    Args:
        paths: configurations of each plan, and objects.
        planned: seconds that planning takes without a checker.
        asked: whether anything touches at one of configurations (m, n) among objects (k, 4, 4).
    """
    began = time.perf_counter()
    for q, X in paths:
        asked(q, X)
    return time.perf_counter() - began + planned


def beside_others(
    workcell: Workcell, paths: Sequence[tuple[Array, Array]], planned: float, seed: int
) -> tuple[dict[str, float], dict[str, Any] | None]:
    """Seconds of plans with Drake's checker and with Coal; and where these two do not agree.

    Args:
        workcell: of the plans.
        paths, planned: as `asked_all_along` has them.
        seed: of the random configurations.

    Returns:
        By checker; and `CoalChecker.beside_drake`, None where Pinocchio is not installed.
    """
    seconds = {"drake": asked_all_along(paths, planned, workcell.collides)}
    try:
        coal = CoalChecker(workcell)
    except ImportError:
        print("\nPinocchio is not installed (pip install '.[benchmark]'): Coal is left out")
        return seconds, None
    everyone = CoalChecker(workcell, os.cpu_count() or 1)
    seconds["coal"] = min(asked_all_along(paths, planned, c.touches) for c in (coal, everyone))
    seconds["coal_one_by_one"] = asked_all_along(paths, planned, coal.touches_one_by_one)
    said = coal.beside_drake(paths, np.random.default_rng(seed))
    differ = [depth(workcell, q, X) for q, X in said.pop("differ")]
    return seconds, {**said, "differ": differ}


def measure(name: str, arguments: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """All that is asked about one task, as far as it is known."""
    task = load_task(name, arguments.demonstrations, None, arguments.limit)
    setup = Setup(load_scenario(name))
    workcell, rng = setup.workcell, np.random.default_rng(arguments.seed)
    X_WO = task.instances(arguments.instances, rng)
    result = speed(task, workcell, X_WO, arguments)
    some = X_WO[: arguments.slow]
    per_second, plans = result["plans_per_second"], len(some) * len(task.demonstrations)
    seconds, result["coal_and_drake"] = beside_others(
        workcell,
        paths_of(task, workcell, some),
        plans / per_second["limits_only"],
        arguments.seed,
    )
    per_second.update({checker: plans / spent for checker, spent in seconds.items()})
    report(name, result)
    if arguments.meshes:
        with tempfile.TemporaryDirectory() as folder:
            model = mesh_arm(workcell.model_file, Path(folder))
            meshes = Setup(swap_model(load_scenario(name), model)).workcell
            result["meshes"] = speed(task, meshes, X_WO, arguments)
        report(f"{name}, the arm of meshes", result["meshes"])
        for what in ("plans_per_second", "checks_per_second"):
            ratio = ratio_of(result["meshes"][what], result[what])
            print(f"  {what.replace('_', ' ')}, meshes to primitives: {ratio:.2f}")
    if arguments.agreement:
        began = time.monotonic()
        for found in agreement(task, workcell, arguments.agreement, arguments.seed + 1):
            result["agreement"] = found
            print(
                f"\r  {name}: {found['plans']:,} of {arguments.agreement:,} plans beside Drake, "
                f"{time.monotonic() - began:,.0f} s",
                end="",
                file=sys.stderr,
                flush=True,
            )
            yield result
        print(file=sys.stderr)
        report_agreement(found)
    yield result


def ratio_of(ours: Any, theirs: Any) -> float:
    """Of two numbers, or of the numbers with collisions looked at."""
    return ours["checked"] / theirs["checked"] if isinstance(ours, dict) else ours / theirs


def report(name: str, result: dict[str, Any]) -> None:
    """Print a task's speeds."""
    print(
        f"\n{name}: {result['plans']:,} plans, {result['demonstrations']} demonstrations, "
        f"{result['within_limits']:,} within limits, {result['free']:,} of them free"
    )
    rows = {
        "checked": "collisions looked at",
        "limits_only": "joint limits only",
        "drake": f"Drake every {1e3 * APART:g} mm",
        "coal": f"Coal every {1e3 * APART:g} mm",
        "coal_one_by_one": "the same, one by one",
    }
    for key, title in rows.items():
        if key in result["plans_per_second"]:
            print(f"  {title:32}{result['plans_per_second'][key]:12,.0f} plans/s")
    print(f"  {'checks alone':32}{result['checks_per_second']:12,.0f} plans/s")
    print(f"  questions to Drake a checked plan {result['questions_per_checked_plan']:.4f}")
    print(f"  settled by bounds {100.0 * result['settled_by_bounds']:.3f} % of the checked plans")
    if said := result.get("coal_and_drake"):
        print(
            f"  Coal and Drake differ at {len(said['differ'])} of {said['configurations']:,} "
            f"configurations, {said['touch']:,} of which touch something"
        )
        list_depths("differ", said["differ"])


def main() -> None:
    """Measure, print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", default=TASKS, help="shipped scenarios")
    parser.add_argument("--demonstrations", metavar="DIR", help="a library; {task} is replaced")
    parser.add_argument("--limit", type=int, help="most demonstrations of a task")
    parser.add_argument("--instances", type=int, default=2000)
    parser.add_argument("--slow", type=int, default=20, help="instances for the other checkers")
    parser.add_argument("--repeats", type=int, default=3, help="the quickest counts")
    parser.add_argument("--agreement", type=int, metavar="N", help="plans to ask Drake about")
    parser.add_argument("--meshes", action="store_true", help="the arm's shapes as meshes, too")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the results there")
    arguments = parser.parse_args()
    results = {}
    for name in arguments.tasks:
        for so_far in measure(name, arguments):
            results[name] = so_far
            if arguments.json:
                arguments.json.write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
