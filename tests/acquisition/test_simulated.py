from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drake_screw.acquisition.events import Suggestion
from drake_screw.acquisition.simulated import MOTIONS, SimulatedTeacher
from drake_screw.acquisition.simulated.candidate_paths import follow_key_poses
from drake_screw.acquisition.simulated.human import RATE, minimum_jerk, timed, with_hand_noise
from drake_screw.acquisition.simulated.motions import hand_poses, usual_azimuth
from drake_screw.acquisition.teacher import Lesson
from drake_screw.demonstrations import (
    Demonstration,
    Recording,
    demonstration_from_recording,
    read_recording,
    write_recording,
)
from drake_screw.errors import ScenarioError
from drake_screw.planning import BatchPlanner
from drake_screw.robot import ObjectConfig, RobotConfig, TableConfig, Workcell, build_workcell
from drake_screw.screws import inverse, rotation_angle, sclerp, translation_distance
from drake_screw.tasks import ObjectArea, WorkArea

AREA = WorkArea((ObjectArea("bowl", (0.7056, -0.2367, 0.0), (1.0796, 0.7833, 0.0), -0.0645),))
JOINTS = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
START = (1.04349043, -0.22012624, -0.74704864, 1.52439341, 1.88181093, -0.96870887)
LAST = {"pouring": -0.49087385, "scooping": 1.02968460}
MIRROR = np.array([-1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
PLACES = tuple((x, y) for x in (0.7056, 1.0796) for y in (-0.2367, 0.1, 0.45, 0.7833))


def baxter(motion: str, *, right: bool = False) -> Workcell:
    """The shipped arm over a table; the right one mirrored."""
    start = np.array([*START, LAST[motion]])
    side, other, sign = ("right", "left", -1.0) if right else ("left", "right", 1.0)
    return build_workcell(
        RobotConfig(
            "baxter",
            tuple(name.replace("left", side) for name in JOINTS),
            f"{side}_hand",
            tuple(start * MIRROR if right else start),
            parked={f"{other}_s0": -0.767 * sign, f"{other}_e1": 1.575},
        ),
        table=TableConfig((0.85, 0.25 * sign), (0.7, 1.3), -0.0645),
        objects=[ObjectConfig("bowl", 0.08, 0.06)],
    )


def ask(teacher: SimulatedTeacher, x: float, y: float, seed: int, number: int = 0) -> Lesson:
    return teacher.demonstrate(
        Suggestion(0, np.array([[x, y, 0.0]])),
        number=number,
        used=(),
        rng=np.random.default_rng(seed),
    )


@pytest.fixture(scope="module", params=["pouring", "scooping"])
def motion(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def workcell(motion: str) -> Workcell:
    return baxter(motion)


@pytest.fixture(scope="module")
def teacher(workcell: Workcell, motion: str) -> SimulatedTeacher:
    return SimulatedTeacher(workcell, AREA, motion)


@pytest.fixture(scope="module")
def recordings(teacher: SimulatedTeacher) -> list[Recording]:
    """One for each of PLACES, the corners of the work area among them."""
    lessons = [ask(teacher, x, y, seed) for seed, (x, y) in enumerate(PLACES)]
    assert all(lesson.recording is not None for lesson in lessons), [le.remark for le in lessons]
    return [lesson.recording for lesson in lessons if lesson.recording is not None]


@pytest.fixture(scope="module")
def demonstrations(recordings: list[Recording], workcell: Workcell) -> list[Demonstration]:
    return [demonstration_from_recording(r, workcell.arm) for r in recordings]


def test_a_recording_is_that_of_the_request(
    teacher: SimulatedTeacher, workcell: Workcell, motion: str
) -> None:
    lesson = ask(teacher, 0.9, 0.2, seed=0, number=4)
    recording = lesson.recording
    assert recording is not None
    assert recording.name == "demo_05"
    assert recording.joint_names == workcell.arm.joint_names
    np.testing.assert_array_equal(recording.X_WO, AREA.X_WO([[0.9, 0.2, 0.0]]))
    np.testing.assert_allclose(recording.q[0], workcell.start, atol=1e-12)
    np.testing.assert_allclose(np.diff(recording.t), 1.0 / RATE, atol=1e-9)
    assert recording.t[0] == 0.0
    assert motion in lesson.remark
    assert "x=0.90, y=0.20" in lesson.remark


def test_the_same_seed_gives_the_same_recording_and_another_one_another(
    teacher: SimulatedTeacher,
) -> None:
    first, again, other = (ask(teacher, 0.85, 0.3, seed).recording for seed in (1, 1, 2))
    assert first is not None
    assert again is not None
    assert other is not None
    np.testing.assert_array_equal(first.q, again.q)
    end, other_end = first.q[-1], other.q[-1]
    assert np.abs(end - other_end).max() > 0.02
    assert len(first.q) != len(other.q)


def test_people_keep_away_from_limits_and_collisions(
    recordings: list[Recording], workcell: Workcell
) -> None:
    for recording in recordings:
        assert workcell.arm.margin(recording.q).min() >= 0.1
        assert not workcell.collides(recording.q, recording.X_WO).any()


def test_people_are_neither_hasty_nor_slow(recordings: list[Recording], workcell: Workcell) -> None:
    for recording in recordings:
        speed = np.abs(np.diff(recording.q, axis=0)) * RATE
        assert (speed < workcell.arm.velocity_limits).all()
        assert 8.0 <= recording.duration <= 22.0


def test_the_hand_trembles_and_stops(recordings: list[Recording], workcell: Workcell) -> None:
    for recording in recordings:
        p = workcell.arm.pose(recording.q[::2])[:, :3, 3]
        speed = np.linalg.norm(np.diff(p, axis=0), axis=1) * RATE / 2
        middle = speed[100:-25]
        assert (middle > 0.0).all()
        assert np.mean(middle < 0.06) > 0.15


def test_recordings_survive_the_recorders_file(
    recordings: list[Recording], workcell: Workcell, tmp_path: object
) -> None:
    arm = workcell.arm
    for recording in recordings[:2]:
        folder = f"{tmp_path}/{recording.name}"
        write_recording(recording, folder)
        back = read_recording(folder, arm.joint_names, arm.lower, arm.upper, objects=1)
        assert back.notes == ()
        assert back.name == recording.name
        np.testing.assert_allclose(back.t, recording.t, atol=1e-6)
        np.testing.assert_allclose(back.q, recording.q, atol=1e-10)
        np.testing.assert_allclose(back.X_WO, recording.X_WO, atol=1e-12)


def test_segmentation_finds_the_task(
    demonstrations: list[Demonstration], workcell: Workcell, motion: str
) -> None:
    """Few guiding poses, near the bowl, with the motion's roll about the tool's axis in them."""
    for demonstration in demonstrations:
        X = demonstration.X_OE
        assert 3 <= len(X) <= 8
        assert 0.15 < np.linalg.norm(X[:, :3, 3], axis=1).min() < 0.35
        assert (X[:, 2, 3] > 0.05).all()
        level = workcell.arm.pose(workcell.start)
        R_EH = np.swapaxes(X[:, :3, :3], -1, -2) @ _upright_like(level, X)
        tilt = np.abs(np.arctan2(R_EH[:, 1, 0], R_EH[:, 0, 0]))
        assert tilt.max() > np.radians(30)
        assert tilt[-1] < np.radians(25)
        if motion == "pouring":
            assert tilt[0] < np.radians(25)


def _upright_like(X_WH: np.ndarray, X: np.ndarray) -> np.ndarray:
    """Rotations with the z axes of X, and the roll about them of X_WH."""
    z, up = X[:, :3, 2], np.array([0.0, 0.0, 1.0])

    def level(axis: np.ndarray) -> np.ndarray:
        right = np.cross(axis, up) / np.linalg.norm(np.cross(axis, up), axis=-1, keepdims=True)
        return np.stack([np.cross(right, axis), right, axis], axis=-1)

    return level(z) @ level(X_WH[:3, 2]).T @ X_WH[:3, :3]


def test_plans_from_a_demonstration_succeed_where_it_was_given(
    demonstrations: list[Demonstration], workcell: Workcell
) -> None:
    planner = BatchPlanner(workcell.arm.screw_chain())
    works = [planner.all_outcomes([d], d.X_WO[None], workcell.start) for d in demonstrations]
    assert np.mean([w.success.all() for w in works]) >= 0.9


def test_the_approach_suits_the_place(demonstrations: list[Demonstration]) -> None:
    """Across the body for near places at the right, straight ahead for those at the left."""
    azimuth = {
        tuple(d.X_WO[0, :2, 3]): np.degrees(np.arctan2(d.X_OE[1, 1, 2], d.X_OE[1, 0, 2]))
        for d in demonstrations
    }
    assert azimuth[0.7056, -0.2367] < -50.0
    assert azimuth[0.7056, 0.7833] > -45.0


def test_no_demonstration_is_an_answer(teacher: SimulatedTeacher) -> None:
    far = ask(teacher, 1.7, 0.2, seed=0)
    assert far.recording is None
    assert "no feasible demonstration at x=1.70, y=0.20" in far.remark
    assert "192 are out of reach" in far.remark


def test_obstacles_are_a_reason(workcell: Workcell, motion: str) -> None:
    blocked = build_workcell(
        RobotConfig("baxter", JOINTS, "left_hand", tuple(workcell.start)),
        objects=[ObjectConfig("drum", 0.4, 0.9)],
    )
    lesson = ask(SimulatedTeacher(blocked, AREA, motion), 0.85, 0.2, seed=0)
    assert lesson.recording is None
    collided = int(lesson.remark.split(" collide")[0].split()[-1])
    assert collided > 50


def test_the_other_arm_is_led_likewise() -> None:
    workcell = baxter("pouring", right=True)
    area = WorkArea((replace(AREA.objects[0], lower=(0.7, -0.78, -1.0), upper=(1.08, 0.24, 1.0)),))
    lesson = ask(SimulatedTeacher(workcell, area, "pouring"), 0.9, -0.4, seed=0)
    assert lesson.recording is not None
    demonstration = demonstration_from_recording(lesson.recording, workcell.arm)
    planner = BatchPlanner(workcell.arm.screw_chain())
    assert planner.all_outcomes([demonstration], demonstration.X_WO[None], workcell.start).success


def test_an_unknown_motion_is_refused(workcell: Workcell) -> None:
    with pytest.raises(ScenarioError, match="stirring"):
        SimulatedTeacher(workcell, AREA, "stirring")


def test_leading_follows_the_screws_with_the_least_motion(workcell: Workcell) -> None:
    chain, start = workcell.arm.screw_chain(), workcell.start
    goal = chain.pose(start + np.array([0.2, 0.1, -0.1, 0.2, 0.1, 0.2, -0.3]))
    paths = follow_key_poses(chain, start, np.stack([goal, goal])[None], (-np.inf, np.inf))
    first = paths.segment == 0
    hand = chain.pose(paths.q[0, first])
    wanted = sclerp(hand[0], goal, np.linspace(0.0, 1.0, len(hand)))
    assert paths.arrived.all()
    assert translation_distance(hand, wanted).max() < 1e-3
    assert rotation_angle(hand, wanted).max() < 3e-3
    assert np.abs(paths.q[0, ~first] - paths.q[0, first][-1]).max() < 2e-3
    step = paths.q[0, 1] - paths.q[0, 0]
    J = chain.jacobian(paths.q[0, 0])
    assert np.linalg.norm(step - np.linalg.pinv(J) @ (J @ step)) < 0.02 * np.linalg.norm(step)


def test_key_poses_turn_with_the_direction_of_approach(motion: str, workcell: Workcell) -> None:
    rest = workcell.arm.pose(workcell.start)
    path = MOTIONS[motion](np.random.default_rng(0), np.zeros(3))
    p_WO = np.array([0.9, 0.1, -0.06])
    X, turned = (hand_poses(path, np.full(3, a), rest, p_WO) for a in (-0.5, 0.3))
    turn = np.eye(4)
    turn[:2, :2] = [[np.cos(0.8), -np.sin(0.8)], [np.sin(0.8), np.cos(0.8)]]
    about = np.eye(4)
    about[:3, 3] = p_WO
    np.testing.assert_allclose(turned, about @ turn @ inverse(about) @ X, atol=1e-12)
    np.testing.assert_allclose(np.arctan2(X[:, 0, 1, 2], X[:, 0, 0, 2]), -0.5)


def test_the_usual_approach_pushes_the_hand_straight_ahead() -> None:
    rest = np.eye(4)
    rest[:3, :3] = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    assert usual_azimuth(rest, np.array([1.0, 0.0, 0.3])) == pytest.approx(0.0)
    left = usual_azimuth(rest, np.array([1.0, 1.0, 0.0]))
    assert np.radians(35) < left < np.radians(45)
    assert usual_azimuth(rest, np.array([1.0, -1.0, 0.0])) == pytest.approx(-left)


def test_timing_starts_and_stops_at_every_key_pose() -> None:
    q = np.linspace(0.0, 1.0, 21)[:, None] * np.array([1.0, -0.5])
    segment = np.array([0] * 11 + [1] * 10)
    X_WE = np.tile(np.eye(4), (21, 1, 1))
    X_WE[:, 0, 3] = q[:, 0]
    pauses = ((1.0, 1.0), (0.5, 0.5))
    moved = timed(q, segment, X_WE, pauses, np.array([1.0, 1.0]), np.random.default_rng(3))
    speed = np.abs(np.diff(moved, axis=0)) * RATE
    assert speed.max() < 1.0
    assert (np.diff(moved[:, 0]) >= -1e-12).all()
    still = speed[:, 0] < 1e-9
    assert np.count_nonzero(still & (np.abs(moved[1:, 0] - 0.5) < 1e-9)) > 50
    np.testing.assert_allclose(moved[[0, -1]], q[[0, -1]], atol=1e-12)


def test_hand_noise_leaves_the_start_and_moves_the_hand_by_millimetres(workcell: Workcell) -> None:
    chain = workcell.arm.screw_chain()
    q = np.tile(workcell.start, (1200, 1))
    moved = with_hand_noise(chain, q, np.random.default_rng(0))
    np.testing.assert_array_equal(moved[0], q[0])
    away = translation_distance(chain.pose(moved), chain.pose(q))
    assert 0.001 < away[100:].mean() < 0.008
    assert away.max() < 0.02


def test_minimum_jerk_rests_at_both_ends() -> None:
    s = np.linspace(0.0, 1.0, 1001)
    reach = minimum_jerk(s)
    np.testing.assert_allclose(reach[[0, 500, -1]], [0.0, 0.5, 1.0])
    speed = np.gradient(reach, s)
    assert abs(speed[0]) < 1e-4
    assert abs(speed[-1]) < 1e-4
    assert speed.max() == pytest.approx(1.875, rel=1e-4)
