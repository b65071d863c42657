"""Inverse kinematics of the hand, reach, rectangles, tables and starts."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from drake_screw.onboarding.arms import find_arms
from drake_screw.onboarding.hand_ik import kinematics, range_of, solve, spread
from drake_screw.onboarding.reach import HOLDS, reach_map
from drake_screw.onboarding.reading import read_robot
from drake_screw.onboarding.rectangles import Rectangle, best_rectangle
from drake_screw.onboarding.start import starts
from drake_screw.onboarding.table import stands_on_the_table, table_under
from drake_screw.robot import ObjectConfig, RobotConfig, Workcell, build_workcell
from drake_screw.screws import pose

IIWA = tuple(f"iiwa_joint_{i}" for i in range(1, 8))


@pytest.fixture(scope="module")
def workcell() -> Workcell:
    return build_workcell(
        RobotConfig("iiwa14", IIWA, "hand", (0.0,) * 7),
        table=table_under(Rectangle((0.4, 0.8), (-0.5, 0.5)), 0.0, around_the_base=True),
        objects=[ObjectConfig("bowl", 0.08, 0.06)],
    )


def test_kinematics_are_those_of_the_plant(workcell: Workcell) -> None:
    arm = workcell.arm
    q = spread(range_of(arm.screw_chain()), 20)
    X, J = kinematics(arm.screw_chain(), q)
    for i in range(len(q)):
        assert X[i] == pytest.approx(arm.pose(q[i]), abs=1e-9)
        assert J[i] == pytest.approx(arm.jacobian(q[i]), abs=1e-9)


def test_hands_come_where_they_are_wanted(workcell: Workcell) -> None:
    chain = workcell.arm.screw_chain()
    within = range_of(chain)
    rng = np.random.default_rng(0)
    q = rng.uniform(0.6 * within.lower, 0.6 * within.upper, (60, 7))
    wanted = chain.pose(q)
    begin = q + rng.normal(0.0, 0.3, q.shape)
    found, there = solve(chain, within, wanted[:, :3, 3], wanted[:, :3, 2], begin)
    assert there.mean() > 0.9
    X = chain.pose(found[there])
    assert X[:, :3, 3] == pytest.approx(wanted[there, :3, 3], abs=1e-3)
    assert np.sum(X[:, :3, 2] * wanted[there, :3, 2], axis=1) == pytest.approx(1.0, abs=1e-4)
    assert (within.margin(found) >= 0.0).all()


def test_what_is_out_of_reach_is_not_reached(workcell: Workcell) -> None:
    chain = workcell.arm.screw_chain()
    x, y = np.array([0.6, 1.3]), np.array([-0.3, 0.0, 0.3])
    found = reach_map(chain, range_of(chain), x, y, 0.0, HOLDS["pouring"])
    assert (found.share[0] > 0.5).all()
    assert (found.share[1] == 0.0).all()


@given(st.lists(st.lists(st.booleans(), min_size=5, max_size=5), min_size=4, max_size=4))
@settings(max_examples=60, deadline=None)
def test_no_rectangle_is_larger(rows: list[list[bool]]) -> None:
    good: NDArray[np.bool_] = np.array(rows)
    x, y = np.arange(4.0), np.arange(5.0)
    found = best_rectangle(x, y, good, most=(2.0, 3.0), middle=(1.5, 2.0))
    areas = [
        (k - i) * (m - j)
        for i in range(4)
        for k in range(i + 1, min(i + 3, 4))
        for j in range(5)
        for m in range(j + 1, min(j + 4, 5))
        if good[i : k + 1, j : m + 1].all()
    ]
    assert (0.0 if found is None else found.area) == max(areas, default=0.0)
    if found is not None:
        assert good[found.holds(x[:, None], y[None, :])].all()


def test_starts_are_level_far_from_limits_and_touch_nothing(workcell: Workcell) -> None:
    chain = workcell.arm.screw_chain()
    within = range_of(chain)
    found = starts(workcell, chain, within, Rectangle((0.4, 0.8), (-0.5, 0.5)), 0.0, 3, "pouring")
    assert len(found) == 3
    q = np.array([start.q for start in found])
    assert (np.abs(chain.pose(q)[:, 2, 2]) < 0.2).all()
    assert (within.margin(q) > 0.15).all()
    assert not workcell.collides(q, pose(np.eye(3), [[0.0, 0.0, 1e3]])).any()
    again = starts(workcell, chain, within, Rectangle((0.4, 0.8), (-0.5, 0.5)), 0.0, 3, "pouring")
    assert again == found


def test_an_iiwa_stands_on_the_table_and_baxter_before_it() -> None:
    for model, names, hand, expected in (
        ("iiwa14", IIWA, "hand", True),
        ("baxter", None, "left_hand", False),
    ):
        read = read_robot(model)
        arms = find_arms(read)
        config = RobotConfig(model, names or arms[0].joints, hand, (0.0,) * 7)
        chain = build_workcell(config).arm.screw_chain()
        assert stands_on_the_table(read, arms[0], len(arms) - 1, chain) is expected
