"""Coal says of a workcell what Drake says."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drake_screw.robot import (
    BoxShape,
    MeshShape,
    ObjectConfig,
    ObstacleConfig,
    PlacedShape,
    RobotConfig,
    TableConfig,
    ToolConfig,
    Workcell,
    build_workcell,
)
from drake_screw.screws import pose
from tests.robot.small_arms import SEVEN, sdf

pytest.importorskip("pinocchio", reason="Pinocchio and Coal come with the extra `benchmark`")

SHAPES = {
    "base": "<box><size>0.1 0.1 0.1</size></box>",
    "a2_link": "<sphere><radius>0.04</radius></sphere>",
    "a3_link": "<capsule><radius>0.02</radius><length>0.05</length></capsule>",
    "a4_link": "<ellipsoid><radii>0.05 0.02 0.03</radii></ellipsoid>",
    "a5_link": "<cylinder><radius>0.03</radius><length>0.05</length></cylinder>",
    "a7_link": "<box><size>0.05 0.03 0.04</size></box>",
}
WEDGE = """v 0 0 0
v 0.2 0 0
v 0 0.2 0
v 0 0 0.5
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""


@pytest.fixture
def coal_checker(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "benchmarks"))
    import coal_checker

    yield coal_checker
    for name in ("coal_checker", "pinocchio_arm"):
        sys.modules.pop(name, None)


@pytest.fixture
def workcell(tmp_path: Path) -> Workcell:
    """An arm with a tool above a table, beside a wedge, and two objects."""
    model, wedge = tmp_path / "seven.sdf", tmp_path / "wedge.obj"
    model.write_text(sdf(SEVEN, shapes=SHAPES))
    wedge.write_text(WEDGE)
    rod = ToolConfig("hand", PlacedShape(BoxShape((0.02, 0.02, 0.2)), xyz=(0.0, 0.0, 0.12)))
    names = tuple(joint.name for joint in SEVEN)
    return build_workcell(
        RobotConfig(str(model), names, "hand", (0.0,) * 7, tool=rod),
        table=TableConfig(center=(0.6, 0.2), size=(0.6, 0.6), top=0.1),
        objects=(ObjectConfig("bowl", 0.08, 0.06), ObjectConfig("cup", 0.04, 0.1)),
        obstacles=(ObstacleConfig("wedge", PlacedShape(MeshShape(wedge), xyz=(-0.2, 0.4, 0.1))),),
    )


def test_coal_and_drake_agree_where_an_arm_touches_something(
    coal_checker: Any, workcell: Workcell
) -> None:
    coal, rng = coal_checker.CoalChecker(workcell), np.random.default_rng(4)
    lower, upper = workcell.arm.lower, workcell.arm.upper
    touching: set[str] = set()
    for _ in range(20):
        q = rng.uniform(lower, upper, (50, 7))
        X_WO = pose(np.eye(3), rng.uniform([0.1, -0.1, 0.1], [0.9, 0.7, 0.6], (2, 3)))
        drakes = workcell.collides(q, X_WO)
        assert 0 < drakes.sum() < len(drakes)
        np.testing.assert_array_equal(coal.collides(q, X_WO), drakes)
        for some, any_touches in ((q, True), (q[drakes][:1], True), (q[~drakes], False)):
            assert coal.touches(some, X_WO) == any_touches
            assert coal.touches_one_by_one(some, X_WO) == any_touches
        for one in q[drakes]:
            touching.update(*workcell.colliding_bodies(one, X_WO))
    assert touching >= {*SHAPES, "tool", "table", "wedge", "bowl", "cup"}
