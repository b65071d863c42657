"""The planner as a system: its ports, when it plans, how it follows, and what ends it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, Diagram, DiagramBuilder
from pydrake.systems.primitives import ZeroOrderHold

from drake_screw.errors import DrakeScrewError
from drake_screw.execution import (
    ExecutionStatus,
    Mode,
    ObjectPoses,
    Phase,
    PlanningOutcome,
    ScrewPlanExecutor,
    ScrewPlanner,
)
from drake_screw.execution.monitoring import apart, failed
from drake_screw.planning import Cause
from drake_screw.screws import quaternion_from_rotation
from tests.execution.conftest import START
from tests.execution.moving_target import X_WO, SmallSteps, moved

TICK = 0.05
FIRST = 0.25
"""s, by which objects that stand still have done so long enough."""
OUTPUTS = ("plan", "outcome", "choice", "mode", "margins", "replans")


def poses(X: np.ndarray) -> Value:
    return Value[list[RigidTransform]]([RigidTransform(x) for x in X])


@dataclass
class Alone:
    """A planner whose inputs are what the test says."""

    planner: ScrewPlanner
    context: Context
    simulator: Simulator

    def get(self, port: str):
        return self.planner.GetOutputPort(port).Eval(self.context)

    def give(self, port: str, value: object) -> None:
        self.planner.GetInputPort(port).FixValue(self.context, value)

    def until(self, t: float) -> Alone:
        self.simulator.AdvanceTo(t)
        return self


@pytest.fixture
def chooser(arm, guides) -> SmallSteps:
    return SmallSteps(arm, guides)


@pytest.fixture
def alone(chooser) -> Callable[..., Alone]:
    def make(q=START, X=X_WO, **inputs) -> Alone:
        planner = ScrewPlanner(chooser)
        context = planner.CreateDefaultContext()
        bench = Alone(planner, context, Simulator(planner, context))
        inputs = {"object_poses": poses(X)} | inputs
        bench.give("measured_state", [*q, *np.zeros(7)])
        for port, value in inputs.items():
            bench.give(port, value)
        return bench

    return make


@dataclass
class Loop:
    """Planner and executor, the arm following at once; what was commanded at each step."""

    diagram: Diagram
    root: Context
    simulator: Simulator
    q: list[np.ndarray] = field(default_factory=list)
    v: list[np.ndarray] = field(default_factory=list)

    def get(self, system: str, port: str):
        found = self.diagram.GetSubsystemByName(system)
        return found.GetOutputPort(port).Eval(found.GetMyContextFromRoot(self.root))

    def put(self, X: np.ndarray) -> None:
        self.diagram.GetInputPort("object_poses").FixValue(self.root, poses(X))

    def until(self, t: float) -> Loop:
        while self.root.get_time() < t - 1e-9:
            self.simulator.AdvanceTo(min(self.root.get_time() + 0.005, t))
            q, v = np.split(self.get("executor", "desired_state"), 2)
            self.q.append(q)
            self.v.append(v)
        return self

    @property
    def status(self) -> ExecutionStatus:
        return self.get("executor", "status")

    @property
    def mode(self) -> Mode:
        return self.get("planner", "mode")


@pytest.fixture
def loop(arm, chooser) -> Callable[[], Loop]:
    def make() -> Loop:
        builder = DiagramBuilder()
        planner = builder.AddNamedSystem("planner", ScrewPlanner(chooser))
        executor = builder.AddNamedSystem("executor", ScrewPlanExecutor(arm))
        joints = builder.AddNamedSystem("joints", ZeroOrderHold(0.0025, 14))
        builder.Connect(executor.GetOutputPort("desired_state"), joints.get_input_port())
        for system in (planner, executor):
            builder.Connect(joints.get_output_port(), system.GetInputPort("measured_state"))
        builder.Connect(planner.GetOutputPort("plan"), executor.GetInputPort("plan"))
        status = planner.GetInputPort("execution_status")
        builder.Connect(executor.GetOutputPort("status"), status)
        builder.ExportInput(planner.GetInputPort("object_poses"), "object_poses")
        diagram = builder.Build()
        root = diagram.CreateDefaultContext()
        joints.SetVectorState(joints.GetMyMutableContextFromRoot(root), [*START, *np.zeros(7)])
        made = Loop(diagram, root, Simulator(diagram, root))
        made.put(X_WO)
        return made

    return make


def end_errors(loop: Loop, chooser: SmallSteps, arm, X: np.ndarray) -> tuple[float, float]:
    return apart(arm.pose(loop.q[-1]), chooser.demonstration.transfer(X)[-1])


def test_before_it_has_planned_its_ports_say_so(alone) -> None:
    bench = alone().until(0.1)
    assert bench.get("plan") is None
    assert bench.get("choice") is None
    assert bench.get("outcome") == PlanningOutcome()
    assert str(bench.get("outcome")) == "not planned yet"
    assert bench.get("mode") is Mode.WAITING
    assert np.isnan(bench.get("margins")).all()
    assert bench.get("replans") == [0.0]


def test_it_plans_from_where_the_arm_is_once_objects_rest(alone, arm, chooser) -> None:
    q = np.array(START) + 0.05
    bench = alone(q).until(FIRST)
    plan = bench.get("plan")
    np.testing.assert_array_equal(plan.segments[0].q[0], q)
    assert plan.begins == pytest.approx(0.2 + TICK)
    guides = chooser.demonstration.transfer(X_WO)
    np.testing.assert_allclose(plan.segments[-1].X_WB, guides[-1], atol=1e-12)
    assert bench.get("outcome") == PlanningOutcome(Cause.SUCCESS, demonstration="shown")
    assert bench.get("choice").demonstration is chooser.demonstration
    expected = arm.margin_parts(bench.get("choice").plan.q)
    np.testing.assert_array_equal(bench.get("margins"), expected)
    assert bench.get("mode") is Mode.FOLLOWING


def test_it_waits_for_objects_and_arm_to_rest(alone, chooser) -> None:
    bench = alone()
    for k in range(10):
        bench.give("object_poses", poses(moved(0.002 * k)))
        bench.until(TICK * (k + 1))
    assert bench.get("plan") is None
    assert not chooser.asked
    bench.give("measured_state", [*START, 0.1, *np.zeros(6)])
    assert bench.until(1.0).get("plan") is None
    bench.give("measured_state", [*START, *np.zeros(7)])
    assert bench.until(1.1).get("plan") is not None
    assert chooser.asked == ["choose"]


def test_a_failure_says_where_and_leaves_nothing_to_execute(alone) -> None:
    bench = alone(X=moved(2.0)).until(FIRST)
    assert bench.get("plan") is None
    outcome = bench.get("outcome")
    assert outcome.cause in (Cause.UNREACHABLE, Cause.JOINT_LIMIT)
    assert outcome.segment == 0
    assert not outcome.success
    assert str(outcome).startswith("no plan: ")
    assert bench.get("mode") is Mode.WAITING


def test_it_does_not_try_the_same_place_twice(alone, chooser) -> None:
    bench = alone(X=moved(2.0)).until(1.0)
    assert chooser.asked == ["choose"]
    bench.give("object_poses", poses(X_WO))
    assert bench.until(2.0).get("outcome").success
    assert chooser.asked == ["choose", "choose"]


def test_with_a_trigger_it_plans_when_asked(alone, chooser) -> None:
    bench = alone(trigger=[0.0]).until(1.0)
    assert not chooser.asked
    bench.give("trigger", [1.0])
    assert bench.until(1.1).get("plan") is not None
    bench.until(3.0)
    assert chooser.asked == ["choose"]


def test_objects_may_come_as_numbers(alone) -> None:
    numbers = np.concatenate([[*quaternion_from_rotation(X[:3, :3]), *X[:3, 3]] for X in X_WO])
    bench = alone().until(FIRST)
    planner = bench.planner
    context = planner.CreateDefaultContext()
    planner.GetInputPort("measured_state").FixValue(context, [*START, *np.zeros(7)])
    planner.GetInputPort("object_positions").FixValue(context, numbers)
    Simulator(planner, context).AdvanceTo(FIRST)
    found, same = planner.GetOutputPort("plan").Eval(context), bench.get("plan")
    np.testing.assert_allclose(found.segments[-1].X_WB, same.segments[-1].X_WB, atol=1e-12)


@pytest.mark.parametrize(
    ("port", "value", "message"),
    [
        ("object_poses", poses(X_WO[:1]), "1 poses; there are to be 2, of bowl, cup"),
        ("object_positions", np.zeros(14), "which are no poses"),
        (
            "object_positions",
            np.append(np.tile([1.0, 0, 0, 0, 0, 0, 0], 2)[:13], np.nan),
            "no poses",
        ),
        ("trigger", [0.0], "does not know where the objects are"),
    ],
)
def test_what_is_no_pose_is_refused(chooser, port, value, message) -> None:
    planner = ScrewPlanner(chooser)
    context = planner.CreateDefaultContext()
    planner.GetInputPort("measured_state").FixValue(context, [*START, *np.zeros(7)])
    planner.GetInputPort(port).FixValue(context, value)
    with pytest.raises(DrakeScrewError, match=message):
        Simulator(planner, context).AdvanceTo(0.1)


def test_poses_are_picked_out_of_a_plants() -> None:
    plant = MultibodyPlant(0.0)
    inertia = SpatialInertia.SolidSphereWithMass(1.0, 0.1)
    bodies = [plant.AddRigidBody(name, inertia) for name in ("a", "b", "c")]
    plant.Finalize()
    builder = DiagramBuilder()
    builder.AddSystem(plant)
    picked = builder.AddSystem(ObjectPoses([bodies[2], bodies[0]]))
    builder.Connect(plant.get_body_poses_output_port(), picked.get_input_port())
    root = builder.Build().CreateDefaultContext()
    at = plant.GetMyMutableContextFromRoot(root)
    for i, body in enumerate(bodies):
        plant.SetFreeBodyPose(at, body, RigidTransform([float(i), 0.0, 0.0]))
    found = picked.get_output_port().Eval(picked.GetMyContextFromRoot(root))
    assert [X.translation()[0] for X in found] == [2.0, 0.0]


def test_an_object_that_stays_is_executed_as_planned(loop, arm, chooser) -> None:
    run = loop().until(6.0)
    assert run.status.phase is Phase.DONE
    assert chooser.asked == ["choose"]
    assert max(end_errors(run, chooser, arm, X_WO)) < 1e-3


@pytest.mark.parametrize("way", [(0.05, -0.05), (-0.05, 0.03)])
def test_a_pushed_object_is_followed_without_a_jump(loop, arm, chooser, way) -> None:
    run = loop().until(0.55)
    for part in np.linspace(0.0, 1.0, 11):
        run.put(moved(*(part * np.array(way))))
        run.until(run.root.get_time() + 0.05)
    assert run.get("planner", "replans")[0] >= 5
    run.until(7.0)
    assert run.status.phase is Phase.DONE
    assert max(end_errors(run, chooser, arm, moved(*way))) < 1e-3
    steps = np.abs(np.diff(run.v, axis=0)) / arm.velocity_limits
    assert steps.max() < 0.05
    assert (np.abs(run.v) <= 0.55 * arm.velocity_limits).all()
    jumps = np.diff(run.q, axis=0) - 0.005 * np.array(run.v[1:])
    assert np.abs(jumps).max() < 1e-4  # a sample may fall on either side of a step


def test_one_leap_of_the_object_is_one_replan(loop, arm, chooser) -> None:
    run = loop().until(0.6)
    run.put(moved(0.03, 0.0))
    run.until(6.0)
    assert chooser.asked == ["choose", "keep"]
    assert run.get("planner", "replans") == [1.0]
    assert run.status.phase is Phase.DONE


def test_after_the_first_guiding_pose_a_moved_object_ends_it(loop, arm) -> None:
    run = loop()
    while run.status.segment != 1:
        run.until(run.root.get_time() + 0.05)
    assert run.mode is Mode.COMMITTED
    run.until(run.root.get_time() + 0.1)
    run.put(moved(0.004, 0.0))
    run.until(run.root.get_time() + 0.1)
    assert run.mode is Mode.COMMITTED
    run.put(moved(0.0, 0.03))
    run.until(run.root.get_time() + 1.5)
    reason = "the bowl was moved by 30 mm and 0 mrad while it was worked on"
    assert run.status == failed(1, reason)
    assert run.mode is Mode.ENDED
    assert np.abs(np.diff(run.v, axis=0) / arm.velocity_limits).max() < 0.05
    np.testing.assert_array_equal(run.v[-1], 0.0)
    run.put(moved(0.1, 0.0))
    run.until(run.root.get_time() + 1.0)
    assert run.status == failed(1, reason)


def test_a_bystander_may_be_moved(loop, arm, chooser) -> None:
    run = loop()
    while run.status.segment != 1:
        run.until(run.root.get_time() + 0.05)
    run.put(moved(cup=0.2))
    run.until(6.0)
    assert run.status.phase is Phase.DONE


def test_where_no_plan_follows_the_arm_rests_and_all_is_tried_again(loop, arm, chooser) -> None:
    run = loop().until(0.6)
    run.put(moved(2.0))
    run.until(2.0)
    assert run.mode is Mode.WAITING
    assert not run.get("planner", "outcome").success
    assert run.status.phase is Phase.IDLE
    np.testing.assert_array_equal(run.v[-1], 0.0)
    assert np.abs(np.diff(run.v, axis=0) / arm.velocity_limits).max() < 0.05
    run.put(moved(0.02))
    run.until(8.0)
    assert run.status.phase is Phase.DONE
    assert chooser.asked == ["choose", "keep", "choose", "choose"]


def test_a_way_that_touches_something_is_not_gone(loop, chooser) -> None:
    run = loop().until(0.6)
    chooser.blocked = True
    run.put(moved(0.03))
    run.until(0.75)
    assert run.get("planner", "outcome").cause is Cause.COLLISION
    assert run.mode is Mode.STOPPING


def test_a_failed_execution_is_not_replanned(alone) -> None:
    bench = alone(execution_status=Value[object](ExecutionStatus())).until(0.6)
    assert bench.get("mode") is Mode.FOLLOWING
    bench.give("execution_status", Value[object](failed(0, "the arm is blocked")))
    bench.give("object_poses", poses(moved(0.05)))
    assert bench.until(2.0).get("mode") is Mode.ENDED
    assert bench.get("replans") == [0.0]


def test_contexts_of_one_system_do_not_disturb_one_another(alone, chooser) -> None:
    first = alone().until(FIRST)
    planner, kept = first.planner, {name: first.get(name) for name in OUTPUTS}
    second = planner.CreateDefaultContext()
    planner.GetInputPort("measured_state").FixValue(second, [*START, *np.zeros(7)])
    planner.GetInputPort("object_poses").FixValue(second, poses(moved(0.05)))
    Simulator(planner, second).AdvanceTo(1.0)
    other = planner.GetOutputPort("plan").Eval(second)
    assert not np.allclose(other.segments[-1].X_WB, kept["plan"].segments[-1].X_WB, atol=1e-3)
    for name in ("plan", "outcome", "choice", "mode"):
        assert first.get(name) is kept[name]


def test_a_cloned_context_goes_on_to_the_same(loop) -> None:
    run = loop().until(0.6)
    run.put(moved(0.03, 0.0))
    run.until(0.8)
    root = run.root.Clone()
    copy = Loop(run.diagram, root, Simulator(run.diagram, root))
    for one in (run, copy):
        one.q.clear()
        one.put(moved(0.03, -0.03))
    run.until(2.0)
    copy.until(2.0)
    assert run.get("planner", "replans")[0] == 2.0
    np.testing.assert_array_equal(run.q, copy.q)
