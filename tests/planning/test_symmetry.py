"""Symmetric bodies: which turns there are, in which order, and what planning makes of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_screw.demonstrations import Demonstration
from drake_screw.planning import BatchPlanner, Cause, Outcomes, Symmetries
from drake_screw.robot import Arm
from drake_screw.screws import exp, inverse, pose, pose_from_planar
from drake_screw.tasks import Symmetry
from tests.planning.test_batch import MIDDLE, REACHING, demonstration

N = 60
ROUND, SQUARE = Symmetry(), Symmetry(turns=4)
TILTED = Symmetry((0.6, 0.0, 0.8))
X_ET = pose(Rotation.from_rotvec([0.3, -0.4, 0.2]).as_matrix(), [0.02, 0.01, 0.1])


@pytest.fixture(scope="module")
def lessons(seven: Arm) -> tuple[Demonstration, ...]:
    """Of the first object, of the second one, and of both."""
    rng, made = np.random.default_rng(3), []
    for i, objects in enumerate(([0, 0, 0], [1, 1], [0, 1, 1])):
        steps = rng.uniform(-0.3, 0.3, (len(objects), seven.n))
        X_WE = seven.pose(REACHING + np.cumsum(steps, axis=0))
        X_WO = pose_from_planar(MIDDLE + rng.uniform(-0.05, 0.05, (2, 3)))
        made.append(demonstration(X_WE, X_WO, np.array(objects), f"demo_{i}"))
    return tuple(made)


@pytest.fixture(scope="module")
def places() -> np.ndarray:
    """(N, 2, 4, 4) poses of two objects, the second one not upright."""
    rng = np.random.default_rng(4)
    X_WO = pose_from_planar(MIDDLE + rng.uniform(-1.0, 1.0, (N, 2, 3)) * [0.4, 0.45, 3.0])
    X_WO[:, 1] = X_WO[:, 1] @ exp(rng.normal(size=(N, 6)) * [0.3, 0.3, 0.3, 0.0, 0.0, 0.0])
    return X_WO


def planner_with(arm: Arm, *objects: Symmetry | None, tool=None, tried: int = 8) -> BatchPlanner:
    chain = arm.screw_chain()
    return BatchPlanner(chain, symmetries=Symmetries.of(chain, objects, tool, X_ET, tried))


def rotation(axis: tuple[float, float, float], angle: float) -> np.ndarray:
    return pose(Rotation.from_rotvec(np.array(axis) * angle).as_matrix(), np.zeros(3))


def turned_by_hand(
    lesson: Demonstration, symmetries: Symmetries, angles: np.ndarray
) -> Demonstration:
    """A demonstration whose guiding poses are turned one by one, by scipy's rotations."""
    X_OE = lesson.X_OE.copy()
    for i, owner in enumerate(lesson.objects):
        symmetry = symmetries.objects[owner]
        if symmetry is not None:
            X_OE[i] = rotation(symmetry.axis, angles[owner]) @ X_OE[i]
        if symmetries.tool is not None:
            turn = rotation(symmetries.tool.axis, angles[-1])
            X_OE[i] = X_OE[i] @ X_ET @ turn @ inverse(X_ET)
    return replace(lesson, X_OE=X_OE)


@pytest.mark.parametrize(
    ("objects", "tool", "turns"),
    [
        ((ROUND, None), None, (8, 1, 8)),
        ((SQUARE, TILTED), None, (4, 8, 32)),
        ((None, SQUARE), Symmetry((1.0, 0.0, 0.0), 2), (2, 8, 8)),
    ],
)
def test_each_turn_is_the_demonstration_turned_by_hand(
    seven: Arm, lessons, places, objects, tool, turns
) -> None:
    planner, plain = planner_with(seven, *objects, tool=tool), BatchPlanner(seven.screw_chain())
    for lesson, count in zip(lessons, turns, strict=True):
        found = planner.variant_outcomes(lesson, places, REACHING)
        assert found.shape == (N, count)
        for i in range(0, N, 7):
            for turn in range(count):
                angles = planner.symmetries.angles(lesson, places[i], turn)
                by_hand = turned_by_hand(lesson, planner.symmetries, angles)
                (expected,) = plain.all_outcomes([by_hand], places[i : i + 1], REACHING)[:, 0]
                assert found.cause[i, turn] == expected.cause
                assert found.segment[i, turn] == expected.segment
                assert found.fraction[i, turn] == pytest.approx(float(expected.fraction), abs=1e-4)


@pytest.fixture(scope="module")
def turning(seven: Arm) -> BatchPlanner:
    return planner_with(seven, ROUND, SQUARE)


@pytest.fixture(scope="module")
def each(turning: BatchPlanner, lessons, places) -> list[Outcomes]:
    """Outcomes (N, T) of each demonstration's turns."""
    return [turning.variant_outcomes(lesson, places, REACHING) for lesson in lessons]


def test_an_outcome_is_that_of_the_first_turn_that_succeeds(
    turning: BatchPlanner, lessons, places, each
) -> None:
    found = turning.all_outcomes(lessons, places, REACHING)
    for d, turns in enumerate(each):
        np.testing.assert_array_equal(found.success[:, d], turns.any_success)
        solved = np.flatnonzero(turns.any_success)
        np.testing.assert_array_equal(
            found.variant[solved, d], turns.success[solved].argmax(axis=1)
        )
        assert 5 < len(solved) < N - 5
    assert len(np.unique(found.variant[found.success])) > 2


def test_a_failure_tells_the_best_attempt_over_all_turns(
    turning: BatchPlanner, lessons, places, each
) -> None:
    found = turning.all_outcomes(lessons, places, REACHING)
    for d, turns in enumerate(each):
        for i in np.flatnonzero(~turns.any_success):
            came = turns.segment[i] + 0.5 * turns.fraction[i].astype(float)
            assert found.variant[i, d] == came.argmax()
            at = i, int(found.variant[i, d])
            assert found.cause[i, d] == turns.cause[at]
            assert found.joint[i, d] == turns.joint[at]
            assert found.fraction[i, d] == turns.fraction[at]


def test_any_success_finds_what_all_turns_of_all_demonstrations_find(
    turning: BatchPlanner, lessons, places
) -> None:
    whole = turning.all_outcomes(lessons, places, REACHING)
    some = turning.any_success(lessons, places, REACHING)
    np.testing.assert_array_equal(some.any_success, whole.any_success)
    tried = some.cause != Cause.NOT_TRIED
    assert tried[~whole.any_success].all()
    assert (some.success.sum(axis=1) <= 1).all()
    for name in ("cause", "segment", "joint", "fraction", "variant"):
        np.testing.assert_array_equal(getattr(some, name)[tried], getattr(whole, name)[tried])


def test_plans_have_the_outcomes_and_guiding_poses_of_their_turns(
    turning: BatchPlanner, lessons, places, seven: Arm
) -> None:
    found = turning.all_outcomes(lessons, places, REACHING)
    which = np.arange(N) % 3
    turn = found.variant[np.arange(N), which]
    for i, plan in enumerate(turning.plans(lessons, places, REACHING, which, turn)):
        assert plan.outcome.cause == found.cause[i, which[i]]
        assert plan.outcome.variant == turn[i]
        by_hand = turned_by_hand(lessons[which[i]], turning.symmetries, plan.angles)
        np.testing.assert_allclose(plan.guides, by_hand.transfer(places[i]), atol=1e-12)
        if plan.success:
            np.testing.assert_allclose(seven.pose(plan.q[-1]), plan.guides[-1], atol=2e-3)
    with pytest.raises(ValueError, match="variant must be one"):
        turning.plans(lessons, places, REACHING, which, turn + 99)


def test_a_body_of_revolution_may_stand_at_any_yaw(turning: BatchPlanner, lessons, places) -> None:
    """Turned about its axis it is the same instance, so all is the same but the angle."""
    before = turning.all_outcomes(lessons[:1], places, REACHING)
    moved = places.copy()
    moved[:, 0] = moved[:, 0] @ rotation(ROUND.axis, 1.234)
    after = turning.all_outcomes(lessons[:1], moved, REACHING)
    for name in ("cause", "segment", "joint", "variant"):
        np.testing.assert_array_equal(getattr(before, name), getattr(after, name))
    X_WE = [
        s.guides(lessons[0], X, s.angles(lessons[0], X, before.variant[:, 0]))
        for s, X in ((turning.symmetries, places), (turning.symmetries, moved))
    ]
    np.testing.assert_allclose(*X_WE, atol=1e-9)


@pytest.mark.parametrize(("angle", "same"), [(np.pi / 2, True), (np.pi / 4, False)])
def test_a_square_is_the_same_after_a_quarter_turn_only(
    turning: BatchPlanner, lessons, places, angle: float, same: bool
) -> None:
    """All its turns are tried, so that success is the same; which is found first may not be."""
    before = turning.all_outcomes(lessons[1:2], places, REACHING)
    moved = places.copy()
    moved[:, 1] = moved[:, 1] @ rotation(SQUARE.axis, angle)
    after = turning.all_outcomes(lessons[1:2], moved, REACHING)
    assert np.array_equal(before.success, after.success) is same


def test_first_of_all_the_recorded_motion_is_swung_about_the_first_joint(
    seven: Arm, lessons, places
) -> None:
    """Objects that are swung, then turned about their axis, are reached as they were recorded."""
    symmetries = planner_with(seven, ROUND, TILTED).symmetries
    for lesson in lessons[:2]:
        owner = int(lesson.objects[0])
        swing = exp(seven.screw_chain().screws[0] * 0.7)
        axis = symmetries.objects[owner].axis
        X_WO = swing @ lesson.X_WO
        X_WO[owner] = X_WO[owner] @ rotation(axis, 2.0)
        angles = symmetries.angles(lesson, X_WO)
        assert np.remainder(angles[owner] + 2.0, 2 * np.pi) == pytest.approx(0.0, abs=1e-9)
        found = symmetries.guides(lesson, X_WO, angles)
        np.testing.assert_allclose(found, swing @ lesson.transfer(lesson.X_WO), atol=1e-9)


def test_turns_go_to_both_sides_the_smaller_ones_first(seven: Arm, lessons) -> None:
    symmetries = planner_with(seven, ROUND, SQUARE, tried=5).symmetries
    steps = symmetries.away(lessons[0], 2)[:, 0] / (2 * np.pi / 5)
    np.testing.assert_allclose(steps, [0, 1, -1, 2, -2])
    both = symmetries.away(lessons[2], 2)
    assert both.shape == (20, 3)
    assert len(np.unique(both.round(9), axis=0)) == 20
    assert (np.diff(np.abs(both).sum(axis=1)) >= -1e-9).all()
    assert not both[:, 2].any()


def test_a_tool_turns_about_its_own_axis(seven: Arm, lessons, places) -> None:
    symmetries = planner_with(seven, None, None, tool=ROUND).symmetries
    for turn in range(8):
        angles = symmetries.angles(lessons[0], places[0], turn)
        before, after = lessons[0].transfer(places[0]) @ X_ET, None
        after = symmetries.guides(lessons[0], places[0], angles) @ X_ET
        np.testing.assert_allclose(after[:, :3, 3], before[:, :3, 3], atol=1e-12)
        np.testing.assert_allclose(after[:, :3, 2], before[:, :3, 2], atol=1e-12)
        moved = np.linalg.norm(after[:, :3, 0] - before[:, :3, 0], axis=-1)
        np.testing.assert_allclose(moved, 2 * np.sin(abs(angles[-1]) / 2), atol=1e-12)


def test_a_turned_body_is_named_with_its_angle(seven: Arm, lessons, places) -> None:
    symmetries = planner_with(seven, ROUND, TILTED, tool=SQUARE).symmetries
    angles = symmetries.angles(lessons[2], places[0], 3)
    found = symmetries.named(lessons[2], places[0], angles, ["bowl", "cup"])
    assert [turn.body for turn in found] == ["bowl", "cup", "tool"]
    for turn, angle in zip(found, angles, strict=True):
        assert np.remainder(turn.angle - angle + 1.0, 2 * np.pi) == pytest.approx(1.0)
        assert -np.pi < turn.angle <= np.pi
    tilted = places[0, 1, :3, :3] @ TILTED.axis
    np.testing.assert_allclose(found[1].X_FT[:3, 2], tilted, atol=1e-12)
    assert str(replace(found[0], angle=-0.35)) == "the bowl turned by −20°"
    assert symmetries.named(lessons[0], places[0], angles, ["bowl", "cup"])[0].body == "bowl"


@pytest.mark.parametrize("kept", [{"turns": 0}, {"axis": (0.0, 0.0, 2.0)}])
def test_a_symmetry_has_a_unit_axis_and_turns(kept) -> None:
    with pytest.raises(ValueError, match="must be"):
        Symmetry(**kept)
