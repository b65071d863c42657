"""Attempts that come to the end of the arm's reach."""

from __future__ import annotations

import json
from xml.etree import ElementTree

import numpy as np
import pytest

from drake_screw.planning import Cause
from drake_screw.planning.contract import RATE_LIMIT
from drake_screw.robot import Workcell, build_workcell
from drake_screw.visualization.attempt import Attempt, headline
from drake_screw.visualization.inspector import Inspector
from drake_screw.visualization.unreachable import explain
from drake_screw.web.attempt_tables import attempt_record
from drake_screw.web.charts import reach_chart, reach_curves, strip
from drake_screw.web.inspector_panel import drawn_state
from tests.visualization.test_attempt import OBJECTS, shift, tried, turned
from tests.visualization.test_scene import BAXTER, TABLE


@pytest.fixture(scope="module")
def workcell() -> Workcell:
    return build_workcell(BAXTER, table=TABLE, objects=OBJECTS)


@pytest.fixture(scope="module")
def far(workcell) -> Attempt:
    """First 5 cm ahead, then 60 cm more."""
    X = workcell.arm.pose(workcell.start)
    return tried(workcell, shift(0.05, 0, 0) @ X, shift(0.65, 0, 0) @ X)


def test_what_is_missing_is_measured(far) -> None:
    assert far.cause == Cause.UNREACHABLE
    found = far.unreachable
    end, guide = far.arm.pose(far.plan.q[-1]), far.guides[far.failed_segment]
    assert found.travel == pytest.approx(np.linalg.norm(guide[:3, 3] - end[:3, 3]))
    assert found.turn == pytest.approx(0.0, abs=1e-3)
    assert f"{100 * found.travel:.1f} cm" in headline(far)


def test_it_is_where_the_planner_draws_the_line(far) -> None:
    found = far.unreachable
    assert found.gain[-1] == pytest.approx(1.0 / RATE_LIMIT, rel=0.1)
    assert (found.gain[:-1] > found.gain[-1]).all()
    assert (found.singular <= found.gain + 1e-12).all()
    J = far.arm.jacobian(far.plan.q[-1])
    assert found.singular[-1] == pytest.approx(np.linalg.norm(J, -2))


def test_the_wrist_is_asked_to_be_farther_off_than_it_gets(far) -> None:
    found, wrist = far.unreachable, far.arm.wrist
    assert found.distance[-1] == pytest.approx(wrist.most, rel=0.01)
    assert found.distance.max() <= wrist.most + 1e-6
    assert found.needed > wrist.most + 0.1
    assert found.out_of_reach
    assert found.stretched
    text = headline(far)
    assert f"needs the wrist {found.needed:.3f} m from the shoulder" in text
    assert f"the arm reaches {wrist.most:.3f} m" in text


def test_a_free_roll_is_left_out(far) -> None:
    rolled = far.plan.guides.copy()
    rolled[1] = turned(rolled[1], 2, 1.0)
    plan = far.plan.__class__(
        **{**vars(far.plan), "guides": rolled, "free_axis": np.array([0.0, 0.0, 1.0])}
    )
    free, bound = explain(far.arm, plan, far.starts), far.unreachable
    assert free.turn == pytest.approx(bound.turn, abs=1e-6)
    assert free.needed == pytest.approx(bound.needed, abs=1e-9)
    assert (free.singular >= bound.singular - 1e-12).all()


def test_others_have_no_such_reason(workcell) -> None:
    X = workcell.arm.pose(workcell.start)
    easy = tried(workcell, shift(-0.1, 0, 0) @ X)
    assert easy.unreachable is None
    assert reach_chart(easy) is None
    assert attempt_record(easy)["unreachable"] is None


def test_it_is_told_drawn_and_written(far, workcell, meshcat) -> None:
    told = json.loads(json.dumps(attempt_record(far)))["unreachable"]
    assert told["at_the_guiding_pose"] == far.unreachable.needed
    assert told["reach"] == [far.arm.wrist.least, far.arm.wrist.most]
    curves = reach_curves(far)
    assert [c.name for c in curves] == ["along the screw", "singular value", "shoulder to wrist"]
    assert all(c.failed for c in curves)
    assert curves[0].height[-1] == pytest.approx(1.0 / 3.0, abs=0.02)
    assert curves[2].asked > curves[2].limits[1]
    drawn = ElementTree.fromstring(strip(far, curves[2], far.samples(60)))
    assert [e.get("class") for e in drawn.iter() if e.get("class") == "asked"] == ["asked"]
    ElementTree.fromstring(reach_chart(far))
    shown = Inspector(meshcat, [workcell], OBJECTS).draw(far)
    for part in ("shoulder", "wrist", "line", "sphere", "asked", "gap"):
        assert meshcat.HasPath(f"/attempts/01/ghost/reach/{part}"), part
    state = drawn_state(shown)
    assert [row["bound"] for row in state["reach"]] == ["limit 0.01", "limit 0.01", "limit 0.814"]
    assert len(state["reach"][0]["values"]) == len(state["at"])
