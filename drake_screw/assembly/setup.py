"""From a scenario's text to the objects that carry it out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TypedDict, Unpack

from numpy.typing import ArrayLike

from drake_screw.acquisition import AskingRule, Evaluator, Teacher, TreeEvaluator
from drake_screw.acquisition.first import first_place
from drake_screw.acquisition.grid_evaluator import Progress
from drake_screw.acquisition.simulated import Motion
from drake_screw.assembly.arms_recorder import AnyRecorder, ArmsRecorder
from drake_screw.assembly.executing import Kept
from drake_screw.assembly.placing import InstanceLike, placed
from drake_screw.assembly.planning_setup import PlanningSetup
from drake_screw.assembly.ranked_plans import RankedPlan, best_plan
from drake_screw.assembly.recorder import Learning, Recorder
from drake_screw.assembly.ways import ways
from drake_screw.bandits import CertifyOrSplit, Goal, Strategy, make_strategy
from drake_screw.demonstrations import Demonstration, Look, Recording
from drake_screw.errors import about
from drake_screw.planning import Cause, Outcomes, Plan, Planner, connection
from drake_screw.plugins import find
from drake_screw.scenario.schema import Scenario
from drake_screw.typing import Array, PathLike


class Parts(TypedDict, total=False):
    """Parts of a `Setup` that can be passed in, as its arguments describe them."""

    teacher: Callable[[Setup], Teacher] | None
    strategy: Callable[[Setup], Strategy] | None
    planner: Callable[[Setup], Planner] | None
    motion: Motion | None
    ask: AskingRule | None


class Setup(PlanningSetup):
    """All that a scenario describes, each part built when it is first asked for.

    What is passed in takes the place of the part that the scenario describes. It is made when it is
    needed, from the setup that it becomes a part of.

    Args:
        scenario: the description.
        teacher: makes who gives demonstrations; an interactive teacher has to be passed in.
        strategy: makes the bandit of a grid.
        planner: makes the planner that decides; of several arms it is asked with `start`, of all.
        motion: what a simulated teacher shows.
        ask: chooses where the next demonstration is asked for.

    Attributes:
        scenario: the description.
        passed_in: names of the parts that were passed in, and that the scenario says nothing of.

    A planner that looks at collisions, whatever the scenario says:

    >>> from drake_screw import Setup, load_scenario
    >>> from drake_screw.planning.collisions import CollisionFreePlanner
    >>> def careful(setup: Setup) -> CollisionFreePlanner:
    ...     return CollisionFreePlanner(setup.batch_planner, setup.workcell)
    >>> setup = Setup(load_scenario("pouring"), planner=careful)
    >>> type(setup.planner).__name__, setup.passed_in
    ('CollisionFreePlanner', ('planner',))
    """

    def __init__(self, scenario: Scenario, **parts: Unpack[Parts]) -> None:
        super().__init__(scenario)
        self._parts = parts
        asks = scenario.teacher.kind == "interactive"
        given = [name for name, part in parts.items() if part is not None]
        self.passed_in = tuple(name for name in given if not (name == "teacher" and asks))

    @cached_property
    def planner(self) -> Planner:
        """The planner that decides; it watches collisions, too, where the scenario wants it."""
        make = self._parts.get("planner")
        if make is not None:
            return make(self)
        return self.planner_of_all(careful=self.scenario.planner.collision)

    def judged_plan(self, demonstration: Demonstration, X_WO: Array, outcome: Outcomes) -> Plan:
        """The plan that an outcome of `planner`, of shape (), is about.

        Of a collision it is whole, as the joints would allow it. A planner that was passed in for
        the only arm gives its own plans if it has a method `plan` like that of `BatchPlanner`.

        Args:
            demonstration: that was planned with.
            X_WO: (k, 4, 4) the objects.
            outcome: what the planner found.
        """
        one = self.arm_of(outcome)
        planner = one.batch_planner.plan
        if outcome.cause != Cause.COLLISION:
            if len(self.arms) == 1:
                planner = getattr(self.planner, "plan", planner)
            elif self.scenario.planner.collision and "planner" not in self.passed_in:
                planner = one.careful_planner.plan
        plan: Plan = planner(demonstration, X_WO, one.start, int(outcome.variant))
        return plan

    @property
    def leads_around(self) -> bool | None:
        """Whether `planner` leads the arm around what a free approach touches: OMPL is installed.

        None where the scenario does not ask for that, or the planner was passed in.
        """
        block = self.scenario.planner
        asked = block.approach == "free" and block.collision and "planner" not in self.passed_in
        return connection.available() if asked else None

    @cached_property
    def goal(self) -> Goal:
        """What is to be certified."""
        block = self.scenario.coverage
        return Goal(block.beta, block.epsilon, block.delta)

    @cached_property
    def strategy(self) -> Strategy:
        """The bandit of a grid."""
        make = self._parts.get("strategy")
        if make is not None:
            return make(self)
        block = self.scenario.coverage
        with about(self.scenario.source):
            return make_strategy(block.strategy, self.goal, **block.strategy_options)

    @cached_property
    def tree(self) -> CertifyOrSplit | None:
        """The bandit of adaptive regions; None for a grid."""
        block = self.scenario.regions.adaptive
        if block is None:
            return None
        axes = int(self.area.free.sum())
        return CertifyOrSplit(self.goal, axes, block.smallest, block.level)

    @property
    def bandit(self) -> Strategy | CertifyOrSplit:
        """The bandit of these regions."""
        return self.tree or self.strategy

    @cached_property
    def learning(self) -> Learning:
        """How recordings become demonstrations."""
        return Learning(self.scenario.segmentation.config, self.scenario.demonstrations.objects)

    @cached_property
    def teacher(self) -> Teacher:
        """Who gives demonstrations.

        Raises:
            ScenarioError: the scenario has an interactive teacher, and none was passed in.
            RecordingError: the library of a recorded one cannot be used.
            PluginError: the scenario names one that is not to be found.
        """
        make = self._parts.get("teacher")
        if make is not None:
            return make(self)
        block = self.scenario.teacher
        teacher: Teacher = find("teachers", block.kind)(self, **block.options)
        return teacher

    @property
    def motion(self) -> Motion:
        """What a simulated teacher shows.

        Raises:
            PluginError: the scenario names one that is not to be found.
        """
        passed_in = self._parts.get("motion")
        return passed_in or find("motions", str(self.scenario.teacher.motion))

    @property
    def ask(self) -> AskingRule:
        """Chooses where the next demonstration is asked for.

        Raises:
            PluginError: the scenario names one that is not to be found.
        """
        passed_in = self._parts.get("ask")
        return passed_in or find("asking_rules", self.scenario.demonstrations.ask)

    @cached_property
    def first(self) -> Array:
        """(k, c) where the first demonstration is asked for; NaN what is drawn at random."""
        return first_place(self.scenario.demonstrations.first, self.area, self.shoulders)

    @cached_property
    def initial(self) -> int | tuple[Recording, ...]:
        """Recordings to start from, or how many to ask for."""
        block, format = self.scenario.demonstrations.initial, self.scenario.teacher.format
        if isinstance(block, int):
            return block
        return tuple(self.recorder.read(folder, format) for folder in block)

    @cached_property
    def own_recorder(self) -> AnyRecorder:
        """Recordings of the arms that are planned for."""
        base = self.scenario.robot.base
        each = [Recorder(o.arm, o.arm, self.area, base=base, name=o.name) for o in self.arms]
        return each[0] if len(each) == 1 else ArmsRecorder(tuple(each))

    @cached_property
    def recorder(self) -> AnyRecorder:
        """Recordings that the scenario names: of another robot, if it says so.

        Raises:
            ModelError: that robot's model cannot be read, or lacks a name.
        """
        block = self.scenario.recorded_on
        if block is None:
            return self.own_recorder
        return Recorder.of_another(block, self.workcell.arm, self.area)

    def recorder_of(self, robot: str | None) -> AnyRecorder:
        """That of a recording's `robot`."""
        return self.own_recorder if robot is None else self.recorder

    def recordings(self, folder: PathLike) -> tuple[Recording, ...]:
        """All recordings in a folder, made on the robot that the scenario says they are of.

        Raises:
            RecordingError: there is none in it, or one cannot be used.
        """
        return self.recorder.library(Path(folder), self.scenario.teacher.format)

    def evaluate(self, demonstrations: Sequence[Demonstration], instances: ArrayLike) -> Outcomes:
        """Plan every task instance with every demonstration.

        Args:
            demonstrations: D of them.
            instances: (N, k, c) coordinates of each of the k objects in m and rad, as
                `WorkArea.complete` takes them: x, y and yaw, or x and y, will do where the work
                area fixes the others, and (N, c) for a single object.

        Returns:
            Outcomes (N, D).

        Raises:
            ValueError: instances of another shape, or not finite.
        """
        coordinates = self.area.complete(instances)
        return self.planner.all_outcomes(demonstrations, self.area.X_WO(coordinates), self.start)

    def plan(
        self,
        demonstrations: Sequence[Demonstration],
        instance: InstanceLike,
        *,
        start: ArrayLike | Mapping[str, ArrayLike] | None = None,
        most: int = 5,
    ) -> RankedPlan:
        """The best plan for a task instance: that with the largest margin which touches nothing.

        Of several arms it is the best of all; `RankedPlan.arm_name` says of which.

        Args:
            demonstrations: to choose from.
            instance: {object: (x, y[, yaw, ...])}, or the numbers of all objects, as for `placed`.
            start: (n,) rad or m, where the arm is; the scenario's start if None. Of several arms
                {name: (n,)}: that one moves, and the others rest where they start.
            most: plans to return, the best one and its alternatives.

        Raises:
            ScenarioError: the instance is not one, or there is no plan for it; it says why.
        """
        X_WO = self.area.X_WO(placed(self.area, instance))
        names = [o.name for o in self.area.objects]
        return best_plan(ways(self.arms, start), demonstrations, X_WO, names, most)

    def evaluator(
        self, progress: Progress | None = None, kept: Kept | None = None
    ) -> Evaluator | TreeEvaluator:
        """What carries out the rounds; `progress` is told how far, `kept` remembers executions."""
        executing = self.executing and self.executing.told(progress, kept)
        start, also = self.start, (self.scenario.seed, progress, executing)
        if self.tree is not None:
            return TreeEvaluator(self.planner, self.area, start, self.tree, *also)
        return Evaluator(self.planner, self.regions, start, self.strategy, *also)

    def learn(self, recording: Recording) -> Demonstration:
        """Turn a recording into a demonstration, by the kinematics of the arm it was made on.

        Raises:
            NoMotionKept: next to nothing of what was shown near an object would be kept.
        """
        return self.recorder_of(recording.robot).learn(recording, self.learning)

    def look(self, recording: Recording) -> Look:
        """What a recording holds and what is learned from it, or why it is refused.

        Raises:
            RecordingError: it names an object that there is not.
        """
        return self.recorder_of(recording.robot).look(recording, self.learning)
