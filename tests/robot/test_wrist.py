"""How far from its shoulder an arm brings its wrist."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drake_screw.robot import ScrewChain
from drake_screw.robot.wrist import wrist_of


def chain(limit: float = 3.0, limit_of_elbow: float = 2.0) -> ScrewChain:
    """A shoulder at z = 0.3, an elbow 0.4 m above it, a wrist 0.3 m above that, a hand of 0.1 m.

    Joints turn about z, y, y, y, z.
    """
    axes = np.array([[0, 0, 1], [0, 1, 0], [0, 1, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    points = np.array([[0, 0, 0], [0, 0, 0.3], [0, 0, 0.7], [0, 0, 1.0], [0, 0, 0]])
    screws = np.concatenate([axes, np.cross(points, axes)], axis=1)
    home = np.eye(4)
    home[2, 3] = 1.1
    most = np.array([limit, limit, limit_of_elbow, limit, limit])
    return ScrewChain(tuple("abcde"), screws, home, -most, most)


def test_shoulder_and_wrist_are_where_axes_meet() -> None:
    found = wrist_of(chain())
    np.testing.assert_allclose(found.p_WS, [0.0, 0.0, 0.3], atol=1e-12)
    np.testing.assert_allclose(found.p_EC, [0.0, 0.0, -0.1], atol=1e-12)


def test_the_reach_is_that_of_two_links() -> None:
    found = wrist_of(chain())
    assert found.most == pytest.approx(0.7, abs=1e-9)
    folded = np.sqrt(0.4**2 + 0.3**2 + 2.0 * 0.4 * 0.3 * np.cos(2.0))
    assert found.least == pytest.approx(folded, abs=1e-6)


def test_limits_count() -> None:
    bent = chain()
    bent = replace(bent, lower=np.where(np.arange(5) == 2, 1.0, bent.lower))
    expected = np.sqrt(0.4**2 + 0.3**2 + 2.0 * 0.4 * 0.3 * np.cos(1.0))
    assert wrist_of(bent).most == pytest.approx(expected, abs=1e-6)


def test_no_posture_is_beyond_it() -> None:
    arm = chain()
    found = wrist_of(arm)
    q = np.random.default_rng(3).uniform(arm.lower, arm.upper, (5000, arm.n))
    distance = found.distance(arm.pose(q))
    assert found.least - 1e-9 <= distance.min()
    assert distance.max() <= found.most + 1e-9


def test_joints_without_limits_turn_all_the_way() -> None:
    found = wrist_of(chain(np.inf, np.inf))
    assert (found.least, found.most) == pytest.approx((0.1, 0.7), abs=1e-4)


def test_arms_that_slide_or_are_short_have_none() -> None:
    arm = chain()
    screws = arm.screws.copy()
    screws[0] = [0, 0, 0, 0, 0, 1]
    assert wrist_of(replace(arm, screws=screws)) is None
    short = ScrewChain(tuple("abc"), arm.screws[:3], arm.home, arm.lower[:3], arm.upper[:3])
    assert wrist_of(short) is None
