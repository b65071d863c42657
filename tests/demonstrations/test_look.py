"""What a look at a recording says agrees with the recording itself."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from drake_screw.demonstrations import (
    FaithfulConfig,
    Look,
    SegmentationConfig,
    demonstration_from_recording,
    look_at,
)
from drake_screw.demonstrations.deviations import deviations_from_screws
from drake_screw.demonstrations.look_summary import summarized
from drake_screw.demonstrations.shown import what_is_shown
from drake_screw.screws import exp, pose
from tests.demonstrations.test_demonstration import reach, sliding_hand

FAITHFUL, PUBLISHED = FaithfulConfig(), SegmentationConfig()
CHAIN = sliding_hand()
ARM = SimpleNamespace(
    pose=CHAIN.pose, lower=CHAIN.lower, upper=CHAIN.upper, units=("m", "m", "m", "rad")
)
NAMES = ("jug", "mug")


def looked(config=FAITHFUL, objects: int = 2, **changes) -> Look:
    recording = replace(reach(objects), **changes)
    return look_at(what_is_shown(recording, ARM, config, names=NAMES[:objects]), ARM)


def test_a_known_deviation_is_found_sample_by_sample() -> None:
    """Beside a straight screw, along it at a steady pace: a bump of known height and tilt."""
    s = np.linspace(0.0, 1.0, 201)
    bump = np.sin(np.pi * s) ** 2
    path = pose(np.eye(3), np.stack([0.2 * s, 0.008 * bump, np.full(201, 0.2)], axis=1))
    path = path @ exp(np.stack([0.05 * bump, *np.zeros((5, 201))], axis=1))
    bowl = pose(np.eye(3), [[0.1, 0.0, 0.0]])
    (found,) = deviations_from_screws(
        path, bowl, np.linalg.inv(bowl) @ path[[0, -1]], np.zeros(2, dtype=np.int64), FAITHFUL
    )
    assert found.samples.tolist() == list(range(201))
    np.testing.assert_allclose(found.position, 0.008 * bump, atol=2e-4)
    np.testing.assert_allclose(found.rotation, 0.05 * bump, atol=1e-6)


@pytest.mark.parametrize("config", [FAITHFUL, PUBLISHED])
def test_it_is_what_is_learned(config) -> None:
    look = looked(config)
    learned = demonstration_from_recording(reach(2), ARM, config, names=NAMES)
    np.testing.assert_array_equal(look.demonstration.X_OE, learned.X_OE)
    assert look.demonstration.fidelity == learned.fidelity
    assert str(look).startswith(f"demo_01: {learned.fidelity[0]}; {learned.fidelity[1]}")
    for kept, near in zip(learned.fidelity, look.deviations, strict=True):
        assert (kept.position, kept.rotation) == (near.position.max(), near.rotation.max())
        assert NAMES[near.object] == kept.object


@pytest.mark.parametrize("config", [FAITHFUL, PUBLISHED])
def test_screws_lead_from_guiding_pose_to_guiding_pose(config) -> None:
    look = looked(config)
    starts = [segment.start for segment in look.screws]
    assert starts == sorted(starts)
    owners = look.demonstration.objects
    assert len(look.screws) == len(owners) - 1 - np.count_nonzero(np.diff(owners))
    for segment in look.screws:
        assert segment.end > segment.start
        np.testing.assert_allclose(exp(segment.screw.twist) @ segment.X_WA, segment.X_WB, atol=1e-9)


def test_what_is_dropped_and_what_is_kept_make_up_the_recording() -> None:
    look = looked(objects=1)
    (visit,) = look.shown.regions.visits
    first, last = look.t[visit.start], look.t[visit.stop - 1]
    outside = "outside the region of interest"
    assert [(d.start, d.end, d.why) for d in look.dropped] == [
        (0.0, first, outside),
        (last, look.t[-1], outside),
    ]
    assert (look.distance[visit.start : visit.stop, 0] <= look.radius[0]).all()


def test_the_published_method_says_what_its_guiding_poses_leave_out() -> None:
    look = looked(PUBLISHED, objects=1)
    guides = look.t[look.demonstration.kept]
    dropped = sum(d.end - d.start for d in look.dropped)
    assert dropped == pytest.approx(look.recording.duration - (guides[-1] - guides[0]))


def test_another_visit_is_told() -> None:
    there_and_back = reach(1)
    q = np.concatenate([there_and_back.q, there_and_back.q[::-1]])
    look = looked(objects=1, q=q, t=0.01 * np.arange(len(q)))
    assert len(look.shown.regions.left_out) == 1
    assert [d.why for d in look.dropped].count("another visit to the jug") == 1
    counts = [visit.counts for visit in summarized(look).objects[0].visits]
    assert sorted(counts) == [False, True]


def test_a_refused_recording_can_be_looked_at() -> None:
    look = looked(objects=1, X_WO=pose(np.eye(3), [[0.5, -0.7, 0.1]]))
    assert (look.demonstration, look.deviations, look.screws) == (None, (), ())
    assert str(look) == f"demo_01: not used: {look.refused.message}"
    found = summarized(look)
    assert found.refused.reason == "far"
    assert sum(d.end - d.start for d in found.dropped) == pytest.approx(found.duration)
    assert found.objects[0].distance == pytest.approx(0.7)
    assert "bystander" in str(found.objects[0])


def test_tolerances_are_those_of_the_method() -> None:
    assert looked().tolerances == (0.010, 0.1)
    position, angle = looked(PUBLISHED).tolerances
    assert (position, 2.0 * np.sin(angle / 4.0)) == pytest.approx((0.015, 0.15))


def test_the_published_method_is_measured_in_its_own_region() -> None:
    assert looked(PUBLISHED, region_of_interest=2.0).radius == pytest.approx(
        2.0 * looked().shown.regions.smallest
    )
    assert (
        looked(replace(PUBLISHED, region_of_interest=1.2)).shown.measure.region_of_interest == 1.2
    )


def test_joints_and_objects_in_numbers() -> None:
    look = looked()
    found, q = summarized(look), reach(2).q
    x, wrist = found.joints[0], found.joints[3]
    assert (x.least, x.greatest, x.lower, x.upper) == (q[:, 0].min(), q[:, 0].max(), -1.0, 1.0)
    assert (x.margin, x.limit) == (pytest.approx(0.5), "upper")
    assert look.t[np.argmax(q[:, 0] > 0.4999)] <= x.at
    assert (wrist.unit, wrist.margin) == ("rad", 1.0)
    assert found.tightest is found.joints[1]
    assert [item.distance for item in found.objects] == pytest.approx([0.1, 0.1], abs=1e-3)
    assert found.samples == 801
    assert (found.rate, found.longest_gap) == pytest.approx((100.0, 0.01))
