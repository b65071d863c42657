"""Pairs of links that are proposed to be let touch."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from drake_screw.robot import (
    BoxShape,
    ObjectConfig,
    PlacedShape,
    RobotConfig,
    TableConfig,
    ToolConfig,
    Workcell,
    build_workcell,
)
from drake_screw.robot.proposed import ProposedPair, proposed_pairs
from tests.robot.small_arms import JointText, sdf

ARM = (
    JointText("p1", "0 0 0.5 0 0 0"),
    JointText("p2", "0.4 0 0 0 0 0", limits=(-3.0, 3.0)),
    JointText("p3", "0.4 0 0 0 0 0", limits=(-1.0, 1.0)),
)
"""Planar: p1's and p3's links meet only where the arm is folded at p2."""


def ball(radius: float) -> str:
    return f"<sphere><radius>{radius}</radius></sphere>"


def cell(folder: Path, start: tuple[float, ...], **radii: float) -> Workcell:
    file = folder / "arm.sdf"
    file.write_text(sdf(ARM, shapes={link: ball(radius) for link, radius in radii.items()}))
    robot = RobotConfig(str(file), ("p1", "p2", "p3"), "hand", start)
    return build_workcell(robot, objects=(ObjectConfig("bowl", 0.5, 0.5),))


def proposed(workcell: Workcell, **options: bool) -> dict[tuple[str, str], ProposedPair]:
    found = proposed_pairs(workcell, np.random.default_rng(1), 200, **options)
    return {(pair.a, pair.b): pair for pair in found}


def test_links_that_always_touch_are_proposed(tmp_path: Path) -> None:
    """Neighbours, which Drake lets touch, are not; nor is the bowl, wherever it is."""
    found = proposed(cell(tmp_path, (0.1, 0.1, 0.1), p1_link=0.45, p2_link=0.1, p3_link=0.45))
    assert set(found) == {("p1_link", "p3_link")}
    pair = found["p1_link", "p3_link"]
    assert (pair.kind, pair.share) == ("always", 1.0)
    assert pair.reason == (
        "touch in all of 200 configurations drawn within the joint limits, and at the start"
    )


def test_links_that_touch_at_the_start_are_proposed_with_how_often_they_do(tmp_path: Path) -> None:
    folded = cell(tmp_path, (0.0, 2.9, 0.0), base=0.2, p1_link=0.1, p3_link=0.1)
    pair = proposed(folded)["p1_link", "p3_link"]
    assert pair.kind == "start"
    assert 0.0 < pair.share < 0.5
    assert pair.reason.startswith("touch at the start, and in ")
    stretched = cell(tmp_path, (0.0, 0.0, 0.0), base=0.2, p1_link=0.1, p3_link=0.1)
    assert proposed(stretched) == {}


def test_links_that_never_meet_are_proposed_where_that_is_wanted(tmp_path: Path) -> None:
    arm = cell(tmp_path, (0.0, 0.0, 0.0), base=0.05, p2_link=0.05, p1_link=0.1, p3_link=0.1)
    found = proposed(arm, never=True)
    assert set(found) == {("base", "p2_link"), ("base", "p3_link")}
    assert {pair.kind for pair in found.values()} == {"never"}
    assert found["base", "p2_link"].reason.startswith("touch in none of 200 configurations")


def test_only_the_robot_itself_is_looked_at(tmp_path: Path) -> None:
    """Not the table, and not what it holds, of which the scenario speaks."""
    arm = cell(tmp_path, (0.0, 0.0, 0.0), p1_link=0.1, p3_link=0.1)
    robot = RobotConfig(str(arm.model_file), ("p1", "p2", "p3"), "hand", (0.0, 0.0, 0.0))
    long = ToolConfig("hand", PlacedShape(BoxShape((2.0, 0.1, 0.1))))
    table = TableConfig((0.0, 0.0), (3.0, 3.0), 0.5)
    found = build_workcell(replace(robot, tool=long), table=table)
    assert found.collides(np.zeros((1, 3)), np.empty((0, 4, 4)))[0]
    assert proposed(found) == {}


def test_the_same_draw_proposes_the_same(tmp_path: Path) -> None:
    arm = cell(tmp_path, (0.0, 2.9, 0.0), p1_link=0.1, p3_link=0.1)
    assert proposed(arm) == proposed(arm)
    with pytest.raises(ValueError, match="count is 0"):
        proposed_pairs(arm, np.random.default_rng(0), 0)
