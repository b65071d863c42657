"""Executions in the simulated station: what holds, and what must be noticed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantValueSource

from drake_screw.execution import Phase, ScrewPlanExecutor, TimedPlan, build_station, simulate
from drake_screw.planning.approach import approached
from drake_screw.robot import (
    BoxShape,
    CylinderShape,
    ObjectConfig,
    ObstacleConfig,
    PlacedShape,
    SphereShape,
    TableConfig,
    ToolConfig,
)
from drake_screw.screws import pose, translation_distance
from tests.execution.conftest import START, timed_plan

POST = ObjectConfig("post", 0.03, 1.0)
BOWL = ObjectConfig("bowl", 0.08, 0.06)
TABLE = TableConfig((0.85, 0.25), (0.7, 1.3), -0.0645)
FAR = pose(np.eye(3), [0.9, 0.6, -0.064])


@pytest.fixture(scope="module")
def station(robot):
    return build_station(robot, table=TABLE, objects=[BOWL])


@pytest.fixture(scope="module")
def execution(station, timed):
    return simulate(station, timed, FAR[None])


def test_a_good_plan_is_executed_within_all_tolerances(execution, timed) -> None:
    report = execution.report
    assert report.flawless
    assert report.status.phase is Phase.DONE
    assert report.outside == ()
    assert report.worst_margin > 0.3
    assert 0.1 < report.velocity < 0.6
    assert report.tracking.position < 5e-3
    assert report.tracking.rotation < 20e-3
    assert 0.0 < report.tracking.position_rms < report.tracking.position
    assert len(report.screws) == 2
    assert max(d.position for d in report.screws) < 1.5e-3
    assert report.final.position < 2e-3
    assert report.final.rotation < 10e-3
    assert report.planned == pytest.approx(timed.duration)
    assert report.planned <= report.time < report.planned + 0.3


def test_the_simulated_arm_lags_as_a_real_one_does(execution) -> None:
    """It has dynamics: nothing follows at once."""
    assert np.abs(execution.q - execution.q_desired).max() > 1e-4


def test_a_station_serves_many_plans_and_forgets_each(station, execution, timed) -> None:
    again = simulate(station, timed, FAR[None])
    np.testing.assert_array_equal(again.q, execution.q)
    assert again.report == execution.report


def test_the_idle_arm_is_held(station, robot, timed) -> None:
    for name, angle in robot.parked.items():
        joint = station.plant.GetJointByName(name)
        context = station.plant.GetMyContextFromRoot(station.context(START, FAR[None]))
        assert joint.get_angle(context) == pytest.approx(angle)
    assert station.plant.num_actuators() == 15


def test_the_joint_path_alone_arrives_too(robot, timed) -> None:
    baseline = build_station(robot, follow_screws=False)
    report = simulate(baseline, timed, np.empty((0, 4, 4))).report
    assert report.flawless
    assert report.tracking.position < 5e-3
    assert report.final.position < 2e-3


def test_an_obstacle_in_the_way_blocks_the_arm(robot, arm, timed) -> None:
    blocked = build_station(robot, objects=[POST])
    way = arm.pose(timed.segments[0].q[[0, -1]])[:, :3, 3]
    ahead = way[1] + 0.06 * (way[1] - way[0]) / np.linalg.norm(way[1] - way[0])
    X_WO = pose(np.eye(3), [ahead[0], ahead[1], ahead[2] - 0.5])
    done = simulate(blocked, timed, X_WO[None])
    report = done.report
    assert report.status.phase is Phase.FAILED
    assert "blocked" in report.status.reason
    assert report.contacts
    assert any("post" in contact.bodies for contact in report.contacts)
    assert not report.flawless
    assert done.t[-1] < timed.duration + 0.5


def test_the_tool_is_blocked_by_an_obstacle(robot, arm, timed) -> None:
    """A stick in the hand comes upon a post that the hand itself would not reach."""
    way = arm.pose(timed.segments[0].q[[0, -1]])
    toward = way[1, :3, 3] - way[0, :3, 3]
    ahead = way[1, :3, 3] + 0.2 * toward / np.linalg.norm(toward)
    post = ObstacleConfig("pole", PlacedShape(CylinderShape(0.03, 1.0), tuple(ahead)))
    p_EP = (np.linalg.inv(way[1]) @ [*ahead, 1.0])[:3]
    tip = PlacedShape(SphereShape(0.02), tuple(0.8 * p_EP))
    for tool in (None, ToolConfig("left_hand", tip)):
        station = build_station(replace(robot, tool=tool), obstacles=[post])
        report = simulate(station, timed, np.empty((0, 4, 4))).report
        if tool is None:
            assert report.flawless
    assert not report.flawless
    assert {contact.bodies for contact in report.contacts} == {("tool", "pole")}


def test_a_tool_may_touch_what_it_is_allowed_to(robot, timed) -> None:
    box = ToolConfig("left_hand", PlacedShape(BoxShape((0.1, 0.1, 0.3)), (0.0, 0.0, -0.12)))
    found = []
    for touches in ((), ("left_upper_forearm", "left_lower_forearm")):
        held = replace(robot, tool=replace(box, touches=touches))
        station = build_station(held, table=TABLE, objects=[BOWL])
        found.append(simulate(station, timed, FAR[None]).report)
    assert any("tool" in contact.bodies for contact in found[0].contacts)
    assert found[1].flawless


@pytest.mark.parametrize("kind", ["empty", "limits", "start"])
def test_plans_that_must_not_begin_do_not_move_the_arm(station, arm, timed, kind) -> None:
    first, last = timed.segments
    q_start = np.array(START)
    if kind == "empty":
        plan, said = TimedPlan(()), "empty"
    elif kind == "limits":
        plan, said = TimedPlan((replace(first, q=first.q + 2.0), last)), "limits"
    else:
        plan, q_start, said = timed, q_start + 0.1, "not where the plan starts"
    done = simulate(station, plan, FAR[None], q_start)
    assert done.report.status.phase is Phase.FAILED
    assert said in done.report.status.reason
    assert np.abs(done.q - q_start).max() < 1e-6
    assert done.t[-1] < 0.1


def test_a_set_point_out_of_reach_ends_the_execution(station, timed) -> None:
    first, last = timed.segments
    X_WB = last.X_WB.copy()
    X_WB[:3, 3] += [0.0, 0.0, 2.0]
    report = simulate(station, TimedPlan((first, replace(last, X_WB=X_WB))), FAR[None]).report
    assert (report.status.phase, report.status.segment) == (Phase.FAILED, 1)
    assert "out of reach" in report.status.reason
    assert report.outside == ()
    assert report.velocity < 1.05


def test_touching_the_bowl_is_seen(robot, arm, timed) -> None:
    """A bowl just under the end effector's path is grazed; the plan is done, but not flawless."""
    station = build_station(robot, objects=[BOWL])
    p = arm.pose(timed.segments[0].q[-1])[:3, 3]
    X_WO = pose(np.eye(3), p)
    for height in np.arange(0.0, 0.1, 0.01):
        X_WO[2, 3] = p[2] - 0.13 + height
        report = simulate(station, TimedPlan(timed.segments[:1]), X_WO[None]).report
        if report.contacts:
            break
    (contact,) = report.contacts[:1]
    assert "bowl" in contact.bodies
    assert contact.force > 0.0
    assert not report.flawless
    assert "touches" in str(contact)


def test_the_diagram_can_be_drawn(station) -> None:
    dot = station.graphviz
    assert dot.startswith("digraph")
    for name in ("executor", "measured_log", "plant", "scene_graph", "joint_command"):
        assert name in dot


def test_the_executor_works_in_a_diagram_of_the_users_own(arm, timed) -> None:
    from pydrake.common.value import Value
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.primitives import DiscreteTimeDelay

    builder = DiagramBuilder()
    executor = builder.AddNamedSystem("executor", ScrewPlanExecutor(arm))
    source = builder.AddNamedSystem("plan", ConstantValueSource(Value[object](timed)))
    perfect = builder.AddNamedSystem("arm", DiscreteTimeDelay(0.001, 1, 14))
    builder.Connect(source.get_output_port(), executor.GetInputPort("plan"))
    builder.Connect(executor.GetOutputPort("desired_state"), perfect.get_input_port())
    builder.Connect(perfect.get_output_port(), executor.GetInputPort("measured_state"))
    diagram = builder.Build()
    root = diagram.CreateDefaultContext()
    delayed = np.tile([*START, *np.zeros(7)], 2)
    perfect.GetMyMutableContextFromRoot(root).SetDiscreteState(delayed)
    simulator = Simulator(diagram, root)
    simulator.AdvanceTo(timed.duration + 0.1)
    status = executor.GetOutputPort("status").Eval(executor.GetMyContextFromRoot(root))
    assert status.phase is Phase.DONE


def test_a_free_approach_is_followed_joint_by_joint(station, arm, plan, guides) -> None:
    """From elsewhere; the end effector is nowhere near a screw on the way."""
    away = np.array([-0.3, -0.2, 0.3, 0.2, -0.5, 0.3, 0.2])
    q_start = START + away
    timed = timed_plan(arm, approached(plan, q_start), guides)
    assert [piece.screw for piece in timed.segments] == [False, True]
    report = simulate(station, timed, FAR[None]).report
    assert report.flawless, report
    assert report.tracking.position < 8e-3
    assert report.screws[1].position < 1.5e-3
    assert report.final.position < 2e-3
    points = [timed.at(t) for t in np.linspace(0.0, timed.segments[0].duration, 20)]
    off = [translation_distance(arm.pose(p.q), timed.segments[0].pose(p.s)) for p in points]
    assert max(off) > 0.01
