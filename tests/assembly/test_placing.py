"""Instances that a user gives, by the names of the objects or as plain numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from drake_screw.assembly.placing import placed
from drake_screw.errors import ScenarioError
from drake_screw.tasks import ObjectArea, WorkArea

BOWL = ObjectArea("bowl", (0.7, -0.2, 0.25), (1.1, 0.8, 0.25), 0.0)
CUP = ObjectArea("cup", (0.5, -0.4, -1.0), (0.5, 0.4, 1.0), 0.0)
STAND = ObjectArea("stand", (0.6, 0.9, 0.5), (0.6, 0.9, 0.5), 0.0)
ONE, TURNING = WorkArea((BOWL,)), WorkArea((CUP,))
TWO, THREE = WorkArea((BOWL, CUP)), WorkArea((BOWL, STAND, CUP))
FORM = "Give bowl=X,Y cup=X,Y,YAW, with X and Y in m, YAW in rad."


@pytest.mark.parametrize(
    ("area", "instance", "expected"),
    [
        (ONE, (0.8, -0.1), [[0.8, -0.1, 0.25]]),
        (ONE, (0.8, -0.1, 0.5), [[0.8, -0.1, 0.5]]),
        (ONE, {"bowl": (0.8, 0.1)}, [[0.8, 0.1, 0.25]]),
        (ONE, {"bowl": np.array([3.0, 0.1, 0.5])}, [[3.0, 0.1, 0.5]]),
        (TURNING, (0.5, 0.1, -0.5), [[0.5, 0.1, -0.5]]),
        (TWO, (0.8, 0.1, 0.2, 0.5, 0.3, -0.4), [[0.8, 0.1, 0.2], [0.5, 0.3, -0.4]]),
        (TWO, np.array([[0.8, 0.1, 0], [0.5, 0.3, 1]]), [[0.8, 0.1, 0.0], [0.5, 0.3, 1.0]]),
        (
            TWO,
            {"cup": (0.5, 0.3, -0.4), "bowl": (0.8, 0.1)},
            [[0.8, 0.1, 0.25], [0.5, 0.3, -0.4]],
        ),
        (
            THREE,
            {"cup": (0.5, 0.3, -0.4), "bowl": (0.8, 0.1)},
            [[0.8, 0.1, 0.25], [0.6, 0.9, 0.5], [0.5, 0.3, -0.4]],
        ),
        (
            THREE,
            {"cup": (0.5, 0.3, -0.4), "bowl": (0.8, 0.1), "stand": (0.7, 0.8)},
            [[0.8, 0.1, 0.25], [0.7, 0.8, 0.5], [0.5, 0.3, -0.4]],
        ),
        (WorkArea((STAND,)), {}, [[0.6, 0.9, 0.5]]),
    ],
)
def test_what_is_fixed_may_be_left_out(
    area: WorkArea, instance: Any, expected: list[list[float]]
) -> None:
    np.testing.assert_array_equal(placed(area, instance), expected)


@pytest.mark.parametrize(
    ("area", "instance", "message", "remedy"),
    [
        (TWO, {"bowl": (0.8, 0.1)}, "no place is given for 'cup', and it varies", FORM),
        (THREE, {}, "no place is given for 'bowl' and 'cup', and they vary", FORM),
        (
            TWO,
            {"bowl": (0.8, 0.1), "cup": (0.5, 0.3)},
            "no yaw is given for 'cup', and it varies",
            FORM,
        ),
        (
            TWO,
            {"bowll": (0.8, 0.1), "cup": (0.5, 0.3, 0.0)},
            "no object 'bowll' in this scenario",
            "Did you mean 'bowl'? Objects: bowl, cup",
        ),
        (
            TWO,
            {"bowl": (0.8,), "cup": (0.5, 0.3, 0.0)},
            "'bowl' is given 1 number, expected x, y and perhaps yaw",
            FORM,
        ),
        (
            TWO,
            {"bowl": (0.8, 0.1), "cup": (0.5, 0.3, 0.0, 1.0)},
            "'cup' is given 4 numbers, expected x, y and yaw",
            FORM,
        ),
        (
            THREE,
            {"bowl": (0.8, 0.1), "stand": 0.6, "cup": (0.5, 0.3, 0.0)},
            "'stand' is given 1 number, expected x, y and perhaps yaw",
            "Give bowl=X,Y stand=X,Y cup=X,Y,YAW, with X and Y in m, YAW in rad.",
        ),
        (
            TWO,
            {"bowl": (0.8, float("inf")), "cup": (0.5, 0.3, 0.0)},
            "y of 'bowl' is inf, expected a number from -1000 to 1000",
            FORM,
        ),
        (ONE, {"bowl": ("a", 0.1)}, "'bowl' is ('a', 0.1), expected numbers", "Give bowl=X,Y,"),
        (ONE, {"bowl": {"x": 0.8}}, "no y is given for 'bowl', and it varies", "X and Y in m."),
        (ONE, (), "'bowl' is given 0 numbers", "Give bowl=X,Y, with X and Y in m."),
        (ONE, (0.8,), "'bowl' is given 1 number", "Give bowl=X,Y, with X and Y in m."),
        (ONE, (0.8, 0.1, 0.0, 1.0), "'bowl' is given 4 numbers", "Give bowl=X,Y,"),
        (ONE, (0.8, float("nan")), "y of 'bowl' is nan", "Give bowl=X,Y,"),
        (ONE, "here", "the instance is 'here', expected numbers", "Give bowl=X,Y,"),
        (TURNING, (0.5, 0.1), "no yaw is given for 'cup', and it varies", "Give cup=X,Y,YAW,"),
        (TWO, (0.8, 0.1), "an instance of 2 numbers, and there are 2 objects", FORM),
        (TWO, (0.8, 0.1, 0.5, 0.3), "no yaw is given for 'cup', and it varies", FORM),
    ],
)
def test_what_cannot_be_an_instance_is_refused_with_its_object_and_the_form(
    area: WorkArea, instance: Any, message: str, remedy: str
) -> None:
    with pytest.raises(ScenarioError) as error:
        placed(area, instance)
    assert error.value.message.startswith(message)
    assert remedy in (error.value.remedy or "")
