from __future__ import annotations

import numpy as np
import pytest
from pydrake.geometry import Role

from drake_screw.execution import build_station
from drake_screw.robot import ObjectConfig
from drake_screw.visualization.object_looks import bowl_look
from tests.execution.conftest import robot

__all__ = ["robot"]

BOWL = ObjectConfig("bowl", 0.08, 0.06)


def test_a_bowl_is_hollow_and_as_large_as_its_object() -> None:
    text = bowl_look(BOWL).source().in_memory().mesh_file.contents().decode()
    lines = [line.split() for line in text.splitlines()]
    vertices = np.array([line[1:] for line in lines if line[0] == "v"], dtype=float)
    radius = np.linalg.norm(vertices[:, :2], axis=1)
    assert radius.max() == pytest.approx(0.08, abs=1e-5)
    assert vertices[:, 2].min() == 0.0
    assert vertices[:, 2].max() == pytest.approx(0.06, abs=1e-5)
    assert vertices[radius < 1e-6, 2].max() < 0.02  # the bottom, seen from above
    faces = np.array([line[1:] for line in lines if line[0] == "f"], dtype=int)
    assert (faces.min(), faces.max()) == (1, len(vertices))


def test_a_station_takes_the_look_and_keeps_the_collision_shape(robot) -> None:
    for looks, name in ((None, "Cylinder"), ([bowl_look(BOWL)], "Mesh")):
        station = build_station(robot, objects=[BOWL], looks=looks)
        inspector = station.scene_graph.model_inspector()
        frame = station.plant.GetBodyFrameIdOrThrow(station.objects[0].index())
        for role, shape in ((Role.kIllustration, name), (Role.kProximity, "Cylinder")):
            (geometry,) = inspector.GetGeometries(frame, role)
            assert type(inspector.GetShape(geometry)).__name__ == shape
