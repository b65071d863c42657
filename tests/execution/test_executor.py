"""The executor by itself, its joints following at once: what it commands, and when it gives up."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
import pytest
from pydrake.common.value import Value
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context

from drake_screw.execution import Phase, ScrewPlanExecutor, TimedPlan, Tolerances
from drake_screw.execution.monitoring import apart
from drake_screw.screws import exp, pose
from tests.execution.conftest import START

PERIOD = 0.005


@dataclass
class Bench:
    """An executor whose measured state is what it desired before, unless said otherwise."""

    executor: ScrewPlanExecutor
    context: Context
    simulator: Simulator
    held: Callable[[np.ndarray], np.ndarray] = lambda state: state

    def get(self, port: str):
        return self.executor.GetOutputPort(port).Eval(self.context)

    def give(self, plan: TimedPlan | None) -> None:
        self.executor.GetInputPort("plan").FixValue(self.context, Value[object](plan))

    def steps(self, seconds: float) -> Iterator[float]:
        end = self.context.get_time() + seconds
        while self.context.get_time() < end - 1e-9:
            self.simulator.AdvanceTo(self.context.get_time() + PERIOD)
            measured = self.held(self.get("desired_state"))
            self.executor.GetInputPort("measured_state").FixValue(self.context, measured)
            yield self.context.get_time()

    def finish(self, seconds: float = 20.0):
        for _ in self.steps(seconds):
            if self.get("status").ended:
                break
        return self.get("status")


@pytest.fixture
def bench(arm) -> Callable[..., Bench]:
    def make(q=START, **kwargs) -> Bench:
        executor = ScrewPlanExecutor(arm, **kwargs)
        context = executor.CreateDefaultContext()
        state = np.concatenate([q, np.zeros(arm.n)])
        executor.GetInputPort("measured_state").FixValue(context, state)
        simulator = Simulator(executor, context)
        simulator.Initialize()
        return Bench(executor, context, simulator)

    return make


def shifted(timed: TimedPlan, p: tuple[float, float, float]) -> TimedPlan:
    """The same joint path and times, with the second guiding pose elsewhere."""
    first, last = timed.segments
    X_WB = last.X_WB.copy()
    X_WB[:3, 3] += p
    return TimedPlan((first, replace(last, X_WB=X_WB)))


def test_without_a_plan_it_is_idle_and_holds_still(bench) -> None:
    idle = bench()
    for _ in idle.steps(0.1):
        pass
    assert idle.get("status").phase is Phase.IDLE
    assert idle.get("progress") == [0.0]
    np.testing.assert_array_equal(idle.get("desired_state"), [*START, *np.zeros(7)])
    idle.give(None)
    assert idle.finish(0.1).phase is Phase.IDLE


def test_it_leads_the_end_effector_along_the_screws(bench, arm, timed) -> None:
    run = bench()
    run.give(timed)
    seen, progress = [], []
    for t in run.steps(timed.duration):
        q = run.get("desired_state")[:7]
        point = timed.at(t - PERIOD)
        far, turned = apart(arm.pose(q), timed.segments[point.segment].pose(point.s))
        ahead = timed.at(t)
        near, bent = apart(arm.pose(q), timed.segments[ahead.segment].pose(ahead.s))
        assert min(far, near) < 2e-4
        assert min(turned, bent) < 4e-4
        np.testing.assert_allclose(q, ahead.q, atol=3e-3)
        seen.append(run.get("status").segment)
        progress.append(run.get("progress")[0])
    assert run.finish().phase is Phase.DONE
    assert seen == sorted(seen)
    assert set(seen) == {0, 1}
    assert progress == sorted(progress)
    assert run.get("progress") == [1.0]
    assert run.context.get_time() < timed.duration + 0.1
    far, turned = apart(arm.pose(run.get("desired_state")[:7]), timed.segments[-1].X_WB)
    assert far < 1e-4
    assert turned < 1e-4


def test_desired_positions_advance_at_the_desired_velocity(bench, timed) -> None:
    run = bench()
    run.give(timed)
    for _ in run.steps(0.3):
        pass
    before = run.get("desired_state")
    run.context.SetTime(run.context.get_time() + 0.002)
    after = run.get("desired_state")
    np.testing.assert_allclose(after[:7], before[:7] + 0.002 * before[7:], atol=1e-12)
    assert np.abs(before[7:]).max() > 0.05


def test_it_is_drawn_to_the_planned_joint_path(bench, arm, timed) -> None:
    """Begun a little off in the motion the end effector leaves free, it comes back to the plan."""
    J = arm.jacobian(np.array(START))
    free = np.linalg.svd(J)[2][-1]
    off = np.array(START) + 0.015 * free
    first, last = timed.segments
    q = first.q + 0.015 * free
    start = TimedPlan((replace(first, q=np.concatenate([q[:1], first.q[1:]])), last))
    run = bench(off)
    run.give(start)
    assert run.finish().phase is Phase.DONE
    np.testing.assert_allclose(run.get("desired_state")[:7], last.q[-1], atol=3e-3)


def test_an_empty_plan_fails(bench) -> None:
    run = bench()
    run.give(TimedPlan(()))
    status = run.finish()
    assert status.phase is Phase.FAILED
    assert status.segment is None
    assert "empty" in status.reason


def test_a_plan_that_leaves_the_limits_fails_before_it_moves(bench, arm, timed) -> None:
    first, last = timed.segments
    q = last.q.copy()
    q[-1, 3] = arm.upper[3] + 0.2
    run = bench()
    run.give(TimedPlan((first, replace(last, q=q))))
    status = run.finish()
    assert status.phase is Phase.FAILED
    assert status.segment == 1
    assert "left_e1" in status.reason
    assert "0.2000 rad" in status.reason
    np.testing.assert_allclose(run.get("desired_state")[:7], START)


def test_a_plan_with_a_position_that_is_no_number_fails(bench, timed) -> None:
    first, last = timed.segments
    q = first.q.copy()
    q[3, 0] = np.nan
    run = bench()
    run.give(TimedPlan((replace(first, q=q), last)))
    assert run.finish().phase is Phase.FAILED


def test_a_plan_that_is_too_fast_fails_before_it_moves(bench, timed) -> None:
    first, last = timed.segments
    run = bench()
    run.give(TimedPlan((replace(first, v=100.0 * first.v), last)))
    status = run.finish()
    assert (status.phase, status.segment) == (Phase.FAILED, 0)
    assert "velocity limit" in status.reason


def test_a_start_far_from_the_plans_fails(bench, timed) -> None:
    run = bench(START + 0.3 * np.eye(7)[1])
    run.give(timed)
    status = run.finish()
    assert (status.phase, status.segment) == (Phase.FAILED, 0)
    assert "left_s1 is 0.300 rad away" in status.reason
    np.testing.assert_allclose(run.get("desired_state")[7:], 0.0)


def test_a_set_point_out_of_reach_fails_in_its_segment(bench, timed) -> None:
    run = bench()
    run.give(shifted(timed, (0.0, 0.0, 2.0)))
    status = run.finish()
    assert (status.phase, status.segment) == (Phase.FAILED, 1)
    assert "out of reach" in status.reason
    assert 0.0 < run.get("progress")[0] < 1.0
    q = run.get("desired_state")[:7]
    assert (run.executor.arm.margin(q) >= -1e-9).all()


def test_it_keeps_the_velocity_limits_even_then(bench, arm, timed) -> None:
    run = bench()
    run.give(shifted(timed, (0.3, 0.3, 0.0)))
    for _ in run.steps(timed.duration):
        v = run.get("desired_state")[7:]
        assert (np.abs(v) <= arm.velocity_limits * (1 + 1e-6)).all()


def test_an_arm_that_does_not_follow_is_blocked(bench, timed) -> None:
    run = bench()
    stuck = np.concatenate([START, np.zeros(7)])
    run.held = lambda state: stuck
    run.give(timed)
    status = run.finish()
    assert (status.phase, status.segment) == (Phase.FAILED, 0)
    assert "blocked" in status.reason
    np.testing.assert_allclose(run.get("desired_state"), stuck)


def test_an_end_effector_that_does_not_arrive_fails(bench, timed) -> None:
    run = bench(tolerances=Tolerances(settling=0.1))
    run.held = lambda state: state + 0.01 * np.eye(14)[0]
    run.give(timed)
    status = run.finish()
    assert (status.phase, status.segment) == (Phase.FAILED, 1)
    assert "off the end" in status.reason


def test_another_plan_begins_after_one_has_ended(bench, arm, timed) -> None:
    run = bench()
    run.give(TimedPlan(()))
    assert run.finish().phase is Phase.FAILED
    run.give(TimedPlan(timed.segments[:1]))
    for _ in run.steps(2 * PERIOD):
        pass
    assert run.get("status").phase is Phase.RUNNING
    assert run.finish().phase is Phase.DONE
    run.give(TimedPlan(timed.segments[1:]))
    for _ in run.steps(2 * PERIOD):
        pass
    assert run.get("status").phase is Phase.RUNNING
    assert run.finish().phase is Phase.DONE
    far, _ = apart(arm.pose(run.get("desired_state")[:7]), timed.segments[-1].X_WB)
    assert far < 2e-4


def test_taking_the_plan_away_stops_the_arm(bench, timed) -> None:
    run = bench()
    run.give(timed)
    for _ in run.steps(0.3):
        pass
    run.give(None)
    for _ in run.steps(2 * PERIOD):
        pass
    assert run.get("status").phase is Phase.IDLE
    np.testing.assert_array_equal(run.get("desired_state")[7:], 0.0)


def test_the_ports_are_named_as_documented(arm) -> None:
    executor = ScrewPlanExecutor(arm)
    inputs = [executor.get_input_port(i).get_name() for i in range(executor.num_input_ports())]
    outputs = [executor.get_output_port(i).get_name() for i in range(executor.num_output_ports())]
    assert inputs == ["plan", "measured_state"]
    assert outputs == ["desired_state", "status", "progress"]
    for name in (*inputs, *outputs):
        assert f"{name}: " in ScrewPlanExecutor.__doc__
    assert executor.HasAnyDirectFeedthrough() is False


def test_statuses_read_well(bench, timed) -> None:
    run = bench()
    assert str(run.get("status")) == "idle"
    run.give(timed)
    for _ in run.steps(2 * PERIOD):
        pass
    assert str(run.get("status")) == "running in segment 1"


def test_apart_agrees_with_the_screws_library() -> None:
    from drake_screw.screws import rotation_angle, translation_distance

    rng = np.random.default_rng(0)
    for scale in (1e-9, 1e-3, 1.0, 3.0):
        X_WA = exp(rng.standard_normal(6))
        w = rng.standard_normal(3)
        w *= scale / np.linalg.norm(w)
        X_WB = X_WA @ pose(exp(np.array([*w, 0, 0, 0]))[:3, :3], rng.standard_normal(3))
        far, turned = apart(X_WA, X_WB)
        assert far == pytest.approx(translation_distance(X_WA, X_WB))
        assert turned == pytest.approx(rotation_angle(X_WA, X_WB), rel=1e-6, abs=1e-15)
