"""Reports measured on logs made up for the purpose."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.execution import Contact, ExecutionStatus, Phase, TimedPlan
from drake_screw.execution.report import make_report

DONE = ExecutionStatus(Phase.DONE, 1)
TOUCH = Contact(("left_hand", "bowl"), 0.4, 0, 12.0)


@pytest.fixture
def perfect(timed):
    """Times, positions and velocities of a log that is the plan itself."""
    return timed.sampled(0.002)


def test_the_plan_itself_is_flawless(timed, arm, perfect) -> None:
    report = make_report(timed, arm, *perfect, DONE, ())
    assert report.flawless
    assert report.tracking.position < 1e-5
    assert report.tracking.rotation < 1e-5
    assert report.final.position < 1e-5
    assert len(report.screws) == 2
    assert report.time == pytest.approx(timed.duration)
    margin = arm.margin(perfect[1])
    assert report.worst_margin == margin.min()
    assert report.worst_joint == arm.joint_names[np.argmin(margin.min(axis=0))]


def test_a_late_end_effector_is_off_its_set_point_but_on_its_screw(timed, arm, perfect) -> None:
    t, q, v = perfect
    late = np.concatenate([np.repeat(q[:1], 20, axis=0), q[:-20]])
    report = make_report(timed, arm, t, late, v, DONE, ())
    assert report.tracking.position > 5e-3
    on_the_way = report.screws[0]
    assert on_the_way.position < 1e-4
    assert on_the_way.rotation < 1e-4


def test_an_offset_is_seen_in_every_measure(timed, arm, perfect) -> None:
    t, q, v = perfect
    q = q + 0.01 * np.eye(arm.n)[1]
    report = make_report(timed, arm, t, q, v, DONE, ())
    reach = np.linalg.norm(arm.jacobian(q[0])[3:, 1])
    assert report.tracking.position == pytest.approx(0.01 * reach, rel=0.2)
    assert report.tracking.rotation == pytest.approx(0.01, rel=1e-3)
    assert report.tracking.rotation_rms == pytest.approx(0.01, rel=1e-3)
    assert report.final.position == pytest.approx(0.01 * reach, rel=0.2)
    assert max(d.rotation for d in report.screws) > 1e-3


def test_joints_outside_their_limits_are_named(timed, arm, perfect) -> None:
    t, q, v = perfect
    q = q.copy()
    q[7, 2] = arm.lower[2] - 0.01
    report = make_report(timed, arm, t, q, v, DONE, ())
    assert report.outside == ("left_e0",)
    assert report.worst_joint == "left_e0"
    assert report.worst_margin == pytest.approx(-0.01)
    assert not report.flawless


def test_velocities_over_the_limit_are_seen(timed, arm, perfect) -> None:
    t, q, v = perfect
    v = v.copy()
    v[5, 4] = -1.2 * arm.velocity_limits[4]
    report = make_report(timed, arm, t, q, v, DONE, ())
    assert report.velocity == pytest.approx(1.2)
    assert not report.flawless


@pytest.mark.parametrize(
    ("status", "contacts"),
    [(DONE, (TOUCH,)), (ExecutionStatus(Phase.FAILED, 0, "blocked"), ())],
)
def test_contacts_and_failures_are_flaws(timed, arm, perfect, status, contacts) -> None:
    report = make_report(timed, arm, *perfect, status, contacts)
    assert not report.flawless
    assert report.contacts == contacts


def test_only_segments_that_were_begun_are_measured(timed, arm, perfect) -> None:
    t, q, v = (values[:40] for values in perfect)
    assert len(make_report(timed, arm, t, q, v, DONE, ()).screws) == 1


def test_an_empty_plan_has_nothing_to_measure(arm, perfect) -> None:
    t, q, v = (values[:2] for values in perfect)
    report = make_report(TimedPlan(()), arm, t, q, v, DONE, ())
    assert report.screws == ()
    assert report.planned == 0.0
