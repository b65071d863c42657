"""The axis of the hand that `init` leaves free on an arm of five joints."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drake_screw.onboarding.free_axis import free_axis
from drake_screw.robot.directions import least
from tests.planning.compiled_arms import random_chain
from tests.planning.test_position_and_axis import five_joints

START = (0.0, -0.6, 1.0, -0.4, 0.0)


def test_it_lets_the_arm_move_all_through_the_roll_of_the_task() -> None:
    chain = five_joints().screw_chain()
    y = np.pi / 2.0
    out = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    home = chain.home.copy()
    home[:3, :3], home[2, 3] = home[:3, :3] @ out, home[2, 3] - 0.05  # z out of the hand
    chain = replace(chain, home=home)
    axis = free_axis(chain, START, "pouring")
    assert axis is not None
    rolled = np.tile(START, (11, 1))
    worst = {}
    for sign in (1.0, -1.0):
        rolled[:, 4] = sign * np.linspace(0.0, y, 11)
        worst[sign] = least(chain, rolled, axis).min()
    assert max(worst.values()) > 0.1
    assert least(chain, rolled, (0.0, 0.0, 1.0)).max() < 0.01


def test_six_joints_have_no_need_of_it() -> None:
    rng = np.random.default_rng(2)
    assert free_axis(random_chain(rng, 6), (0.1,) * 6, "pouring") is None
    assert free_axis(random_chain(rng, 4), (0.1,) * 4, "pouring") is None
