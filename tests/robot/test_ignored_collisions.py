"""Pairs of links that are left out of collision checking, by every checker alike."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from drake_screw.errors import ModelError
from drake_screw.execution import build_station
from drake_screw.planning.swept import SweptChecker, lines
from drake_screw.robot import RobotConfig, TableConfig, Workcell, build_workcell
from tests.robot.six_joints import NAMES, START, fingers, urdf

NONE = np.empty((0, 4, 4))
BALL = {"shoulder": "<geometry><sphere radius='0.3'/></geometry>"}
TABLE = TableConfig((0.0, 0.0), (1.0, 1.0), 0.0)
IN_TABLE, TOGETHER = ("shoulder", "table"), ("right", "left")


def robot(folder: Path, ignored: Sequence[tuple[str, str]] = (), gap: float = 0.0) -> RobotConfig:
    file = folder / "six.urdf"
    file.write_text(urdf(shapes=BALL, extra=fingers(gap)))
    return RobotConfig(str(file), NAMES, "hand", START, ignore_collisions=tuple(ignored))


def cell(folder: Path, *ignored: tuple[str, str], gap: float = 0.0) -> Workcell:
    return build_workcell(robot(folder, ignored, gap), table=TABLE)


def test_what_just_touches_collides_and_is_named(tmp_path: Path) -> None:
    """To be at a distance of 0, or a rounding error from it, is to collide."""
    touching = cell(tmp_path, IN_TABLE)
    assert touching.collides([START], NONE).all()
    assert touching.colliding_bodies(START, NONE) == (("left", "right"),)
    apart = cell(tmp_path, IN_TABLE, gap=1e-3)
    assert not apart.collides([START], NONE).any()
    assert apart.colliding_bodies(START, NONE) == ()


def test_pairs_are_left_out_by_each_checker(tmp_path: Path) -> None:
    full = cell(tmp_path)
    assert set(full.colliding_bodies(START, NONE)) == {("shoulder", "table"), ("left", "right")}
    found = cell(tmp_path, IN_TABLE, TOGETHER)
    assert found.colliding_bodies(START, NONE) == ()
    assert not found.collides([START], NONE).any()
    assert len(found.pairs) == len(full.pairs) - 2
    steps = lines(np.array([START, np.add(START, [0.4, 0.0, 0.0, 0.0, 0.0, 0.0])]))
    for workcell, touches in ((full, True), (found, False)):
        checker = SweptChecker(workcell)
        swept = checker.along(steps, np.array([0, len(steps)]), NONE[None])
        assert swept.touches.tolist() == [touches]


def test_they_do_not_push_one_another_in_simulation(tmp_path: Path) -> None:
    for ignored, contacts in (((), 2), ((IN_TABLE, TOGETHER), 0)):
        file = robot(tmp_path, ignored, gap=-2e-3)
        station = build_station(file, table=TABLE)
        root = station.context(START, NONE)
        Simulator(station.diagram, root).AdvanceTo(0.005)
        results = station.plant.get_contact_results_output_port()
        seen = results.Eval(station.plant.GetMyContextFromRoot(root))
        assert seen.num_point_pair_contacts() == contacts


@pytest.mark.parametrize(
    ("pair", "said", "remedy"),
    [
        (("left", "rigt"), "no link 'rigt'", "Did you mean 'right'? Links: base, shoulder"),
        (("tabel", "left"), "no link 'tabel'", "Links: base, shoulder"),
    ],
)
def test_unknown_links_are_refused(tmp_path: Path, pair, said: str, remedy: str) -> None:
    with pytest.raises(ModelError, match=said) as caught:
        cell(tmp_path, pair)
    assert caught.value.message.startswith("robot.ignore_collisions: ")
    assert remedy in str(caught.value)


def test_a_pair_without_the_robot_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="neither 'table' nor 'table' is a link of the robot"):
        cell(tmp_path, ("table", "table"))
