"""Copies of links have one colour, whatever colours their meshes bring."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Meshcat

from drake_screw.robot import RobotConfig, build_workcell
from drake_screw.visualization.linkage import Linkage
from tests.robot.small_arms import PLANAR, sdf

CORNERS = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.2, 0], [0, 0, 0.3]], dtype="<f4")
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype="<u2")
OBJ = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "".join(
    f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES
)


def gltf() -> str:
    data = CORNERS.tobytes() + FACES.tobytes()
    parts = [(0, CORNERS.nbytes), (CORNERS.nbytes, FACES.nbytes)]
    views = [{"buffer": 0, "byteOffset": at, "byteLength": size} for at, size in parts]
    lower, upper = CORNERS.min(axis=0).tolist(), CORNERS.max(axis=0).tolist()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "buffers": [{"uri": uri, "byteLength": len(data)}],
            "bufferViews": views,
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                 "min": lower, "max": upper},
                {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"},
            ],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "nodes": [{"mesh": 0}],
            "scenes": [{"nodes": [0]}],
            "scene": 0,
        }
    )  # fmt: skip


@pytest.mark.parametrize(
    ("name", "text", "plain"),
    [
        ("look.gltf", gltf(), True),
        ("look.obj", "mtllib look.mtl\nusemtl red\n" + OBJ, True),
        ("look.obj", OBJ, False),
    ],
    ids=["gltf", "obj with materials", "obj"],
)
def test_a_copy_has_its_colour(name: str, text: str, plain: bool, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    (tmp_path / "look.mtl").write_text("newmtl red\nKd 1 0 0\n")
    look = f"<geometry><mesh><uri>{name}</uri><scale>2 1 1</scale></mesh></geometry>"
    ball = "<sphere><radius>0.05</radius></sphere>"
    model = sdf(PLANAR, shapes={"p3_link": ball})
    model = model.replace("<collision", f"<visual name='v'>{look}</visual><collision", 1)
    (tmp_path / "arm.sdf").write_text(model)
    robot = RobotConfig(str(tmp_path / "arm.sdf"), ("p1", "p2", "p3"), "hand", (0.0, 0.0, 0.0))
    meshcat, linkage = Meshcat(), Linkage(build_workcell(robot))
    linkage.draw_copy(meshcat, "/ghost", np.zeros(3), "#3366cc", 0.22)
    assert linkage.names == ("small/p3_link",)
    drawn = meshcat._GetPackedObject("/ghost/small/p3_link/small/v")
    assert (b"_meshfile_" in drawn) is not plain
    assert (b"BufferGeometry" in drawn) is plain
    assert b"0.22" in drawn or b"transparent" in drawn
    assert b"red" not in drawn
