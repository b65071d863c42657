"""What a scenario would do, found out before it is done."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from drake_screw.acquisition import UsableLessons, random_suggestion
from drake_screw.assembly.freedoms import Freedom, freedoms
from drake_screw.assembly.kept import kept, named_recordings, teacher_recordings
from drake_screw.assembly.preview_notes import notes
from drake_screw.assembly.preview_parts import (
    ASKED_FIRST,
    PreviewedArm,
    PreviewedObject,
    PreviewedObstacle,
    PreviewedSamples,
    PreviewedTool,
    PreviewedTree,
)
from drake_screw.assembly.preview_workcell import (
    all_hints,
    all_that_look_aside,
    farthest_corner,
    previewed_arm,
    previewed_objects,
    previewed_tool,
)
from drake_screw.assembly.recorder import Recorder
from drake_screw.assembly.sanity import missing_shapes, not_shown, touching_at_start
from drake_screw.assembly.setup import Setup
from drake_screw.assembly.work_area_checks import Covered, covered_by_obstacles
from drake_screw.bandits import CertifyOrSplit
from drake_screw.bandits.decision_boundary import clear_boundary, deciding_size
from drake_screw.bandits.eprocess import EProcess
from drake_screw.bandits.naive_pac import NaivePac, sample_size
from drake_screw.bandits.spending import attempt_delta
from drake_screw.errors import confidence, counted
from drake_screw.scenario.schema import Scenario
from drake_screw.steps import Step, Tell, to_nobody
from drake_screw.tasks import anywhere

PROBE = 2_000


@dataclass(frozen=True)
class Preview:
    """The run that a scenario describes; as text it is what ``drake-screw check`` prints.

    Attributes:
        scenario, description: its name, and its own words.
        robot: the arm that is planned for, the first of several.
        arms: each of several; () where there is only one.
        tool: what the end effector holds, if that has a shape.
        objects: where they may stand.
        obstacles: what else stands around.
        covered: obstacles in the work area.
        unseen: collision shapes of the robot that cannot be had, a line each.
        not_shown: looks of the robot that cannot be had, likewise, in one line.
        unknown_links: named as links that may touch, and not in the model.
        freedoms: symmetries that are taken for granted.
        approach: how the arm comes to the first guiding pose, "screw" or "free".
        regions: how many; None where they are adaptive.
        adaptive: how the work area is halved; None for a grid.
        beta, epsilon, delta: what is to be certified.
        success: what counts as one, "plan" or "execution".
        strategy, guarantee: the bandit, and what it promises.
        teacher: "simulated", "recorded" or "interactive".
        motion: that a simulated teacher shows.
        recordings: how many a recorded teacher has.
        kept: a line for each recording that the scenario names: how faithfully it is kept.
        recorded_on: the arm that recordings are of, where that is another.
        recordings_named: whether the scenario names recordings.
        ask: the rule by which the next demonstration is asked for.
        first: where the first one is; None where it is not asked for so.
        budget: most demonstrations in total.
        farthest_corner: m, of the work area from the shoulder.
        assumed: what is taken for what the robot's model does not state, a line each.
        lacks_ompl: whether approaches fail that OMPL, which is not installed, would lead around
            what they touch.
        samples: instances of a round.
        plans_per_second: here, measured with one demonstration; None if there is none to begin
            with.
        no_demonstration: why the teacher has none at a place drawn at random; None if it has.
        ignored_collisions: pairs of links that may touch.
        touching_at_start: pairs of bodies that touch where every plan starts; only where planning
            does not look at that.
        hints: what is likely to go wrong, a sentence each.
        looks_aside: what is to be said of an end effector that does not point out of the hand.
    """

    scenario: str
    description: str
    robot: PreviewedArm
    arms: tuple[PreviewedArm, ...]
    tool: PreviewedTool | None
    objects: tuple[PreviewedObject, ...]
    obstacles: tuple[PreviewedObstacle, ...]
    covered: tuple[Covered, ...]
    unseen: tuple[str, ...]
    not_shown: str | None
    unknown_links: tuple[str, ...]
    freedoms: tuple[Freedom, ...]
    approach: str
    regions: int | None
    adaptive: PreviewedTree | None
    beta: float
    epsilon: float
    delta: float
    success: str
    strategy: str
    guarantee: str
    teacher: str
    motion: str | None
    recordings: int | None
    kept: tuple[str, ...]
    recorded_on: PreviewedArm | None
    recordings_named: bool
    ask: str
    first: str | None
    budget: int
    farthest_corner: float
    assumed: tuple[str, ...]
    lacks_ompl: bool
    samples: PreviewedSamples
    plans_per_second: float | None
    no_demonstration: str | None
    ignored_collisions: tuple[tuple[str, str], ...]
    touching_at_start: tuple[tuple[str, str], ...]
    hints: tuple[str, ...]
    looks_aside: str | None = None

    def __str__(self) -> str:
        return "\n".join(f"{name:<10} {text}" for name, text in self._lines())

    def _lines(self) -> Iterator[tuple[str, str]]:
        yield "scenario", f"{self.scenario}: {self.description}".rstrip(": ")
        for each in self.arms or (self.robot,):
            yield "robot", f"{each}, reach {each.reach:.2f} m"
            tool = each.tool if self.arms else self.tool
            if tool is not None:
                yield "tool", str(tool)
        yield from (("object", str(item)) for item in self.objects)
        yield from (("", f"  {freedom}") for freedom in self.freedoms)
        yield from (("obstacle", str(item)) for item in self.obstacles)
        if self.ignored_collisions:
            pairs = ", ".join(f"{a} and {b}" for a, b in self.ignored_collisions)
            yield "may touch", pairs
        if self.approach == "free":
            yield "approach", "free: any joint motion to the first guiding pose"
        yield "regions", f"K = {self.regions}" if self.adaptive is None else str(self.adaptive)
        yield (
            "goal",
            f"every region succeeds at least {confidence(self.beta)} of the time, accuracy "
            f"{self.epsilon:g}, confidence {confidence(1.0 - self.delta)}",
        )
        executed = self.success == "execution"
        if executed:
            yield "success", "each instance's best plan is executed in simulation, objects free"
        yield "strategy", f"{self.strategy}: {self.guarantee}"
        yield "teacher", f"{self.teacher}: {self._teacher()}"
        yield from (("", f"  {line}") for line in self.kept)
        if self.recorded_on is not None:
            none = "none yet; recordings named in the scenario would be "
            yield "recorded", f"{'' if self.recordings_named else none}on {self.recorded_on}"
        yield "asks", self.ask + (f"; {ASKED_FIRST[self.first]} first" if self.first else "")
        yield "budget", counted(self.budget, "demonstration")
        yield from notes(self)
        rate = self.plans_per_second
        if rate is None:
            why = f": {self.no_demonstration}" if self.no_demonstration else ""
            yield "time", f"unknown without a first demonstration{why}"
            return
        yield "samples", str(self.samples)
        also = "; planning alone, executing each takes seconds more" if executed else ""
        if self.samples.fixed and self.samples.round is not None:
            yield "time", f"about {self.samples.round / rate:,.0f} s a round or more here{also}"
        else:
            yield "time", f"{1e4 / rate:,.1f} s for 10,000 instances here{also}"

    def _teacher(self) -> str:
        if self.teacher == "interactive":
            return "you, in the browser"
        n = self.recordings
        return str(self.motion) if n is None else counted(n, "recording")


def preview(scenario: Scenario, tell: Tell = to_nobody) -> Preview:
    """Build everything a scenario names and describe the run it would make.

    Args:
        scenario: to describe.
        tell: told of each step.

    Raises:
        DrakeScrewError: whatever would make the run fail on its input.
    """
    tell(Step("building the workcell"))
    setup = Setup(scenario)
    goal, tree, block, first = setup.goal, setup.tree, scenario.teacher, setup.arms[0]
    asking, recordings = scenario.demonstrations, teacher_recordings(setup)
    _ = setup.executing
    recorder = setup.recorder
    rate, no_demonstration = _plans_per_second(setup, tell)
    tell(Step("looking at the work area"))
    other = None
    if isinstance(recorder, Recorder) and recorder.model_file is not None:
        names = recorder.model_file.stem, recorder.arm.joint_names, recorder.arm.end_effector
        other = PreviewedArm(*names, recorder.arm.screw_chain().reach)
    return Preview(
        scenario=scenario.name,
        description=scenario.description,
        robot=previewed_arm(first),
        arms=tuple(previewed_arm(one) for one in setup.arms if one.among_several),
        tool=previewed_tool(first),
        objects=previewed_objects(setup),
        obstacles=tuple(
            PreviewedObstacle(o.name, str(o.shape.solid), o.shape.xyz, o.shape.rpy)
            for o in setup.obstacles
        ),
        covered=covered_by_obstacles(setup.workcell, setup.area),
        unseen=missing_shapes(setup.workcell),
        not_shown=not_shown(setup.workcell),
        unknown_links=setup.workcell.unknown_links,
        freedoms=freedoms(scenario),
        approach=scenario.planner.approach,
        regions=setup.regions.K if tree is None else None,
        adaptive=None if tree is None else PreviewedTree(tree.dimension, tree.smallest, tree.level),
        beta=goal.beta,
        epsilon=goal.epsilon,
        delta=goal.delta,
        success=scenario.coverage.success,
        strategy=setup.bandit.name,
        guarantee=setup.bandit.guarantee,
        teacher=block.kind,
        motion=str(block.motion) if block.kind == "simulated" else None,
        recordings=None if recordings is None else len(recordings),
        kept=kept(setup, named_recordings(setup)),
        recorded_on=other,
        recordings_named=recordings is not None or not isinstance(asking.initial, int),
        ask=asking.ask,
        first=asking.first if asking.initial and isinstance(asking.initial, int) else None,
        budget=asking.budget,
        farthest_corner=farthest_corner(setup),
        assumed=setup.assumptions,
        lacks_ompl=setup.leads_around is False,
        samples=_samples(setup),
        plans_per_second=rate,
        no_demonstration=no_demonstration,
        ignored_collisions=scenario.robot.ignore_collisions,
        touching_at_start=touching_at_start(setup.workcell),
        hints=all_hints(setup),
        looks_aside=all_that_look_aside(setup),
    )


def _samples(setup: Setup) -> PreviewedSamples:
    bandit, goal, K = setup.bandit, setup.goal, setup.regions.K
    match bandit:
        case CertifyOrSplit():
            return PreviewedSamples(bandit.least(bandit.start()[0]))
        case NaivePac():
            n = sample_size(K, goal.epsilon, goal.delta)
            return PreviewedSamples(n * K, n, n)
        case EProcess():
            delta = attempt_delta(goal.delta, 1, spend=bandit.spend)
            c_clear, c_flag = math.log(1.0 / delta), math.log(K / goal.delta)
            least = int(clear_boundary(goal.tau, c_clear)(0))
            most = bandit.cap or deciding_size(goal.tau, c_clear, goal.q, c_flag)
            return PreviewedSamples(least * K, least, most)
        case _:
            return PreviewedSamples()


def _plans_per_second(setup: Setup, tell: Tell) -> tuple[float | None, str | None]:
    """Measured with one demonstration on instances from all over the work area; or why not."""
    if setup.scenario.teacher.kind == "interactive":
        return None, None
    rng = np.random.default_rng(setup.scenario.seed)
    place = random_suggestion(setup.regions, rng)
    teacher = UsableLessons(setup.teacher, setup.learn)
    tell(Step("having a demonstration given"))
    lesson = teacher.demonstrate(place, number=0, used=(), rng=rng)
    if lesson.recording is None:
        return None, lesson.remark
    demonstration = setup.learn(lesson.recording)
    X_WO = setup.area.X_WO(anywhere(setup.area, rng, PROBE))
    tell(Step(f"planning {PROBE:,} instances"))
    setup.planner.any_success([demonstration], X_WO[:1], setup.start)
    began = time.perf_counter()
    setup.planner.any_success([demonstration], X_WO, setup.start)
    return PROBE / (time.perf_counter() - began), None
