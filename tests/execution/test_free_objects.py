"""Objects that can be pushed: they rest where they stand, and how far they are pushed is said."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.execution import Phase, TimedPlan, build_station, simulate
from drake_screw.execution.allowed import Allowed, Flaw
from drake_screw.execution.free_objects import displacements, poses, unsettled
from drake_screw.robot import ObjectConfig, TableConfig
from drake_screw.screws import exp, pose
from tests.execution.conftest import START

BOWL = ObjectConfig("bowl", 0.08, 0.06)
TOP = -0.0645
TABLE = TableConfig((0.85, 0.25), (0.7, 1.3), TOP)
FAR = pose(np.eye(3), [[0.9, 0.6, TOP]])


@pytest.fixture(scope="module")
def station(robot):
    return build_station(robot, table=TABLE, objects=[BOWL], free_objects=True)


def test_what_is_not_touched_stays_where_it_settled(station, timed) -> None:
    execution = simulate(station, timed, FAR)
    (bowl,) = execution.report.moved
    assert execution.report.flawless
    assert bowl.position < 1e-6
    assert bowl.rotation < 1e-6
    assert bowl.time is None
    assert execution.report.contacts == ()
    assert execution.X_WO.shape == (len(execution.t), 1, 4, 4)
    assert execution.thinned(10).X_WO.shape == (len(execution.thinned(10).t), 1, 4, 4)


def test_set_down_half_a_millimetre_too_high_does_not_count_as_pushed(station, timed) -> None:
    above = FAR + np.array([[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 5e-4], [0, 0, 0, 0]])
    execution = simulate(station, timed, above)
    assert execution.report.flawless
    assert execution.report.moved[0].position < 1e-5
    assert execution.X_WO[0, 0, 2, 3] == pytest.approx(TOP, abs=5e-5)


def test_what_hangs_in_the_air_is_no_place_to_execute_at(station, timed) -> None:
    execution = simulate(station, timed, FAR + 0.05 * np.eye(4)[2][:, None] * np.eye(4)[3])
    status = execution.report.status
    assert (status.phase, status.segment) == (Phase.FAILED, None)
    assert "the bowl does not rest where it stands: by itself it falls by 50.0 mm" in status.reason
    assert np.abs(execution.q - START).max() < 1e-6
    assert not execution.report.flawless


def test_a_pushed_bowl_is_reported_with_how_far_it_went(robot, arm, timed) -> None:
    """A tall one in the way of the hand, on a table that is low enough to let the hand by."""
    way = arm.pose(timed.segments[0].q[[0, -1]])[:, :3, 3]
    toward = (way[1] - way[0])[:2] / np.linalg.norm((way[1] - way[0])[:2])
    ahead = way[1, :2] + 0.04 * toward
    floor = way[:, 2].min() - 0.25
    low = TableConfig((0.85, 0.25), (1.4, 1.6), floor)
    station = build_station(
        robot,
        table=low,
        objects=[ObjectConfig("pot", 0.05, 0.2, 0.5, friction=0.1)],
        free_objects=True,
    )
    plan = TimedPlan(timed.segments[:1])
    execution = simulate(station, plan, pose(np.eye(3), [[*ahead, floor]]))
    report = execution.report
    (pot,) = report.moved
    assert report.pushed == (pot,)
    went = execution.X_WO[:, 0, :3, 3] - execution.X_WO[0, 0, :3, 3]
    assert pot.position == pytest.approx(np.linalg.norm(went, axis=1).max())
    assert 2e-3 < pot.position < 0.2
    assert went[-1, :2] @ toward > 2e-3
    assert pot.time is not None
    first = report.flaws[0]
    assert (first.kind, first.time) == (Flaw.PUSHED, pot.time)
    assert f"the pot is pushed by {1e3 * pot.position:.1f} mm" in first.words
    assert {flaw.kind for flaw in report.flaws} >= {Flaw.PUSHED, Flaw.CONTACT}
    assert all("table" not in contact.bodies for contact in report.contacts)
    assert report.force == max(contact.force for contact in report.contacts) > 0.0
    lenient = Allowed(displacement=1.0, turn=4.0, contact_force=1e6)
    again = simulate(station, plan, pose(np.eye(3), [[*ahead, floor]]), allowed=lenient)
    assert again.report.moved == report.moved
    assert {flaw.kind for flaw in again.report.flaws} <= {Flaw.NOT_DONE, Flaw.OFF}


def test_encoders_that_are_off_lead_the_hand_off_its_way(station, arm, timed) -> None:
    """What the arm does is judged by where it is, not by where its encoders say that it is."""
    offset = np.array([0.0, 0.03, 0.0, 0.0, 0.0, 0.0, 0.0])
    execution = simulate(station, timed, FAR, joint_offset=offset)
    assert execution.report.status.phase is Phase.DONE
    q = np.array(START)
    apart = np.linalg.norm((arm.pose(q + offset) - arm.pose(q))[:3, 3])
    assert apart > 0.01
    assert execution.report.tracking.position == pytest.approx(apart, rel=0.2)
    np.testing.assert_allclose(execution.q[0], q + offset, atol=1e-9)
    (flaw,) = execution.report.flaws
    assert flaw.kind is Flaw.OFF
    assert flaw.time == 0.0
    assert f"{1e3 * execution.report.tracking.position:.1f} mm" in flaw.words


def test_where_it_ought_to_go_is_what_counts(station, timed) -> None:
    """All guiding poses 6 mm to the side of those planned for, as for a bowl measured wrong."""
    aside = timed.poses.copy()
    aside[1:, 1, 3] += 6e-3
    planned = simulate(station, timed, FAR).report
    report = simulate(station, timed, FAR, wanted=timed.moved(aside)).report
    assert report.final.position == pytest.approx(6e-3, abs=planned.final.position)
    assert report.tracking.position == pytest.approx(6e-3, abs=planned.tracking.position)
    assert report.screws[0].position > planned.screws[0].position
    assert report.flawless
    strict = simulate(
        station, timed, FAR, wanted=timed.moved(aside), allowed=Allowed(position=3e-3)
    ).report
    assert [flaw.kind for flaw in strict.flaws] == [Flaw.OFF]


def test_displacements_are_from_the_first_pose_on() -> None:
    t = np.arange(4) * 0.1
    X_WO = np.stack(
        [
            exp(np.array([0, 0, a, x, 0, 0]))
            for a, x in zip([0, 0, 0.1, 0.05], [0, 5e-5, 0.01, 0], strict=True)
        ]
    )
    (bowl,) = displacements(["bowl"], t, X_WO[:, None])
    assert bowl.position == pytest.approx(np.linalg.norm(X_WO[2, :3, 3]))
    assert bowl.rotation == pytest.approx(0.1)
    assert bowl.time == pytest.approx(0.2)


def test_poses_of_free_bodies_are_read_off_their_positions(station) -> None:
    X = pose(exp(np.array([0.3, -0.2, 1.0, 0, 0, 0]))[:3, :3], [0.8, 0.1, 0.2])
    root = station.context(START, X[None])
    context = station.plant.GetMyContextFromRoot(root)
    start = station.objects[0].floating_positions_start()
    positions = station.plant.GetPositions(context)[start : start + 7]
    np.testing.assert_allclose(poses(positions[None]), X[None], atol=1e-12)


def test_a_millimetre_by_itself_is_no_rest() -> None:
    moved = FAR.copy()
    moved[0, 0, 3] += 1.1e-3
    assert unsettled(["bowl"], FAR, FAR) == ""
    assert "the bowl does not rest where it stands: by itself it is moved (1.1 mm" in unsettled(
        ["bowl"], FAR, moved
    )
