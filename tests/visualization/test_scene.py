from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from pydrake.geometry import Meshcat

from drake_screw.errors import ModelError
from drake_screw.robot import (
    BoxShape,
    CylinderShape,
    ObjectConfig,
    ObstacleConfig,
    PlacedShape,
    RobotConfig,
    TableConfig,
    ToolConfig,
    build_workcell,
)
from drake_screw.tasks import ObjectArea, WorkArea, grid_regions
from drake_screw.visualization import Scene
from drake_screw.visualization.linkage import Linkage
from tests.visualization.conftest import BOWL

ARM = tuple(f"left_{joint}" for joint in ("s0", "s1", "e0", "e1", "w0", "w1", "w2"))
BAXTER = RobotConfig("baxter", ARM, "left_hand", (0.0, -0.5, 0.0, 1.0, 0.0, 0.5, 0.0))
TABLE = TableConfig((0.8, 0.3), (0.6, 1.4), 0.1)
FAILURES = [0, 3, 10, 5, 0, 1]


@pytest.fixture
def scene(meshcat: Meshcat) -> Scene:
    bowl = ObjectConfig("bowl", 0.08, 0.06)
    return Scene(meshcat, BAXTER, TABLE, [bowl], WorkArea((BOWL,)), scenario="a <b>", dots=40)


def test_the_robot_stands_at_its_start(scene, meshcat) -> None:
    def place(link: str) -> bytes:
        return meshcat._GetPackedTransform(f"/workcell/baxter/{link}")

    assert meshcat.HasPath("/workcell/table")
    assert meshcat.HasPath("/work_area/bowl")
    shoulder, wrist = place("left_upper_shoulder"), place("left_wrist")
    bent = replace(BAXTER, start=(0.0, -0.5, 0.0, 1.5, 0.0, 0.5, 0.0))
    Scene(meshcat, bent, TABLE, [ObjectConfig("bowl", 0.08, 0.06)], WorkArea((BOWL,)))
    assert place("left_upper_shoulder") == shoulder
    assert place("left_wrist") != wrist


def test_obstacles_and_what_the_hand_holds_are_shown(meshcat) -> None:
    cup = PlacedShape(CylinderShape(0.03, 0.1))
    robot = replace(BAXTER, tool=ToolConfig("left_hand", cup))
    wall = ObstacleConfig("wall", PlacedShape(BoxShape((0.1, 1.0, 0.5)), (1.2, 0.0, 0.3)))
    Scene(meshcat, robot, TABLE, [], WorkArea((BOWL,)), obstacles=[wall])
    assert meshcat.HasPath("/workcell/wall")
    assert meshcat.HasPath("/workcell/baxter/tool")
    cell = build_workcell(robot, table=TABLE, obstacles=[wall])
    assert "baxter/tool" in Linkage(cell).names
    Scene(meshcat, BAXTER, TABLE, [], WorkArea((BOWL,)))
    assert not meshcat.HasPath("/workcell/wall")
    assert not meshcat.HasPath("/workcell/baxter/tool")


def test_a_model_that_does_not_exist_is_refused(meshcat) -> None:
    robot = RobotConfig("bakster", ARM, "left_hand", BAXTER.start)
    with pytest.raises(ModelError, match="baxter"):
        Scene(meshcat, robot, None, [], WorkArea(()))


def test_a_round_shows_all_its_parts(scene, meshcat, make_round, regions) -> None:
    scene.show_round(make_round(regions, FAILURES), regions)
    for path in (
        "/rounds/01/regions",
        "/rounds/01/weakest/line",
        "/rounds/01/next/bowl/object",
        "/rounds/01/next/bowl/ring",
        "/demonstrations/01/path",
        "/demonstrations/02/guiding_poses/x",
        "/demonstrations/02/place/number",
        "/objects/bowl",
        "/instances/success",
        "/instances/joint limit",
        "/instances/unreachable",
        "/instances/collision",
    ):
        assert meshcat.HasPath(path), path
    assert not meshcat.HasPath("/demonstrations/03")


def test_the_sample_is_capped_and_stated(scene, make_round, regions) -> None:
    shown = scene.show_round(make_round(regions, FAILURES, each=50), regions)
    assert len(shown.cause) == 40
    assert shown.statement == "40 of 300 instances, drawn at random"


def test_rounds_replace_one_another(scene, meshcat, make_round, regions) -> None:
    scene.show_round(make_round(regions, FAILURES, demonstrations=3), regions)
    scene.show_round(make_round(regions, [0] * 6, number=1, demonstrations=1), regions)
    assert meshcat.HasPath("/rounds/01/next")
    assert meshcat.HasPath("/rounds/02/regions")
    assert not meshcat.HasPath("/rounds/02/next")
    assert not meshcat.HasPath("/demonstrations/02")
    assert not meshcat.HasPath("/instances/joint limit")
    scene.show_round(make_round(regions, [0] * 6), regions)
    assert not meshcat.HasPath("/rounds/01/next")


def test_a_new_scene_starts_empty(scene, meshcat, make_round, regions) -> None:
    scene.show_round(make_round(regions, FAILURES), regions)
    Scene(meshcat, BAXTER, None, [ObjectConfig("bowl", 0.08, 0.06)], WorkArea((BOWL,)))
    for path in ("/rounds", "/instances", "/demonstrations", "/objects", "/workcell/table"):
        assert not meshcat.HasPath(path), path


def test_a_round_without_demonstrations(scene, meshcat, make_round, regions) -> None:
    scene.show_round(make_round(regions, FAILURES, demonstrations=0), regions)
    assert meshcat.HasPath("/rounds/01/regions")
    assert not meshcat.HasPath("/demonstrations")


def test_every_object_is_suggested(meshcat, make_round) -> None:
    cup = ObjectArea("cup", (0.5, 0.2, 0.0), (0.5, 0.2, 0.0), 0.0)
    area = WorkArea((cup, BOWL))
    objects = [ObjectConfig("cup", 0.04, 0.1), ObjectConfig("bowl", 0.08, 0.06)]
    scene = Scene(meshcat, BAXTER, TABLE, objects, area)
    regions = grid_regions(area, {"bowl.x": 2})
    scene.show_round(make_round(regions, [1, 6]), regions)
    for name in ("cup", "bowl"):
        assert meshcat.HasPath(f"/rounds/01/next/{name}/object")
        assert meshcat.HasPath(f"/objects/{name}")


def test_what_stands_on_a_tray_is_shown_where_the_tray_is(meshcat, make_round) -> None:
    tray = ObjectArea("tray", (0.8, 0.2, 0.5), (0.8, 0.2, 0.5), 0.1)
    cup = ObjectArea("cup", (-0.1, -0.05, 0.0), (0.1, 0.05, 0.0), z=(0.01, 0.2), on="tray")
    area = WorkArea((cup, tray))
    objects = (ObjectConfig("cup", 0.03, 0.1), ObjectConfig("tray", 0.15, 0.01))
    scene = Scene(meshcat, BAXTER, TABLE, objects, area)
    regions = grid_regions(area, {"cup.x": 2})
    shown = scene.show_round(make_round(regions, [3, 0]), regions)
    assert shown.coordinates.shape == (20, 2, 6)
    assert meshcat.HasPath("/instances/success")
    np.testing.assert_allclose(scene._X_WP(0)[:3, 3], [0.8, 0.2, 0.0])
    assert scene._height(0) == pytest.approx(0.112)


def test_the_page_needs_no_network(tmp_path, scene, make_round, regions) -> None:
    scene.show_round(make_round(regions, FAILURES), regions)
    page = scene.save_html(tmp_path / "meshcat.html").read_text(encoding="utf-8")
    assert not re.search(r"<(script|img|link|iframe)[^>]*\s(src|href)\s*=", page)
    assert not re.search(r"@import|url\(\s*['\"]?https?:", page)
    assert not re.search(r"\bfetch\(\s*['\"]https?:", page)


def test_the_page_says_what_it_shows(tmp_path, scene, make_round, regions) -> None:
    scene.show_round(make_round(regions, FAILURES, each=50), regions)
    scene.show_round(make_round(regions, [0] * 6, number=1), regions)
    page = scene.save_html(tmp_path / "meshcat.html").read_text(encoding="utf-8")
    legend = page[page.index('<div id="legend">') :]
    assert "<title>a &lt;b&gt;</title>" in page
    assert "round 2, 2 demonstrations: certified" in legend
    assert "; largest estimate &lt;= &lt;that &amp; this&gt;" in legend
    assert "success (40)" in legend
    assert "40 of 60 instances" in legend
    assert re.findall(r'<button aria-pressed="(\w+)">(\d+)', legend) == [
        ("false", "1"),
        ("true", "2"),
    ]
    assert legend.count("</script>") == 2  # its own, and that of the numerals


def test_a_page_before_the_first_round(tmp_path, scene) -> None:
    page = scene.save_html(tmp_path / "meshcat.html").read_text(encoding="utf-8")
    assert '<div id="legend">' not in page
