"""What it costs to execute plans, and to check them for collisions.

One demonstration by the simulated teacher, on a shipped scenario: the computing time of a control
period, the executor beside the joint path played by the clock, time laws, simulation, a planner's
first plan and its replans while the arm approaches, and the collision check of plans that keep the
limits. Takes about a minute.

    python benchmarks/executor.py [--scenario pouring] [--plans 400] [--seed 0] [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator

from drake_screw.acquisition import Suggestion
from drake_screw.assembly.plan_chooser import PlanChooser
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Demonstration
from drake_screw.execution import (
    Following,
    ScrewPlanExecutor,
    TimedPlan,
    TimeLimits,
    Tolerances,
    build_station,
    simulate,
    time_plan,
)
from drake_screw.execution.following import Follower, PlannerMemory, Seen
from drake_screw.planning.plan_checker import PlanChecker
from drake_screw.robot import Arm
from drake_screw.scenario.loader import load_scenario


def seconds(work: Callable[[], Any]) -> tuple[float, Any]:
    """How long something takes, and what it answers."""
    began = time.perf_counter()
    answer = work()
    return time.perf_counter() - began, answer


def demonstrate(setup: Setup, seed: int) -> Demonstration:
    """A demonstration in the middle of the work area."""
    middle = (setup.area.lower + setup.area.upper) / 2.0
    lesson = setup.teacher.demonstrate(
        Suggestion(0, middle), number=0, used=(), rng=np.random.default_rng(seed)
    )
    if lesson.recording is None:
        raise SystemExit(f"no demonstration: {lesson.remark}")
    return setup.learn(lesson.recording)


def control_periods(arm: Arm, plan: TimedPlan) -> np.ndarray:
    """Seconds of processor time in each control period of an executor by itself."""
    executor = ScrewPlanExecutor(arm)
    context = executor.CreateDefaultContext()
    executor.GetInputPort("plan").FixValue(context, Value[object](plan))
    state = np.concatenate([plan.at(0.0).q, np.zeros(arm.n)])
    measured = executor.GetInputPort("measured_state")
    measured.FixValue(context, state)
    simulator = Simulator(executor, context)
    simulator.Initialize()
    spent = []
    for k in range(1, int(plan.duration / executor.control.period)):
        began = time.thread_time()
        simulator.AdvanceTo(k * executor.control.period)
        desired = executor.GetOutputPort("desired_state").Eval(context)
        spent.append(time.thread_time() - began)
        measured.FixValue(context, desired)
    return np.array(spent)


def replans(setup: Setup, demonstration: Demonstration, count: int, seed: int) -> dict[str, float]:
    """What a `ScrewPlanner` takes to plan, and to follow an object that is pushed, in ms.

    The arm is anywhere on its approach, and the object up to 5 cm to either side.
    """
    chooser, rng = PlanChooser(setup, [demonstration]), np.random.default_rng(seed)
    follower = Follower(chooser, Following(), TimeLimits(), Tolerances())
    X_WO, start = demonstration.X_WO, setup.workcell.start
    still = np.zeros(len(start))
    resting = replace(PlannerMemory(), X_WO_rest=X_WO, resting=0.0)
    asked = Seen(1.0, X_WO, start, still)
    follower.step(resting, asked)
    first, planned = seconds(lambda: follower.step(resting, asked))
    plan = planned.plan
    if plan is None:
        raise SystemExit(f"no plan to follow with: {planned.outcome}")
    wall, spent = [], []
    while len(wall) < count:
        t = plan.begins + rng.uniform(0.1, 0.9) * plan.segments[0].duration
        pushed = X_WO.copy()
        pushed[..., :2, 3] += rng.uniform(-0.05, 0.05, 2)
        (q,), (v,) = plan.path(np.array([t - plan.begins]))
        seen = Seen(t, pushed, q, v)
        began = time.process_time()
        took, followed = seconds(lambda seen=seen: follower.step(planned, seen))
        if followed.replans:
            spent.append(time.process_time() - began)
            wall.append(took)
    wall_ms, spent_ms = 1e3 * np.array(wall[2:]), 1e3 * np.array(spent[2:])
    return {
        "first_plan": 1e3 * first,
        "median": float(np.median(wall_ms)),
        "p99": float(np.quantile(wall_ms, 0.99)),
        "computing_median": float(np.median(spent_ms)),
        "computing_p99": float(np.quantile(spent_ms, 0.99)),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenario", default="pouring")
    parser.add_argument("--plans", type=int, default=400, help="to check for collisions")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path, help="also write the results to this file")
    arguments = parser.parse_args()
    setup = Setup(load_scenario(arguments.scenario))
    arm, start = setup.workcell.arm, setup.workcell.start
    demonstration = demonstrate(setup, arguments.seed)
    X_WO = demonstration.X_WO
    guides = demonstration.transfer(X_WO)
    setup.batch_planner.plan(demonstration, X_WO, start)
    planning, plan = seconds(lambda: setup.batch_planner.plan(demonstration, X_WO, start))
    if not plan.success:
        raise SystemExit("the demonstration does not solve its own instance")
    poses = np.concatenate([arm.pose(plan.q[:1]), guides])
    time_plan(plan, poses, arm, TimeLimits())
    timing, timed = seconds(lambda: time_plan(plan, poses, arm, TimeLimits()))
    spent = 1e3 * control_periods(arm, timed)
    result: dict[str, Any] = {
        "plan_s": timed.duration,
        "segments": len(timed.segments),
        "plan_with_path_s": planning,
        "time_law_s": timing,
        "control_period_ms": {
            "mean": spent.mean(),
            "median": float(np.median(spent)),
            "p99": float(np.quantile(spent, 0.99)),
        },
    }
    period = result["control_period_ms"]
    print(f"a plan of {len(timed.segments)} segments, {timed.duration:.1f} s")
    print(f"plan with its path         {planning:8.4f} s")
    print(f"time law                   {timing:8.4f} s")
    print(
        f"control period             {period['mean']:8.3f} ms computing, median "
        f"{period['median']:.3f}, 99 % below {period['p99']:.3f}"
    )
    result["replan_ms"] = replan = replans(setup, demonstration, 200, arguments.seed)
    print(f"first plan of a planner    {replan['first_plan']:8.1f} ms, with its time law")
    print(
        f"replan on the approach     {replan['median']:8.1f} ms by the clock, 99 % below "
        f"{replan['p99']:.1f}; {replan['computing_median']:.1f} ms computing, 99 % below "
        f"{replan['computing_p99']:.1f}"
    )
    print(f"\n{'':27}{'simulation':>12}{'tracking error':>26}{'path error':>16}")
    for name, follow in (("executor", True), ("joint path by the clock", False)):
        station = build_station(
            setup.robot, table=setup.table, objects=setup.objects, follow_screws=follow
        )
        spent_s, execution = seconds(lambda station=station: simulate(station, timed, X_WO))
        report = execution.report
        screw = max(d.position for d in report.screws)
        result[name] = {
            "simulation_s": spent_s,
            "tracking_mm": 1e3 * report.tracking.position,
            "tracking_mrad": 1e3 * report.tracking.rotation,
            "screw_mm": 1e3 * screw,
            "status": str(report.status),
        }
        print(
            f"{name:27}{spent_s:10.1f} s{1e3 * report.tracking.position:14.2f} mm"
            f"{1e3 * report.tracking.rotation:5.1f} mrad{1e3 * screw:13.2f} mm   {report.status}"
        )

    rng = np.random.default_rng(arguments.seed)
    shape = (20 * arguments.plans, *setup.area.lower.shape)
    X_WO = setup.area.X_WO(rng.uniform(setup.area.lower, setup.area.upper, shape))
    solved = setup.planner.all_outcomes([demonstration], X_WO, start).success[:, 0]
    X_WO = X_WO[solved][: arguments.plans]
    checker = PlanChecker(setup.workcell)
    checker.free(np.stack([start, start]), X_WO[0])  # compiles what is not compiled yet
    count = len(X_WO)
    which = np.zeros(count, dtype=int)
    paths_s, plans = seconds(lambda: setup.batch_planner.plans([demonstration], X_WO, start, which))
    check_s, found = seconds(lambda: checker.first_collisions(plans, X_WO))
    result["collisions"] = {
        "plans": count,
        "paths_per_s": count / paths_s,
        "checks_per_s": count / check_s,
        "asked_of_drake_per_plan": checker.asked / count,
        "colliding": float(found.collides.mean()),
    }
    print(
        f"\ncollisions of {count} plans that keep the limits, {found.collides.mean():.1%} collide"
    )
    print(f"joint paths                {count / paths_s:8.0f} plans/s")
    print(
        f"check                      {count / check_s:8.0f} plans/s, "
        f"{checker.asked / count:.1f} configurations asked of Drake for each"
    )
    print(f"both                       {count / (paths_s + check_s):8.0f} plans/s")
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
