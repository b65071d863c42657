"""Attempts on Baxter, with guiding poses that are known to do what they do."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import BatchPlanner, Cause
from drake_screw.planning.outcomes import one_outcome
from drake_screw.planning.touching import cut_short
from drake_screw.robot import (
    BoxShape,
    ObjectConfig,
    ObstacleConfig,
    PlacedShape,
    SphereShape,
    ToolConfig,
    Workcell,
    build_workcell,
)
from drake_screw.screws import exp, pose
from drake_screw.screws.poses import inverse
from drake_screw.tasks import WorkArea
from drake_screw.visualization.attempt import (
    AHEAD,
    DONE,
    FAILED,
    Attempt,
    attempt,
    collided,
    describe_segment,
    headline,
)
from drake_screw.visualization.inspector import Inspector
from drake_screw.visualization.linkage import Linkage
from drake_screw.web.area_map import work_area_map
from drake_screw.web.arm_sketch import arm_sketch
from drake_screw.web.attempt_tables import attempt_record, attempts_csv, attempts_json
from drake_screw.web.charts import joint_chart, joint_curves, strip
from drake_screw.web.inspector_panel import attempt_entry, drawn_state
from tests.visualization.conftest import BOWL
from tests.visualization.test_scene import BAXTER, TABLE

OBJECTS = (ObjectConfig("bowl", 0.08, 0.06),)


@pytest.fixture(scope="module")
def workcell() -> Workcell:
    return build_workcell(BAXTER, table=TABLE, objects=OBJECTS)


def shift(x: float, y: float, z: float) -> np.ndarray:
    return pose(np.eye(3), np.array([x, y, z]))


def turned(X_WE: np.ndarray, axis: int, angle: float) -> np.ndarray:
    twist = np.zeros(6)
    twist[axis] = angle
    return X_WE @ exp(twist)


def tried(workcell: Workcell, *guides: np.ndarray) -> Attempt:
    """An attempt at guiding poses in W."""
    X_WO = np.eye(4)[None]
    X_OE = inverse(X_WO[0]) @ np.array(guides)
    owner = np.zeros(len(guides), dtype=np.int64)
    kept = np.arange(len(guides))
    demonstration = Demonstration("made", X_OE, owner, X_WO, np.array(guides), kept)
    planner = BatchPlanner(workcell.arm.screw_chain())
    plan = planner.plan(demonstration, X_WO, workcell.start)
    return attempt(workcell.arm, 0, demonstration, X_WO, plan)


@pytest.fixture(scope="module")
def easy(workcell) -> Attempt:
    X = workcell.arm.pose(workcell.start)
    back = shift(-0.1, 0, 0) @ X
    return tried(workcell, back, turned(back, 2, 0.8))


@pytest.fixture(scope="module")
def limited(workcell) -> Attempt:
    """The last joint turns about the end effector's z axis: 3.05 rad to its limit, from 0."""
    X = workcell.arm.pose(workcell.start)
    guides = [shift(-0.05, 0, 0) @ X]
    for _ in range(3):
        guides.append(turned(shift(0.0, 0.0, 0.02) @ guides[-1], 2, 1.6))
    return tried(workcell, *guides)


def test_a_success_has_no_failure(easy) -> None:
    assert easy.cause == Cause.SUCCESS
    assert easy.status == (DONE, DONE)
    assert easy.failed_segment is None
    assert easy.failed_joint is None
    assert headline(easy).startswith("succeeds in all 2 screw segments")
    joint, margin = easy.tightest
    assert margin == pytest.approx(easy.margin[:, joint].min())


def test_a_joint_at_its_limit_is_named(limited) -> None:
    assert limited.cause == Cause.JOINT_LIMIT
    assert limited.failed_segment is not None
    assert limited.failed_segment > 0
    assert limited.status.count(FAILED) == 1
    assert limited.status.index(FAILED) == limited.failed_segment
    assert set(limited.status[limited.failed_segment + 1 :]) <= {AHEAD}
    assert limited.margin[-1, limited.failed_joint] == pytest.approx(0.0, abs=1e-9)
    name = limited.arm.joint_names[limited.failed_joint]
    text = headline(limited)
    assert re.search(rf"segment {limited.failed_segment + 1} of 4.*{name} reaches its (\w+)", text)
    q, arm = limited.plan.q[-1, limited.failed_joint], limited.arm
    which = "upper" if q > (arm.lower + arm.upper)[limited.failed_joint] / 2 else "lower"
    assert f"its {which} limit" in text


def test_screws_are_told_in_numbers(easy) -> None:
    assert describe_segment(easy, 0) == "10.0 cm, straight"
    assert describe_segment(easy, 1).startswith("45.8°, +0.0 cm") or describe_segment(
        easy, 1
    ).startswith("45.8°, −0.0 cm")
    assert easy.straight(0)
    assert not easy.straight(1)
    assert easy.axis_distance(1) == pytest.approx(0.0, abs=1e-6)


def test_samples_keep_the_ends_of_segments(limited) -> None:
    samples = limited.samples(20)
    assert samples[0] == 0
    assert samples[-1] == len(limited.plan.q) - 1
    for segment in range(limited.failed_segment):
        end = np.flatnonzero(limited.plan.segment == segment)[-1]
        assert end in samples
    assert len(samples) <= 20 + len(limited.guides) + 2


def test_a_plan_is_cut_short_where_it_collides(easy) -> None:
    plan = cut_short(easy.plan, one_outcome(Cause.COLLISION, 1, -1, 0.5))
    assert not plan.success
    assert plan.segment[-1] == 1
    assert plan.s[-1] == 0.5
    middle = np.stack([np.interp(1.5, easy.progress, angle) for angle in easy.plan.q.T], axis=-1)
    np.testing.assert_allclose(plan.q[-1], middle, atol=1e-12)
    assert len(plan.q) < len(easy.plan.q)


def test_numbers_of_an_attempt_are_those_of_its_plan(limited) -> None:
    record = json.loads(attempts_json([limited], {"round": 1}, WorkArea((BOWL,))))
    (told,) = record["attempts"]
    assert told["outcome"] == "joint_limit"
    assert told["segment"] == limited.failed_segment
    assert [s["status"] for s in told["segments"]] == list(limited.status)
    assert told["segments"][1]["angle"] == pytest.approx(1.6)
    rows = attempts_csv([limited]).splitlines()
    assert len(rows) == 1 + len(limited.plan.q)
    assert rows[0].count(",") == rows[-1].count(",") == 2 + 2 * limited.arm.n


def test_charts_are_drawings(limited, workcell, make_round, regions) -> None:
    samples = limited.samples(50)
    chart = ElementTree.fromstring(joint_chart(limited))
    lines = [e for e in chart.iter() if e.tag == "polyline"]
    assert len(lines) == limited.arm.n
    curve = joint_curves(limited)[limited.failed_joint]
    drawn = ElementTree.fromstring(strip(limited, curve, samples))
    (line,) = [e for e in drawn.iter() if e.tag == "polyline"]
    y = [float(p.split(",")[1]) for p in line.get("points").split()]
    assert min(abs(y[-1] - 2.0), abs(y[-1] - 22.0)) < 0.01
    event = make_round(regions, [0, 3, 10, 5, 0, 1])
    drawn = ElementTree.fromstring(work_area_map(event, regions, here=event.suggestion.coordinates))
    assert len([e for e in drawn.iter() if e.get("class") == "cell"]) == regions.K
    sketch = arm_sketch(limited, Linkage(workcell), WorkArea((BOWL,)), OBJECTS, TABLE)
    ElementTree.fromstring(f"<div>{sketch}</div>")


def test_sketches_show_obstacles_and_the_tool_at_both_ends(limited, workcell) -> None:
    wall = ObstacleConfig("wall", PlacedShape(BoxShape((0.1, 0.4, 0.5)), (1.0, 0.2, 0.3)))
    tool = ToolConfig("left_hand", PlacedShape(SphereShape(0.05)), (0.0, 0.0, 0.1))
    sketch = arm_sketch(
        limited, Linkage(workcell), WorkArea((BOWL,)), OBJECTS, TABLE, obstacles=[wall], tool=tool
    )
    above, side = (
        [
            np.array([p.split(",") for p in e.get("points").split()], dtype=float)
            for e in figure.iter("polygon")
        ]
        for figure in ElementTree.fromstring(f"<div>{sketch}</div>")
    )
    assert len(above) == len(side) == 3
    np.testing.assert_allclose(
        [above[0].min(axis=0), above[0].max(axis=0)], [[-400, -1050], [0, -950]]
    )
    np.testing.assert_allclose(
        [side[0].min(axis=0), side[0].max(axis=0)], [[950, -550], [1050, -50]]
    )
    X_WE = workcell.arm.pose(limited.plan.q[[0, -1]])
    centers = (X_WE @ [0.0, 0.0, 0.1, 1.0])[:, :3]
    for seen, p in zip(above[1:], centers, strict=True):
        middle = (seen.min(axis=0) + seen.max(axis=0)) / 2.0
        np.testing.assert_allclose(middle, [-1e3 * p[1], -1e3 * p[0]], atol=1.5)


def test_links_and_joint_frames_are_where_the_plant_has_them(workcell) -> None:
    linkage = Linkage(workcell)
    q = np.array([workcell.start, workcell.start])
    q[1, 0] += 0.5
    X_WL = linkage.poses(q)
    hand = linkage.names.index("baxter/left_hand")
    assert np.allclose(X_WL[:, hand], workcell.arm.pose(q), atol=1e-9)
    for joint in range(workcell.arm.n):
        X_WJ = linkage.joint_frames(joint, q[:1])[0]
        J = workcell.arm.jacobian(q[0])[:, joint]
        assert np.allclose(X_WJ[:3, 2], J[:3], atol=1e-9)
        arm = workcell.arm.pose(q[0])[:3, 3] - X_WJ[:3, 3]
        assert np.allclose(np.cross(J[:3], arm), J[3:], atol=1e-9)


def test_what_is_drawn_and_what_moves(limited, workcell, meshcat) -> None:
    inspector = Inspector(meshcat, [workcell], OBJECTS)
    inspector.show_instance(limited.X_WO)
    drawn = inspector.draw(limited)
    for path in (
        "/instance/bowl",
        "/attempts/01/ghost/baxter/left_hand",
        "/attempts/01/dial/limit",
    ):
        assert meshcat.HasPath(path), path
    assert meshcat.HasPath("/attempts/01/segments/01/way")
    assert not meshcat.HasPath("/attempts/01/segments/01/rest")
    failed = limited.failed_segment + 1
    assert meshcat.HasPath(f"/attempts/01/segments/{failed:02d}/rest")
    assert meshcat.HasPath(f"/attempts/01/axes/{failed:02d}/turn")
    assert np.allclose(
        drawn.moving["/workcell/baxter/left_hand"],
        workcell.arm.pose(limited.plan.q[drawn.samples]),
        atol=1e-9,
    )
    state = drawn_state(drawn)
    assert state["at"][state["start"]][0] == limited.failed_segment
    assert len(state["moving"]["/workcell/baxter/left_hand"]) == len(drawn.samples)
    json.dumps(state)
    inspector.clear()
    assert not meshcat.HasPath("/attempts")


def test_a_success_has_no_ghost(easy, workcell, meshcat) -> None:
    Inspector(meshcat, [workcell], OBJECTS).draw(easy)
    assert not meshcat.HasPath("/attempts/01/ghost")
    assert not meshcat.HasPath("/attempts/01/dial")


def test_bodies_that_touch_are_drawn_where_they_do(easy, workcell, meshcat) -> None:
    pair = next(i for i in range(len(workcell.pairs)) if workcell.touching(i)[1] == "bowl")
    robot, _ = workcell.touching(pair)
    outcome = replace(one_outcome(Cause.COLLISION, 1, -1, 0.5), pair=np.array(pair, np.int16))
    tried = collided(easy, outcome, workcell)
    assert headline(tried).endswith(f"50.0% along it: {robot} touches bowl")
    assert attempt_record(tried)["touching"] == [[robot, "bowl"]]
    drawn = Inspector(meshcat, [workcell], OBJECTS).draw(tried)
    assert meshcat.HasPath("/attempts/01/ghost/baxter/left_hand")
    for path in (f"baxter/{robot}", "bowl/bowl"):
        assert meshcat.HasPath(f"/attempts/01/ghost/touching/{path}"), path
    assert not meshcat.HasPath("/attempts/01/ghost/touching/table")
    for seen in (None, drawn):
        words = attempt_entry(0, "made", outcome, seen, workcell)["words"]
        assert words == f"collision in segment 2, 50% along it: {robot}, bowl"


def test_a_tilted_object_is_sketched_as_the_cylinder_it_is(limited, workcell) -> None:
    lying = limited.X_WO.copy()
    lying[0, :3, :3] = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    tilted = replace(limited, X_WO=lying)
    sketch = arm_sketch(tilted, Linkage(workcell), WorkArea((BOWL,)), OBJECTS, TABLE)
    above, _ = ElementTree.fromstring(f"<div>{sketch}</div>")
    (outline,) = [e.get("points") for e in above.iter("polygon")]
    points = np.array([p.split(",") for p in outline.split()], dtype=float)
    extent = np.ptp(points, axis=0)
    bowl = OBJECTS[0]
    np.testing.assert_allclose(extent, [2e3 * bowl.radius, 1e3 * bowl.height], atol=2.0)
