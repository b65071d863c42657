"""What a scenario would do, told before it is done."""

from __future__ import annotations

import math
import time

import numpy as np

from drake_screw.acquisition import RecordedTeacher, random_suggestion
from drake_screw.assembly.setup import Setup
from drake_screw.bandits import CertifyOrSplit, Strategy
from drake_screw.bandits.decision_boundary import clear_boundary, deciding_size
from drake_screw.bandits.eprocess import EProcess
from drake_screw.bandits.naive_pac import NaivePac, sample_size
from drake_screw.bandits.spending import attempt_delta
from drake_screw.scenario.schema import Scenario

PROBE = 2_000


def check(scenario: Scenario) -> str:
    """Build everything a scenario names and describe the run it would make.

    Returns:
        A description for people, with the time a round is expected to take on this machine,
        measured with one demonstration.

    Raises:
        DrakeScrewError: whatever would make the run fail on its input.
    """
    setup = Setup(scenario)
    arm, regions, goal, strategy = (
        setup.workcell.arm,
        setup.regions,
        setup.goal,
        setup.bandit,
    )
    chain = arm.screw_chain()
    lines = [
        f"scenario   {scenario.name}: {scenario.description}".rstrip(": "),
        f"robot      {setup.workcell.model_file.stem}, {arm.n} joints, hand '{arm.end_effector}', "
        f"reach {chain.reach:.2f} m",
        *_area_lines(setup),
        f"regions    {_regions(setup)}",
        f"goal       every region succeeds at least {goal.beta:g} of the time, accuracy "
        f"{goal.epsilon:g}, confidence {1 - goal.delta:g}",
        f"strategy   {strategy.name}: {strategy.guarantee}",
        _teacher_line(setup),
        *_recorder_lines(setup),
        f"budget     {scenario.demonstrations.budget} demonstrations",
    ]
    corners = np.array(
        [
            [x, y, z]
            for o in setup.area.objects
            for x in (o.lower[0], o.upper[0])
            for y in (o.lower[1], o.upper[1])
            for z in (o.z,)
        ]
    )
    away = np.linalg.norm(corners - chain.shoulder, axis=1).max()
    if away > chain.reach:
        lines.append(
            f"note       the farthest corner of the work area is {away:.2f} m from the shoulder; "
            "only an object held long reaches there"
        )
    rate = _plans_per_second(setup)
    if rate is None:
        lines.append("time       unknown without a first demonstration")
    elif isinstance(strategy, NaivePac):
        n = sample_size(regions.K, goal.epsilon, goal.delta)
        lines.append(f"samples    {n:,} in each region, {n * regions.K:,} a round, every round")
        lines.append(f"time       about {n * regions.K / rate:,.0f} s a round or more here")
    else:
        lines.append(f"samples    {_samples(strategy, regions.K)}")
        lines.append(f"time       {1e4 / rate:,.1f} s for 10,000 instances here")
    return "\n".join(lines)


def _regions(setup: Setup) -> str:
    tree = setup.tree
    if tree is None:
        return f"K = {setup.regions.K}"
    axes = f"{tree.dimension} {'axis' if tree.dimension == 1 else 'axes'}"
    return (
        f"adaptive: the work area is halved along its {axes} wherever something fails, down to "
        f"{tree.smallest:.4g} of it; a cell that fails {tree.level:g} of the time is noticed"
    )


def _samples(strategy: Strategy | CertifyOrSplit, K: int) -> str:
    """How many instances a round takes, as far as can be said beforehand."""
    if isinstance(strategy, CertifyOrSplit):
        least = strategy.least(strategy.start()[0])
        return f"{least:,} in a first round where nothing fails, otherwise as many as it takes"
    if not isinstance(strategy, EProcess):
        return "as many a round as it takes"
    goal = strategy.goal
    delta = attempt_delta(goal.delta, 1, spend=strategy.spend)
    c_clear, c_flag = math.log(1.0 / delta), math.log(K / goal.delta)
    least = int(clear_boundary(goal.tau, c_clear)(0))
    most = strategy.cap or deciding_size(goal.tau, c_clear, goal.q, c_flag)
    return (
        f"{least * K:,} in a first round where nothing fails ({least} in each region), some "
        f"thousands where something does, never over {most:,} in a region before one is flagged"
    )


def _area_lines(setup: Setup) -> list[str]:
    lines = []
    for o in setup.area.objects:
        ranges = [
            f"{axis} {lower:g}..{upper:g} {unit}" if lower < upper else f"{axis} {lower:g} {unit}"
            for axis, lower, upper, unit in zip(
                ("x", "y", "yaw"), o.lower, o.upper, ("m", "m", "rad"), strict=True
            )
        ]
        lines.append(f"object     {o.name}: {', '.join(ranges)}, z {o.z:.4g} m")
    return lines


def _teacher_line(setup: Setup) -> str:
    if setup.scenario.teacher.kind == "interactive":
        return "teacher    interactive: you, in the browser"
    teacher = setup.teacher
    if isinstance(teacher, RecordedTeacher):
        return f"teacher    recorded: {len(teacher.recordings)} recordings"
    return f"teacher    {setup.scenario.teacher.kind}: {setup.scenario.teacher.motion}"


def _recorder_lines(setup: Setup) -> list[str]:
    """The arm that recordings were made on, where that is another."""
    recorder, block = setup.recorder, setup.scenario.demonstrations
    if recorder.model_file is None:
        return []
    used = setup.scenario.teacher.kind == "recorded" or not isinstance(block.initial, int)
    return [
        f"recorded   {'' if used else 'none yet; recordings named in the scenario would be '}"
        f"on {recorder.model_file.stem}, {recorder.arm.n} joints, hand "
        f"'{recorder.arm.end_effector}'"
    ]


def _plans_per_second(setup: Setup) -> float | None:
    """Measured with one demonstration on instances from all over the work area."""
    if setup.scenario.teacher.kind == "interactive":
        return None
    rng = np.random.default_rng(setup.scenario.seed)
    place = random_suggestion(setup.regions, rng)
    lesson = setup.teacher.demonstrate(place, number=0, used=(), rng=rng)
    if lesson.recording is None:
        return None
    demonstration = setup.learn(lesson.recording)
    shape = (PROBE, *setup.area.lower.shape)
    X_WO = setup.area.X_WO(rng.uniform(setup.area.lower, setup.area.upper, shape))
    setup.planner.any_success([demonstration], X_WO[:1], setup.workcell.start)
    began = time.perf_counter()
    setup.planner.any_success([demonstration], X_WO, setup.workcell.start)
    return PROBE / (time.perf_counter() - began)
