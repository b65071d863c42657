"""Obstacles and what the hand holds: where Drake has them, and what they hit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Role

from drake_screw.errors import ModelError
from drake_screw.robot import (
    BoxShape,
    CylinderShape,
    MeshShape,
    ObjectConfig,
    ObstacleConfig,
    PlacedShape,
    RobotConfig,
    SphereShape,
    TableConfig,
    ToolConfig,
    Workcell,
    build_workcell,
)
from drake_screw.screws import pose
from tests.robot.small_arms import PLANAR, JointText, sdf

NONE = np.empty((0, 4, 4))
ZERO = np.zeros(3)
BALL = "<sphere><radius>0.03</radius></sphere>"
CUBE = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1)) + (
    "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
)
"""From the origin to (1, 1, 1), as .obj."""


def placed(solid: object, *xyz: float, rpy: tuple[float, float, float] = (0, 0, 0)) -> PlacedShape:
    return PlacedShape(solid, xyz or (0.0, 0.0, 0.0), rpy)


@pytest.fixture
def cube(tmp_path: Path) -> Path:
    file = tmp_path / "cube.obj"
    file.write_text(CUBE)
    return file


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A planar arm 0.5 m above the ground; stretched along x, its hand is at (0.8, 0, 0.5)."""
    file = tmp_path / "planar.sdf"
    shapes = {"p2_link": BALL, "p3_link": BALL}
    file.write_text(sdf(PLANAR, hand="0.1 0 0 0 0 0", shapes=shapes))
    return file


@pytest.fixture
def gripper(tmp_path: Path) -> Path:
    """The same with a finger beside the hand that slides."""
    file = tmp_path / "gripper.sdf"
    finger = JointText("finger", "0.1 0.05 0 0 0 0", limits=(-0.1, 0.1), kind="prismatic")
    text = sdf(PLANAR, hand="0.1 0 0 0 0 0")
    with_finger = sdf((*PLANAR, finger), shapes={"finger_link": BALL})
    frame = text[text.index("<frame") : text.index("</frame>")]
    start, end = with_finger.index("<frame"), with_finger.index("</frame>")
    file.write_text(with_finger[:start] + frame + with_finger[end:])
    return file


def cell_of(
    model: Path, *obstacles: ObstacleConfig, tool: ToolConfig | None = None, **around: object
) -> Workcell:
    robot = RobotConfig(str(model), ("p1", "p2", "p3"), "hand", (0.0, 0.0, 0.0), tool=tool)
    return build_workcell(robot, obstacles=obstacles, **around)


def distance(cell: Workcell, body: object, point: object, q: np.ndarray = ZERO) -> float:
    """From a point in W to a body's collision shape, negative inside."""
    root = cell.diagram.CreateDefaultContext()
    X_WO = np.tile(pose(np.eye(3), [9.0, 9.0, 9.0]), (len(cell.objects), 1, 1))
    cell.plant.SetPositions(cell.plant.GetMyMutableContextFromRoot(root), cell.positions(q, X_WO))
    query = cell.scene_graph.get_query_output_port().Eval(
        cell.scene_graph.GetMyContextFromRoot(root)
    )
    (geometry,) = cell.plant.GetCollisionGeometriesForBody(body)
    return next(
        found.distance
        for found in query.ComputeSignedDistanceToPoint(np.array(point, dtype=float))
        if found.id_G == geometry
    )


QUARTER = (0.0, 0.0, np.pi / 2)


@pytest.mark.parametrize(
    ("shape", "points"),
    [
        (
            placed(BoxShape((0.2, 0.4, 0.6)), 1.0, 0.0, 0.3, rpy=QUARTER),
            {(1.2, 0, 0.3): 0.0, (1.3, 0, 0.3): 0.1, (1, 0.2, 0.3): 0.1, (1, 0, 0.7): 0.1},
        ),
        (
            placed(CylinderShape(0.1, 0.6), 0.5, 1.0, 0.2, rpy=(np.pi / 2, 0.0, 0.0)),
            {(0.5, 1.4, 0.2): 0.1, (0.5, 0.6, 0.2): 0.1, (0.5, 1.0, 0.4): 0.1},
        ),
        (placed(SphereShape(0.1), 0.5, 1.0, 0.2), {(0.5, 1.4, 0.2): 0.3, (0.5, 1.0, 0.2): -0.1}),
    ],
    ids=["box", "cylinder", "sphere"],
)
def test_obstacles_are_where_they_are_put(model: Path, shape: PlacedShape, points: dict) -> None:
    cell = cell_of(model, ObstacleConfig("thing", shape))
    for point, expected in points.items():
        assert distance(cell, cell.obstacles[0], point) == pytest.approx(expected, abs=1e-9)


def test_a_mesh_is_its_convex_hull_scaled_turned_and_put_where_it_is(
    model: Path, cube: Path
) -> None:
    def thing(x: float) -> ObstacleConfig:
        """Turned by 90 degrees about its corner it reaches from x - 0.2 to x."""
        mesh = MeshShape(cube, 0.2)
        return ObstacleConfig("thing", placed(mesh, x, -0.1, 0.45, rpy=QUARTER))

    # The ball of the third link, around (0.7, 0, 0.5), ends at x = 0.73.
    assert cell_of(model, thing(0.935)).colliding_bodies(ZERO, NONE) == ()
    assert cell_of(model, thing(0.925)).colliding_bodies(ZERO, NONE) == (("p3_link", "thing"),)
    corners = thing(0.9).shape.corners()
    np.testing.assert_allclose(corners.min(axis=0), [0.7, -0.1, 0.45], atol=1e-12)
    np.testing.assert_allclose(corners.max(axis=0), [0.9, 0.1, 0.65], atol=1e-12)


def test_hollows_of_a_mesh_are_filled(model: Path, tmp_path: Path) -> None:
    file = tmp_path / "posts.obj"
    posts = [f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 0.1)]
    file.write_text("".join(posts) + "f 1 2 3\nf 5 6 7\nf 2 3 4\nf 6 7 8\n")
    between = ObstacleConfig("posts", placed(MeshShape(file), 0.2, -0.5, 0.45))
    assert ("p3_link", "posts") in cell_of(model, between).colliding_bodies(ZERO, NONE)


def test_obstacles_are_drawn_and_do_not_move(model: Path) -> None:
    cell = cell_of(model, ObstacleConfig("wall", placed(BoxShape((0.1, 0.1, 0.1)), 2.0, 0.0, 0.0)))
    frame = cell.plant.GetBodyFrameIdOrThrow(cell.obstacles[0].index())
    inspector = cell.scene_graph.model_inspector()
    assert inspector.NumGeometriesForFrameWithRole(frame, Role.kIllustration) == 1
    assert cell.plant.num_positions() == cell_of(model).plant.num_positions()


def test_corners_span_the_shape() -> None:
    box = placed(BoxShape((0.2, 0.4, 0.6)), 1.0, 2.0, 3.0, rpy=QUARTER).corners()
    np.testing.assert_allclose(np.ptp(box, axis=0), [0.4, 0.2, 0.6])
    np.testing.assert_allclose(box.mean(axis=0), [1.0, 2.0, 3.0])
    cylinder = placed(CylinderShape(0.1, 0.6), rpy=(0.0, np.pi / 2, 0.0)).corners()
    np.testing.assert_allclose(np.ptp(cylinder, axis=0), [0.6, 0.2, 0.2], atol=1e-9)
    np.testing.assert_allclose(np.ptp(placed(SphereShape(0.1)).corners(), axis=0), 0.2)


CUP = CylinderShape(0.04, 0.1)


def test_the_tool_moves_with_the_end_effector(model: Path) -> None:
    tool = ToolConfig("hand", placed(SphereShape(0.02), 0.0, 0.0, 0.1), (0.1, 0.0, 0.0), QUARTER)
    cell = cell_of(model, tool=tool)
    assert (cell.tool.model_instance(),) == cell.robot
    for q in (ZERO, np.array([0.3, -0.5, 0.9])):
        X_WE = cell.arm.pose(q)
        centre = X_WE @ [0.1, 0.0, 0.1, 1.0]
        assert distance(cell, cell.tool, centre[:3], q) == pytest.approx(-0.02, abs=1e-9)


def test_the_tool_hits_what_is_around_but_not_the_link_it_is_fixed_to(model: Path) -> None:
    tool = ToolConfig("hand", placed(CUP), (-0.05, 0.0, 0.0))  # the ball of p3_link is inside of it
    wall = ObstacleConfig("wall", placed(BoxShape((0.02, 1.0, 1.0)), 0.81, 0.0, 0.5))
    far, near = TableConfig((0.8, 0.0), (1, 1), 0.44), TableConfig((0.8, 0.0), (1, 1), 0.46)
    assert cell_of(model, tool=tool, table=far).colliding_bodies(ZERO, NONE) == ()
    for cell, hit in (
        (cell_of(model, tool=tool, table=near), "table"),
        (cell_of(model, wall, tool=ToolConfig("hand", placed(CUP))), "wall"),
    ):
        assert cell.colliding_bodies(ZERO, NONE) == (("tool", hit),)
        assert cell.collides(ZERO[None], NONE)[0]
    assert cell_of(model, wall).colliding_bodies(ZERO, NONE) == ()
    cell = cell_of(model, tool=tool, objects=[ObjectConfig("bowl", 0.08, 0.06)])
    X_WO = pose(np.eye(3), [[[0.75, 0.0, 0.4]], [[0.75, 0.0, 0.3]]])
    np.testing.assert_array_equal(cell.collides(np.zeros((2, 3)), X_WO), [True, False])


def test_the_tool_hits_links_that_move_against_it_unless_they_may_touch_it(gripper: Path) -> None:
    def hits(*touches: str, **around: object) -> tuple[tuple[str, str], ...]:
        held = ToolConfig("hand", placed(CUP), touches=touches)
        return cell_of(gripper, tool=held, **around).colliding_bodies(ZERO, NONE)

    assert hits() == (("finger_link", "tool"),)
    assert hits("finger_link") == ()
    table = TableConfig((0.8, 0.0), (1, 1), 0.46)
    assert hits("finger_link", table=table) == (("tool", "table"),)
    assert hits("finger_link", "table", table=table) == ()


def test_a_model_with_a_link_called_tool_keeps_it(tmp_path: Path) -> None:
    file = tmp_path / "arm.sdf"
    file.write_text(sdf(PLANAR).replace("p3_link", "tool"))
    robot = RobotConfig(str(file), ("p1", "p2", "p3"), "tool", (0.0,) * 3)
    held = RobotConfig(
        str(file), robot.joints, "tool", robot.start, tool=ToolConfig("tool", placed(CUP))
    )
    cell = build_workcell(held)
    assert cell.tool.name() == "tool_2"
    np.testing.assert_allclose(cell.arm.pose(ZERO), build_workcell(robot).arm.pose(ZERO))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"frame": "hnad"}, "no frame 'hnad'.*Did you mean 'hand'"),
        ({"frame": "p2_link"}, "frame 'p2_link' is not fixed to the end effector"),
        ({"touches": ("finger",)}, "robot.tool.touches: no part 'finger'.*p3_link"),
        ({"touches": ("table",)}, "robot.tool.touches: no part 'table'"),
    ],
)
def test_what_a_tool_names_must_be_there(model: Path, changes: dict, message: str) -> None:
    settings = {"frame": "hand", "shape": placed(CUP), **changes}
    with pytest.raises(ModelError, match=f"(?s){message}"):
        cell_of(model, tool=ToolConfig(**settings))


@pytest.mark.parametrize(
    ("names", "kind"),
    [
        (["small"], "an obstacle"),
        (["table"], "an obstacle"),
        (["wall", "wall"], "an obstacle"),
        (["bowl"], "an object"),
    ],
)
def test_every_thing_needs_a_name_of_its_own(model: Path, names: list[str], kind: str) -> None:
    with pytest.raises(ModelError, match=f"the name '{names[0]}' of {kind} is taken"):
        cell_of(
            model,
            *(ObstacleConfig(name, placed(SphereShape(0.1), 3.0, 0.0, 0.0)) for name in names),
            tool=ToolConfig("hand", placed(CUP)),
            table=TableConfig((0.8, 0.0), (1, 1), 0.0),
            objects=[ObjectConfig("bowl", 0.08, 0.06)],
        )


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("gone.obj", None, "there is no such mesh"),
        ("../", None, "no mesh: it is a folder"),
        ("/dev/null", None, "no mesh: it is a device or a pipe, not a file"),
        ("part.step", "ISO-10303-21;", "'.step' is no kind of mesh"),
        ("words.obj", "hello\n", "Drake cannot read this mesh"),
        ("line.obj", "v 0 0 0\nv 1 0 0\n", "Drake cannot read this mesh"),
        ("broken.gltf", "{}", "Drake cannot read this mesh"),
    ],
)
def test_what_is_no_mesh_is_told_with_its_file_and_place(
    model: Path, tmp_path: Path, name: str, text: str | None, message: str
) -> None:
    file = tmp_path / name
    if text is not None:
        file.write_text(text)
    shape = placed(MeshShape(file), 3.0, 0.0, 0.0)
    with pytest.raises(ModelError) as caught:
        cell_of(model, ObstacleConfig("thing", shape))
    assert caught.value.file == file
    assert caught.value.message.startswith(f"obstacle 'thing': {message}")
    assert ".obj, .gltf or .vtk" in caught.value.remedy
    with pytest.raises(ModelError, match=f"robot.tool.shape: {message}"):
        cell_of(model, tool=ToolConfig("hand", shape))


def test_a_folder_is_no_mesh(model: Path, tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="it is a folder"):
        cell_of(model, ObstacleConfig("thing", placed(MeshShape(tmp_path))))
