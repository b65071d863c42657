"""Obstacles and tools of a scenario, from its text to what plans make of them."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from drake_screw import Setup, load_scenario
from drake_screw.assembly.preview import preview
from drake_screw.assembly.swap_model import swap_model
from drake_screw.assembly.work_area_checks import Covered, covered_by_obstacles
from drake_screw.errors import ModelError, RunDirectoryError, ScenarioError
from drake_screw.planning import Cause, connection
from drake_screw.runs.executions import execute, station_graphviz
from drake_screw.runs.run import Run, new_run, open_run
from drake_screw.scenario.schema import Scenario
from tests.planning.pole_in_the_way import AWAY, START, lesson_of, robot_in
from tests.robot.test_shapes import CUBE

TEXT = """
name: turning
robot:
  model: {model}
  joints: [{joints}]
  end_effector: hand
  start: {start}
  {tool}
objects:
  - {{name: bowl, x: [-1.2, -0.8], y: [-1.2, -0.8], yaw: 0, z: 0.2, radius: 0.05, height: 0.1}}
obstacles: {obstacles}
regions: {{grid: {{x: 1}}}}
coverage: {{beta: 0.9, epsilon: 0.05, delta: 0.05}}
demonstrations: {{initial: 1, budget: 2}}
teacher: {{kind: interactive}}
planner: {{approach: free, collision: true}}
"""

POST = "{name: post, cylinder: {radius: 0.05, length: 0.6}, xyz: [0.4, 0, 0.5]}"
"""Where the ball of the second link passes on its way from START, whatever the others do."""
ASIDE = "{name: post, cylinder: {radius: 0.05, length: 0.6}, xyz: [-0.69, 0.05, 0.5]}"


def scenario_in(folder: Path, *obstacles: str, tool: str = "") -> Scenario:
    robot = robot_in(folder)
    file = folder / "turning.yaml"
    file.write_text(
        TEXT.format(
            model=robot.model,
            joints=", ".join(robot.joints),
            start=START.tolist(),
            tool=tool,
            obstacles=f"[{', '.join(obstacles)}]",
        )
    )
    return load_scenario(file)


def test_what_stands_in_the_way_makes_plans_fail(tmp_path: Path) -> None:
    found = {}
    for obstacle in (ASIDE, POST):
        setup = Setup(
            scenario_in(tmp_path, obstacle, tool="tool: {shape: {sphere: {radius: 0.02}}}")
        )
        lesson = lesson_of(setup.workcell, AWAY)
        found[obstacle] = setup.evaluate([lesson], [[-1.0, -1.0]])[0, 0]
    assert found[ASIDE].success
    assert found[POST].cause == Cause.COLLISION


def test_the_tool_makes_plans_fail_that_the_hand_would_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A low wall that the arm passes over, and a stick in its hand that does not."""
    monkeypatch.setattr(connection, "available", lambda: False)
    wall = "{name: wall, box: [1.0, 0.02, 0.2], xyz: [0.7, 0, 0.3]}"
    stick = "tool: {shape: {cylinder: {radius: 0.01, length: 0.6}}}"
    outcomes = []
    for tool in ("", stick):
        setup = Setup(scenario_in(tmp_path, wall, tool=tool))
        lesson = lesson_of(setup.workcell, AWAY)
        outcomes.append(setup.evaluate([lesson], [[-1.0, -1.0]])[0, 0])
    assert outcomes[0].success
    assert outcomes[1].cause == Cause.COLLISION
    assert setup.workcell.touching(int(outcomes[1].pair)) == ("tool", "wall")


def test_a_tool_may_be_a_mesh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection, "available", lambda: False)
    (tmp_path / "stick.obj").write_text(CUBE)
    wall = "{name: wall, box: [1.0, 0.02, 0.2], xyz: [0.7, 0, 0.3]}"
    for scale, cause in ((0.05, Cause.SUCCESS), (0.3, Cause.COLLISION)):
        tool = f"tool: {{shape: {{mesh: stick.obj, scale: {scale}, rpy: [3.1416, 0, 0]}}}}"
        setup = Setup(scenario_in(tmp_path, wall, tool=tool))
        lesson = lesson_of(setup.workcell, AWAY)
        assert setup.evaluate([lesson], [[-1.0, -1.0]])[0, 0].cause == cause


def test_a_start_among_obstacles_is_refused(tmp_path: Path) -> None:
    hand = Setup(scenario_in(tmp_path)).workcell.arm.pose(START)[:3, 3]
    xyz = f"[{', '.join(f'{c:.3f}' for c in hand)}]"
    ball = f"{{name: ball, sphere: {{radius: 0.1}}, xyz: {xyz}}}"
    scenario = scenario_in(tmp_path, ASIDE, ball)
    with pytest.raises(ScenarioError) as caught:
        _ = Setup(scenario).workcell
    assert caught.value.file == scenario.source
    assert caught.value.message == "obstacles.1: 'ball' touches the robot's 'p3_link' at the start"
    assert "robot.start" in caught.value.remedy


def test_a_tool_that_touches_a_link_at_the_start_is_refused_with_the_remedy(tmp_path: Path) -> None:
    box = "shape: {box: [0.9, 0.3, 0.3], xyz: [-0.3, 0, 0]}"
    with pytest.raises(ScenarioError) as caught:
        _ = Setup(scenario_in(tmp_path, tool=f"tool: {{{box}}}")).workcell
    assert caught.value.message.startswith("robot.tool.shape: the tool touches 'p2_link' ")
    assert "touches: [p2_link]" in caught.value.remedy
    allowed = scenario_in(tmp_path, tool=f"tool: {{{box}, touches: [p2_link]}}")
    assert Setup(allowed).workcell.colliding_bodies(START, AWAY) == ()


def test_names_and_meshes_are_told_with_their_file(tmp_path: Path) -> None:
    scenario = scenario_in(tmp_path, "{name: small, sphere: {radius: 0.1}, xyz: [3, 0, 0]}")
    with pytest.raises(ModelError, match="the name 'small' of an obstacle is taken") as caught:
        _ = Setup(scenario).workcell
    assert caught.value.file == scenario.source
    with pytest.raises(ModelError, match="obstacle 'jug': there is no such mesh") as caught:
        _ = Setup(scenario_in(tmp_path, "{name: jug, mesh: jug.obj}")).workcell
    assert caught.value.file == tmp_path / "jug.obj"


def test_the_check_tells_of_obstacles_and_tool(tmp_path: Path) -> None:
    scenario = scenario_in(
        tmp_path,
        POST,
        "{name: crate, box: [0.2, 0.6, 0.2], xyz: [-0.9, -1, 0.25], rpy: [0, 0, 3.1416]}",
        tool="tool: {shape: {sphere: {radius: 0.02}}, touches: [bowl]}",
    )
    found = preview(scenario)
    (covered,) = found.covered
    assert (covered.obstacle, covered.object) == ("crate", "bowl")
    # x within 0.1 + 0.05 of -0.9, of -1.2 .. -0.8
    assert covered.share == pytest.approx(0.25 / 0.4, abs=0.05)
    text = str(found)
    assert "tool       sphere of radius 0.02 m, fixed to 'hand', may touch bowl" in text
    assert "obstacle   post: cylinder of radius 0.05 m, 0.6 m long at 0.4, 0, 0.5 m\n" in text
    assert "obstacle   crate: box 0.2 x 0.6 x 0.2 m at -0.9, -1, 0.25 m, turned by 0, 0, 3" in text
    assert "note       obstacle 'crate' is in the place of 'bowl' in about 6" in text


def test_what_an_object_stands_on_does_not_take_its_place(tmp_path: Path) -> None:
    under = "{name: shelf, box: [0.6, 0.6, 0.1], xyz: [-1, -1, 0.15]}"
    higher = under.replace("0.15]", "0.16]")
    for obstacle, share in ((under, ()), (higher, (Covered("shelf", "bowl", 1.0),))):
        setup = Setup(scenario_in(tmp_path, obstacle))
        assert covered_by_obstacles(setup.workcell, setup.area) == share


def test_another_model_keeps_obstacles_and_tool(tmp_path: Path) -> None:
    tool = "tool: {shape: {sphere: {radius: 0.02}}, touches: [p1_link, bowl, post]}"
    scenario = scenario_in(tmp_path, POST, tool=tool)
    other = tmp_path / "other.sdf"
    other.write_text(Path(scenario.robot.model).read_text().replace("p1_link", "first_link"))
    swapped = swap_model(scenario, other)
    assert swapped.obstacles == scenario.obstacles
    assert swapped.robot.tool.shape == scenario.robot.tool.shape
    assert swapped.robot.tool.touches == ("bowl", "post")
    assert Setup(swapped).workcell.tool is not None


def test_a_run_keeps_its_obstacles_and_notices_another_mesh(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "meshes" / "jug.obj"
    file.parent.mkdir()
    jug = "{name: jug, mesh: meshes/jug.obj, scale: 0.1, xyz: [-0.9, 0.5, 0.2]}"
    tool = "tool: {shape: {sphere: {radius: 0.02}}}"
    scenario, folder = scenario_in(tmp_path, jug, tool=tool), tmp_path / "run"
    with pytest.raises(ModelError, match="there is no such mesh"):
        new_run(scenario, folder, teacher=lambda _: SimpleNamespace())
    assert not folder.exists()
    file.write_text(CUBE)
    new_run(scenario, folder, teacher=lambda _: SimpleNamespace())
    again = open_run(folder)
    assert again.setup.scenario == scenario
    assert [body.name() for body in again.setup.workcell.obstacles] == ["jug"]
    lesson = lesson_of(again.setup.workcell, AWAY)
    monkeypatch.setattr(Run, "demonstrations", (lesson,))
    done = execute(folder, instance=[-1.0, -1.0], workers=1)
    assert re.search(r"with contact +0\n", str(done))
    page = (done.folder / "executions.html").read_text()
    assert len(page) > 1e6
    assert "executor" in station_graphviz(folder)
    assert "planner" not in station_graphviz(folder)
    loop = station_graphviz(folder, planning=True)
    assert all(name in loop for name in ("planner", "object_poses", "executor"))
    file.write_text(CUBE.replace("v 1 1 1", "v 1 1 2"))
    with pytest.raises(RunDirectoryError, match=r"the mesh .*jug\.obj has changed since this run"):
        open_run(folder)
