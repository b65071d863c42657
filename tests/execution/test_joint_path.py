"""The baseline: the joint path by the clock."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.common.value import Value

from drake_screw.execution import JointPathSource, Phase, TimedPlan, Tolerances


@pytest.fixture
def source(arm):
    return JointPathSource(arm)


@pytest.fixture
def context(source, arm, timed):
    context = source.CreateDefaultContext()
    source.GetInputPort("plan").FixValue(context, Value[object](timed))
    at = np.concatenate([timed.segments[-1].q[-1], np.zeros(arm.n)])
    source.GetInputPort("measured_state").FixValue(context, at)
    return context


def test_it_plays_the_path(source, context, timed) -> None:
    for t in np.linspace(0.0, timed.duration, 9):
        context.SetTime(t)
        point = timed.at(t)
        desired = source.GetOutputPort("desired_state").Eval(context)
        np.testing.assert_array_equal(desired, [*point.q, *point.v])
        assert source.GetOutputPort("progress").Eval(context) == [t / timed.duration]


def test_it_is_done_when_the_measured_end_effector_is(source, context, timed) -> None:
    status = source.GetOutputPort("status")
    context.SetTime(0.1)
    assert status.Eval(context).phase is Phase.RUNNING
    context.SetTime(timed.duration)
    assert status.Eval(context).phase is Phase.DONE


def test_an_end_effector_elsewhere_fails_after_settling(source, context, timed) -> None:
    off = np.concatenate([timed.segments[0].q[0], np.zeros(7)])
    source.GetInputPort("measured_state").FixValue(context, off)
    status = source.GetOutputPort("status")
    context.SetTime(timed.duration + 0.01)
    assert status.Eval(context).phase is Phase.RUNNING
    context.SetTime(timed.duration + Tolerances().settling + 0.01)
    assert status.Eval(context).phase is Phase.FAILED


@pytest.mark.parametrize("nothing", [None, TimedPlan(())])
def test_without_a_plan_it_rests(source, context, arm, nothing) -> None:
    source.GetInputPort("plan").FixValue(context, Value[object](nothing))
    desired = source.GetOutputPort("desired_state").Eval(context)
    np.testing.assert_allclose(desired, [*(arm.lower + arm.upper) / 2, *np.zeros(7)])
    assert source.GetOutputPort("status").Eval(context).phase is Phase.IDLE
