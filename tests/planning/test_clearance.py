"""Bounds between two points of a path: on how far parts of the arm stray, and on one another."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import BatchPlanner, Cause, Plan, paths
from drake_screw.planning.collisions import CollisionFreePlanner
from drake_screw.planning.outcomes import one_outcome
from drake_screw.planning.plan_checker import SLACK, PlanChecker
from drake_screw.robot import ObjectConfig, RobotConfig, Workcell, build_workcell
from drake_screw.screws import inverse, pose
from tests.robot.small_arms import JointText, sdf

BALL = "<sphere><radius>0.03</radius></sphere>"
SCISSORS = (
    JointText("turn", "0 0 0.5 0 0 0"),
    JointText("left", "0.5 0 0 0 0 0", kind="fixed"),
    JointText("between", "0 0 0 0 0 0", parent="turn_link"),
    JointText("open", "0 0 0 0 0 0"),
    JointText("right", "0.5 0 0 0 0 0", kind="fixed"),
)
PLANAR = (
    JointText("p1", "0 0 0.2 0 0 0"),
    JointText("p2", "0.5 0 0 0 0 0"),
    JointText("p3", "0.4 0 0 0 0 0"),
)
POLE = ObjectConfig("pole", 0.02, 0.6)
BENT = np.array([0.4, 0.9, 0.4])
SEVEN = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
START = (1.0434904, -0.2201262, -0.7470486, 1.5243934, 1.8818109, -0.9687089, -0.4908739)


def workcell_of(
    file: Path, joints: tuple[JointText, ...], start: np.ndarray, balls: tuple[str, ...]
) -> Workcell:
    """A planar arm with balls on links, and a pole."""
    file.write_text(sdf(joints, hand="0.1 0 0 0 0 0", shapes=dict.fromkeys(balls, BALL)))
    names = tuple(joint.name for joint in joints if joint.kind != "fixed")
    return build_workcell(RobotConfig(str(file), names, "hand", tuple(start)), objects=[POLE])


@pytest.fixture(scope="module")
def scissors(tmp_path_factory: pytest.TempPathFactory) -> PlanChecker:
    """Two balls, 0.5 m from the axis that both turn about."""
    file = tmp_path_factory.mktemp("models") / "scissors.sdf"
    return PlanChecker(workcell_of(file, SCISSORS, np.zeros(3), ("left_link", "right_link")))


def straight(*q: list[float]) -> Plan:
    """A plan of one segment with these points."""
    s = np.linspace(0.0, 1.0, len(q))
    done = one_outcome(Cause.SUCCESS)
    return Plan(np.array(q), np.zeros(len(q), dtype=int), s, done, np.eye(4)[None])


def standing(x: float, y: float) -> np.ndarray:
    """X_WO (1, 1, 4, 4) of the pole."""
    return pose(np.eye(3), np.array([[[x, y, 0.2]]]))


def test_parts_that_swap_places_meet_in_between(scissors: PlanChecker) -> None:
    """Each moves as far as the gap is wide: each needs a bound of half the gap."""
    plan = straight([-0.2, 0.0, 0.4], [0.2, 0.0, -0.4])
    away = standing(-2.0, 0.0)
    assert not scissors.workcell.collides(plan.q, away[0]).any()
    found = scissors.first_collisions([plan], away)
    assert found.collides[0]
    assert 0.2 < found.fraction[0] < 0.5


def test_what_a_straight_line_just_misses_is_looked_at(scissors: PlanChecker) -> None:
    """A ball goes past the pole on an arc; it is clear of the pole along the chord."""
    q = np.array([[-0.1, 0.0, 2.0], [0.1, 0.0, 2.0]])

    def spare(x: float) -> float:
        """By how much distances at the ends are larger than the chord, at the tighter sphere."""
        distance, p = scissors.bubbles(q, np.repeat(standing(x, 0.0), 2, axis=0))
        return float((distance.sum(axis=0) - np.linalg.norm(p[1] - p[0], axis=-1)).min())

    near, far = 0.55, 1.5
    for _ in range(60):
        middle = (near + far) / 2.0
        near, far = (middle, far) if spare(middle) < SLACK / 2.0 else (near, middle)
    assert 0.0 < spare(far) < SLACK
    scissors.asked = 0
    assert not scissors.first_collisions([straight(*q)], standing(far, 0.0)).collides[0]
    assert scissors.asked > 0
    scissors.asked = 0
    assert not scissors.first_collisions([straight(*q)], standing(far + SLACK, 0.0)).collides[0]
    assert scissors.asked == 0


def test_no_part_goes_much_further_than_straight(monkeypatch: pytest.MonkeyPatch) -> None:
    """From one point of a plan to the next, by any place on the way in between."""
    workcell = build_workcell(RobotConfig("baxter", SEVEN, "left_hand", START))
    arm, rng = workcell.arm, np.random.default_rng(8)
    one, lessons = np.eye(4)[None], []
    for i in range(12):
        X = arm.pose(np.array(START) + np.cumsum(rng.uniform(-0.4, 0.4, (4, 7)), axis=0))
        lessons.append(Demonstration(f"walk_{i}", X, np.zeros(4, int), one, X, np.arange(4)))
    planner, checker = BatchPlanner(arm.screw_chain()), PlanChecker(workcell)
    given = lessons, np.tile(one, (12, 1, 1, 1)), START, np.arange(12)
    coarse = planner.plans(*given)
    monkeypatch.setattr(paths, "SPACING", paths.SPACING / 16.0)
    monkeypatch.setattr(paths, "FEWEST", paths.FEWEST * 16)
    fine = planner.plans(*given)
    assert sum(plan.success for plan in coarse) >= 4
    longest = []
    for plan, dense in zip(coarse, fine, strict=True):
        progress = plan.segment + plan.s
        k = np.searchsorted(progress, dense.segment + dense.s, side="right")
        k = np.clip(k, 1, len(progress) - 1)
        a, b, p = (
            checker.bubbles(q, np.zeros((len(q), 0, 4, 4)))[1]
            for q in (plan.q[k - 1], plan.q[k], dense.q)
        )
        way = np.linalg.norm(p - a, axis=-1) + np.linalg.norm(b - p, axis=-1)
        longest.append((way - np.linalg.norm(b - a, axis=-1)).max())
    assert 1e-7 < max(longest) <= SLACK


def test_an_arm_of_three_joints_is_checked_for_collisions(tmp_path: Path) -> None:
    """Once with the pole out of the way, once where the arm's last link comes through."""
    workcell = workcell_of(tmp_path / "planar.sdf", PLANAR, BENT, ("p2_link", "p3_link"))
    X = workcell.arm.pose(BENT + np.cumsum([[0.2, -0.3, 0.2], [-0.5, 0.3, 0.2]], axis=0))
    batch = BatchPlanner(workcell.arm.screw_chain())
    planner = CollisionFreePlanner(batch, workcell)

    def lesson(X_WO: np.ndarray) -> Demonstration:
        X_OE = inverse(X_WO[0]) @ X
        return Demonstration("flat", X_OE, np.zeros(2, int), X_WO, X, np.arange(2))

    away = standing(-1.0, -1.0)
    within = standing(*(X[1, :2, 3] - 0.1 * X[1, :2, 0]))
    for X_WO, code in ((away, "0:0"), (within, "2:c")):
        lessons = [lesson(X_WO[0])]
        assert batch.all_outcomes(lessons, X_WO, BENT).codes() == "0:0"
        for answer in (planner.all_outcomes, planner.any_success):
            assert answer(lessons, X_WO, BENT).codes() == code
    hit = planner.checker.explain(batch.plan(lesson(within[0]), within[0], BENT), within[0])
    assert hit is not None
    assert ("p3_link", "pole") in hit.bodies
