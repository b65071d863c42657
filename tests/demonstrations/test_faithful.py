"""Faithful segmentation keeps what was shown: checked by a search that knows nothing of it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drake_screw.demonstrations import Recording, read_library
from drake_screw.demonstrations.faithful import (
    FaithfulConfig,
    faithful_guiding_poses,
    faithful_segments,
    thin,
)
from drake_screw.demonstrations.fewest_screws import fewest_screws
from drake_screw.demonstrations.fidelity import fidelity
from drake_screw.robot import Arm
from drake_screw.screws import (
    exp,
    pose,
    pose_from_planar,
    rotation_angle,
    sclerp,
    translation_distance,
)

DEFAULT = FaithfulConfig()
EVERYWHERE = FaithfulConfig(region_of_interest=1e3, reach=1e3)
ABOVE = pose(np.eye(3), [0.0, 0.0, 0.0])[None]
X_AXIS, Y_AXIS, Z_AXIS = np.eye(3)


def held_in_order(
    samples: np.ndarray, guides: np.ndarray, place: float = 0.010, turn: float = 0.1
) -> bool:
    """Whether every sample has a point of the sampled screws within both tolerances, in order.

    Each is given the first such point from that of the sample before on.
    """
    track = np.concatenate([sclerp(A, B, np.linspace(0.0, 1.0, 1501)) for A, B in pairwise(guides)])
    p, q, at = track[:, :3, 3], track[:, :3, :3].reshape(-1, 9), 0
    least_trace = 1.0 + 2.0 * np.cos(turn)
    for X in samples:
        while True:
            ahead = slice(at, at + 500)
            near = np.sum((p[ahead] - X[:3, 3]) ** 2, axis=1) <= place**2
            near &= q[ahead] @ X[:3, :3].ravel() >= least_trace
            if near.any():
                break
            at += 500
            if at >= len(track):
                return False
        at += int(np.argmax(near))
    return True


def moved(*steps: tuple[float, Sequence[float], Sequence[float], int]) -> np.ndarray:
    """A path from the identity: each step turns by an angle about an axis of W while it is shifted.

    Steps are (angle, axis, shift, samples); the frame turns on the spot while its origin goes
    straight on.
    """
    X = [np.eye(4)]
    for angle, axis, shift, count in steps:
        A = X[-1]
        for s in np.arange(1, count + 1) / count:
            R = exp([*(s * angle * np.asarray(axis)), 0.0, 0.0, 0.0])[:3, :3]
            X.append(pose(R @ A[:3, :3], A[:3, 3] + s * np.asarray(shift)))
    return np.stack(X)


# recordings of people


@pytest.fixture(scope="module")
def recordings(shared: Path, calibrated_arm: Arm) -> list[Recording]:
    arm = calibrated_arm
    return [
        recording
        for task in ("pouring", "scooping")
        for recording in read_library(
            shared / "demos" / task, arm.joint_names, arm.lower, arm.upper, objects=1
        )
    ]


def test_every_sample_of_every_recording_is_kept(
    recordings: list[Recording], calibrated_arm: Arm
) -> None:
    counts = []
    for recording in recordings:
        path = calibrated_arm.pose(recording.q)
        X_OE, objects, kept = faithful_guiding_poses(path, recording.X_WO, DEFAULT, t=recording.t)
        distance = translation_distance(path, recording.X_WO)
        near = np.flatnonzero(distance <= 1.5 * distance.min())
        run = np.arange(near[0], near[0] + np.argmax(np.append(np.diff(near), 2) > 1) + 1)
        assert (kept[0], kept[-1]) == (run[0], run[-1])
        assert not objects.any()
        guides = recording.X_WO[objects] @ X_OE
        np.testing.assert_allclose(guides, path[kept], atol=1e-12)
        assert held_in_order(path[run], guides), recording.name
        counts.append(len(kept))
        (measured,) = fidelity(path, recording.t, recording.X_WO, X_OE, objects, ["bowl"], DEFAULT)
        assert measured.position <= 0.010
        assert measured.rotation <= 0.1
    assert np.mean(counts[:16]) <= 8.0
    assert np.mean(counts[16:]) <= 8.0


def disturbed(recording: Recording, noise: float) -> np.ndarray:
    """Its joint angles with Gaussian noise in rad; rounded to 0.01 rad if that is 0."""
    if noise == 0.0:
        return np.round(recording.q, 2)
    return recording.q + np.random.default_rng(1).normal(scale=noise, size=recording.q.shape)


@pytest.mark.slow
def test_coarse_rounding_keeps_the_promise_with_a_guiding_pose_more_at_most(
    recordings: list[Recording], calibrated_arm: Arm
) -> None:
    counts = []
    for recording in recordings:
        plain = faithful_guiding_poses(
            calibrated_arm.pose(recording.q), recording.X_WO, DEFAULT, t=recording.t
        )
        path = calibrated_arm.pose(disturbed(recording, 0.0))
        X_OE, objects, kept = faithful_guiding_poses(path, recording.X_WO, DEFAULT, t=recording.t)
        assert abs(len(kept) - len(plain[2])) <= 1, recording.name
        guides = recording.X_WO[objects] @ X_OE
        assert held_in_order(path[kept[0] : kept[-1] + 1], guides), recording.name
        (measured,) = fidelity(path, recording.t, recording.X_WO, X_OE, objects, ["bowl"], DEFAULT)
        assert measured.position <= 0.010
        assert measured.rotation <= 0.1
        counts.append(len(kept))
    assert np.mean(counts) <= 8.0


@pytest.mark.parametrize("noise", [0.001, 0.002, 0.003])
def test_noise_hardly_changes_the_number_of_guiding_poses_and_the_motion_is_kept(
    recordings: list[Recording], calibrated_arm: Arm, noise: float
) -> None:
    """Noise may throw samples off by more than the tolerances; the motion itself is within them."""
    within = 0
    for recording in recordings[::3]:
        undisturbed = calibrated_arm.pose(recording.q)
        plain = faithful_guiding_poses(undisturbed, recording.X_WO, DEFAULT, t=recording.t)
        path = calibrated_arm.pose(disturbed(recording, noise))
        X_OE, objects, kept = faithful_guiding_poses(path, recording.X_WO, DEFAULT, t=recording.t)
        assert abs(len(kept) - len(plain[2])) <= 1, recording.name
        guides = recording.X_WO[objects] @ X_OE
        assert held_in_order(undisturbed[kept[0] : kept[-1] + 1], guides), recording.name
        samples = path[kept[0] : kept[-1] + 1]
        assert held_in_order(samples, guides, 0.014, 0.14), recording.name
        within += held_in_order(samples, guides)
    assert within >= (3 if noise == 0.003 else 10)


def test_a_wrist_that_turns_on_the_spot(recordings: list[Recording], calibrated_arm: Arm) -> None:
    q = np.tile([0.7, 0.2, -0.75, 1.0, 1.88, -0.9, 0.0], (13, 1))
    q[:, 6] = np.linspace(-0.49, 1.51, 13)
    path = calibrated_arm.pose(q)
    X_WO = path[:1] @ pose(np.eye(3), [0.0, 0.0, 0.25])
    t = 0.1 * np.arange(13)
    X_OE, objects, kept = faithful_guiding_poses(path, X_WO, DEFAULT, t=t)
    assert kept.tolist() == [0, 12]
    (measured,) = fidelity(path, t, X_WO, X_OE, objects, ["cup"], DEFAULT)
    assert measured.turn_kept == pytest.approx(2.0, abs=1e-6)
    assert measured.turn_shown == pytest.approx(2.0, abs=1e-6)


# paths of known screws


@st.composite
def known_screws(draw: st.DrawFn) -> tuple[int, np.ndarray]:
    """1 to 6 screws, some of them pure turns or translations, with noise; and their number."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count, noisy = draw(st.integers(1, 6)), draw(st.booleans())
    knot, parts = exp(rng.uniform(-1.0, 1.0, 6)), []
    for kind in rng.integers(0, 4, count):
        angle = 0.0 if kind == 1 else rng.uniform(0.3, 2.5)
        shift = 0.0 if kind == 2 else rng.uniform(0.05, 0.25)
        w, p = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
        end = knot @ pose(exp([*(angle * w), 0.0, 0.0, 0.0])[:3, :3], shift * p)
        # for a wide arc the shift is not the way: it is at most pi / 2 times as long
        steps = int(max(angle / 0.02, shift / 0.002)) + 2
        parts.append(sclerp(knot, end, np.arange(steps) / steps))
        knot = end
    path = np.concatenate([*parts, knot[None]])
    if noisy:
        v = rng.normal(size=(len(path), 2, 3))
        v *= rng.uniform(0.0, 1.0, (len(path), 2, 1)) / np.linalg.norm(v, axis=2, keepdims=True)
        turned = (
            path[:, :3, :3]
            @ exp(np.insert(v * 0.01, 1, 0.0, axis=1)[:, :2].reshape(-1, 6))[:, :3, :3]
        )
        path = pose(turned, path[:, :3, 3] + 0.002 * v[:, 1])
    return count, path


def screws_of(path: np.ndarray) -> tuple[int, np.ndarray]:
    X_WO = path[:1] @ pose(np.eye(3), [0.3, 0.4, 0.5])
    t = 0.01 * np.arange(len(path))
    X_OE, objects, kept = faithful_guiding_poses(path, X_WO, EVERYWHERE, t=t)
    assert (kept[0], kept[-1]) == (0, len(path) - 1)
    return len(kept) - 1, X_WO[objects] @ X_OE


@settings(deadline=None, max_examples=25)
@given(known_screws(), st.integers(0, 2**32 - 1))
def test_paths_of_known_screws(shown: tuple[int, np.ndarray], seed: int) -> None:
    count, path = shown
    found, guides = screws_of(path)
    assert found <= count
    assert held_in_order(path, guides)
    assert screws_of(path[::-1])[0] == found
    Y = exp(np.random.default_rng(seed).uniform(-2.0, 2.0, 6))
    assert screws_of(Y @ path)[0] == found


@pytest.mark.slow
@settings(deadline=None, max_examples=15)
@given(known_screws(), st.integers(0, 2**32 - 1))
def test_no_other_cuts_do_with_fewer_screws(shown: tuple[int, np.ndarray], seed: int) -> None:
    """Every screw between candidates is tried, by the search that knows nothing of this one."""
    _, path = shown
    some = np.random.default_rng(seed).choice(len(path) - 2, min(8, len(path) - 2), replace=False)
    candidates = np.array([0, *np.sort(some + 1), len(path) - 1])

    def fewest(share: float) -> float:
        screws = np.append(0.0, np.full(len(candidates) - 1, np.inf))
        for j, b in enumerate(candidates):
            for i, a in enumerate(candidates[:j]):
                if rotation_angle(path[a], path[b]) <= 3.0 and held_in_order(
                    path[a : b + 1], path[[a, b]], share * 0.010, share * 0.1
                ):
                    screws[j] = min(screws[j], screws[i] + 1.0)
        return float(screws[-1])

    cuts = fewest_screws(path, candidates, 0.010, 0.1)
    found = len(cuts) - 1 if len(cuts) else np.inf
    assert fewest(1.03) <= found <= fewest(0.97)


# what must not be lost


def test_a_pause_costs_nothing() -> None:
    line = moved((0.0, Z_AXIS, [0.2, 0.0, 0.0], 200))
    paused = np.concatenate([line[:100], np.repeat(line[100:101], 3000, axis=0), line[101:]])
    trembling = paused.copy()
    trembling[:, :3, 3] += np.random.default_rng(0).uniform(-5e-4, 5e-4, (len(paused), 3))
    assert len(faithful_segments(paused, DEFAULT)) == 2
    assert len(faithful_segments(trembling, DEFAULT)) == 2


def test_standing_still_is_one_pose() -> None:
    assert faithful_segments(np.repeat(np.eye(4)[None], 50, axis=0), DEFAULT).tolist() == [0]
    assert faithful_segments(np.eye(4)[None], DEFAULT).tolist() == [0]


def test_descend_turn_in_place_lift() -> None:
    angle = np.deg2rad(69.0)
    path = moved(
        (0.0, Z_AXIS, [0.0, 0.0, -0.1], 100),
        (angle, X_AXIS, [0.0, 0.0, 0.0], 60),
        (0.0, Z_AXIS, [0.0, 0.0, 0.1], 100),
    )
    cuts = faithful_segments(path, DEFAULT)
    assert len(cuts) == 4
    np.testing.assert_allclose(cuts[1:3], [100, 160], atol=4)
    assert rotation_angle(path[cuts[1]], path[cuts[2]]) == pytest.approx(angle, abs=0.06)
    assert held_in_order(path, path[cuts])


@pytest.mark.parametrize("turn", [0.0, 0.6])
def test_to_and_fro_is_kept(turn: float) -> None:
    out = (turn, Z_AXIS, [0.08, 0.0, 0.0], 60)
    back = (-turn, Z_AXIS, [-0.08, 0.0, 0.0], 60)
    path = moved(out, back, out, back)
    cuts = faithful_segments(path, DEFAULT)
    assert len(cuts) == 5
    np.testing.assert_allclose(cuts, [0, 60, 120, 180, 240], atol=4)


@pytest.mark.parametrize("turning", [False, True])
def test_three_circles_are_three_circles(turning: bool) -> None:
    angle = np.linspace(0.0, 6.0 * np.pi, 900)
    p = np.stack([0.05 * np.cos(angle), 0.05 * np.sin(angle), np.full(900, 0.15)], axis=1)
    R = exp(np.insert(np.zeros((900, 5)), 2, angle if turning else 0.0, axis=1))[:, :3, :3]
    path, t = pose(R, p), 0.01 * np.arange(900)
    X_OE, objects, _ = faithful_guiding_poses(path, ABOVE, DEFAULT, t=t)
    assert held_in_order(path, X_OE)
    around = np.unwrap(
        np.concatenate(
            [
                np.arctan2(track[:, 1, 3], track[:, 0, 3])
                for A, B in pairwise(X_OE)
                for track in [sclerp(A, B, np.linspace(0.0, 1.0, 50))]
            ]
        )
    )
    assert around[-1] - around[0] == pytest.approx(6.0 * np.pi, abs=0.01)
    # an end effector that turns along goes a third of a turn and more on one screw
    assert len(X_OE) <= (8 if turning else 17)
    (measured,) = fidelity(path, t, ABOVE, X_OE, objects, ["pot"], DEFAULT)
    assert measured.turn_kept == pytest.approx(6.0 * np.pi if turning else 0.0, abs=0.1)


@pytest.mark.parametrize("angle", [3.0, np.pi - 1e-6, np.pi, np.pi + 0.05, 4.0, 6.2, 2 * np.pi])
def test_turns_near_pi_and_beyond(angle: float) -> None:
    path = moved((angle, Y_AXIS, [0.0, 0.0, 0.0], 150))
    cuts = faithful_segments(path, DEFAULT)
    assert len(cuts) - 1 == np.ceil(angle / 3.0 - 1e-9)
    assert held_in_order(path, path[cuts])
    total = sum(float(rotation_angle(path[a], path[b])) for a, b in pairwise(cuts))
    assert total == pytest.approx(angle, abs=1e-6)


def test_coming_back_all_round_is_not_standing_still() -> None:
    path = pose_from_planar(np.linspace([0.0, 0.0, 0.0], [0.0, 0.0, 2.0 * np.pi - 0.05], 300))
    assert len(faithful_segments(path @ pose(np.eye(3), [0.1, 0.0, 0.0]), DEFAULT)) == 4


def test_sparse_samples_half_a_turn_apart_have_an_answer() -> None:
    path = pose_from_planar([[0.0, 0.0, 0.0], [0.1, 0.0, np.pi], [0.2, 0.0, 0.0]])
    assert faithful_segments(path, DEFAULT).tolist() == [0, 1, 2]


def test_thinning_is_by_place_or_turn_whichever_comes_first() -> None:
    turning = moved((1.0, Z_AXIS, [0.0, 0.0, 0.0], 100), (0.0, Z_AXIS, [0.1, 0.0, 0.0], 100))
    kept = thin(turning, 0.0039, 0.029)
    assert kept[0] == 0
    assert kept[-1] == 200
    np.testing.assert_array_equal(np.diff(kept)[:30], 3)
    np.testing.assert_array_equal(np.diff(kept)[-20:-1], 4)


@pytest.mark.parametrize(
    "wrong",
    [
        {"spacing": 0.0},
        {"spacing": 0.006},
        {"turn_spacing": 0.06},
        {"rotation_tolerance": 1.2},
        {"region_of_interest": 0.9},
    ],
)
def test_tolerances_out_of_range(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        FaithfulConfig(**wrong)
