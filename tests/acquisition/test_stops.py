"""Slides and hinges are kept from their stops alike, each in its own measure."""

from __future__ import annotations

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_screw.acquisition.simulated.stops import MARGIN, Stops
from drake_screw.robot import Arm
from tests.robot.six_joints import NAMES, START, urdf


def arm(lift: tuple[float, float]) -> Arm:
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(urdf(lift=lift), ".urdf")
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
    plant.Finalize()
    return Arm(plant, ("lift", *NAMES), "hand")


@pytest.mark.parametrize(
    ("lift", "at", "wanted"),
    [
        ((0.0, 0.25), 0.1, 0.0125),  # a part of its range
        ((-0.4, 0.65), 0.1, 0.02),  # no more than that
        ((0.0, 0.25), 0.005, 0.0025),  # half of what there is at the start
    ],
)
def test_a_slide_is_kept_from_its_ends_by_a_part_of_its_range(lift, at, wanted) -> None:
    found = Stops.of(arm(lift), (at, *START))
    np.testing.assert_allclose(found.wanted, [wanted, *[MARGIN] * 6])


def test_joints_compare_by_the_margin_that_is_wanted_of_them() -> None:
    stops = Stops.of(arm((0.0, 0.25)), (0.1, *START))
    q = np.array([0.1, *START])
    assert stops.margin(q) > 4 * MARGIN
    q[0] = 0.0125
    assert stops.margin(q) == pytest.approx(MARGIN)
    assert stops.kept(q[None])
    q[0] = 0.009
    assert stops.kept(q[None])
    q[0] = 0.008
    assert not stops.kept(q[None])
