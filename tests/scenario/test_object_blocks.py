"""What a scenario may say of where objects stand, and what it must not."""

from __future__ import annotations

import pytest

from drake_screw import Setup
from drake_screw.errors import ScenarioError
from drake_screw.scenario.loader import load_scenario

BOWL, CUP = "objects.1", "objects.0"


@pytest.mark.parametrize(
    ("changes", "message", "remedy"),
    [
        (["objects.1.on=tray"], "objects.1.on: there is no object 'tray'", "Objects: cup"),
        (["objects.1.on=bowl"], "in a circle: bowl on bowl", "must stand in the world"),
        (
            ["objects.1.on=cup", "objects.0.on=bowl"],
            "objects stand on one another in a circle: cup on bowl on cup",
            "One of them must stand in the world: leave its `on` out.",
        ),
        (
            ["objects.1.orientation=any", "objects.1.roll=[0, 1]"],
            "with `orientation: any` there is no roll to choose",
            "Leave roll out, or the orientation.",
        ),
        (["objects.1.orientation=some"], "there is no 'some'", "Choices: any"),
        (["objects.1.pitch=[0, 2]"], "a pitch is between -pi/2 and pi/2", "roll and yaw"),
        (["objects.1.roll=[-4, 4]"], "the range is wider than a full turn", "Angles are in rad"),
        (["objects.1.z=[1, 0]"], "lower limit 1.0 lies above upper limit 0.0", "[lower, upper]"),
        (["apart=true"], "adaptive regions are halved by what they take up", "Write a grid"),
        (
            ["regions={grid: {bowl.z: 2}}"],
            "z of 'bowl' is fixed, so it cannot be split into 2 cells",
            "Give 'bowl' a range in z",
        ),
    ],
)
def test_what_objects_cannot_be_is_refused(changes: list[str], message: str, remedy: str) -> None:
    with pytest.raises(ScenarioError) as error:
        load_scenario("fetching", changes)
    assert message in str(error.value)
    assert remedy in str(error.value)


def test_one_object_is_never_apart() -> None:
    with pytest.raises(ScenarioError, match="apart: there is just one object"):
        load_scenario("pouring", ["apart=true"])


def test_old_keys_alone_mean_what_they_did() -> None:
    item = load_scenario("pouring").objects[0]
    assert (item.roll.written(), item.pitch.written(), item.orientation, item.on) == (
        0,
        0,
        None,
        None,
    )
    assert item.z.written() == -0.06447185171756116
    assert not load_scenario("pouring").apart


def test_every_axis_may_be_free_and_split() -> None:
    scenario = load_scenario(
        "fetching",
        [
            "objects.0.on=bowl",
            "objects.0.z=[0.0, 0.1]",
            "objects.0.roll=[-0.1, 0.1]",
            "objects.1.orientation=any",
            "regions={grid: {cup.z: 2, cup.roll: 3, bowl.pitch: 2, bowl.yaw: 2}}",
        ],
    )
    setup = Setup(scenario)
    assert setup.regions.K == 24
    assert setup.area.free.tolist() == [[1, 1, 0, 1, 1, 0], [1, 1, 1, 0, 1, 1]]
    assert setup.area.related == {(0, 1)}
    name = setup.regions.name(0)
    assert (
        name
        == "cup z 0.00..0.05, cup roll -0.10..-0.03, bowl yaw -3.14..0.00, bowl pitch -1.57..0.00"
    )
