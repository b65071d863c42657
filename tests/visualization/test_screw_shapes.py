from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from drake_screw.visualization import screw_shapes
from drake_screw.visualization.meshes import Mesh

UP = np.array([0.0, 0.0, 1.0])


def volume(mesh: Mesh) -> float:
    """Positive if all triangles face outwards."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def edges(mesh: Mesh) -> dict[tuple[int, int], int]:
    count: dict[tuple[int, int], int] = {}
    for face in mesh.faces.tolist():
        for edge in pairwise([*face, face[0]]):
            count[edge] = count.get(edge, 0) + 1
    return count


def test_a_sector_is_a_closed_piece_of_a_ring() -> None:
    mesh = screw_shapes.sector(0.09, 0.13, -1.5, 2.0, 0.006)
    exact = 0.5 * (0.13**2 - 0.09**2) * 3.5 * 0.006
    assert volume(mesh) == pytest.approx(exact, rel=2e-3)
    counted = edges(mesh)
    assert all(counted[edge] == 1 and counted.get(edge[::-1]) == 1 for edge in counted)
    angle = np.arctan2(mesh.vertices[:, 1], mesh.vertices[:, 0])
    assert angle.min() == pytest.approx(-1.5)
    assert angle.max() == pytest.approx(2.0)


def test_an_arrow_goes_from_point_to_point() -> None:
    start, end = np.array([0.1, 0.2, 0.3]), np.array([0.4, -0.2, 0.5])
    mesh = screw_shapes.arrow(start, end, 0.01)
    way = (end - start) / np.linalg.norm(end - start)
    along = (mesh.vertices - start) @ way
    assert along.min() == pytest.approx(0.0, abs=1e-9)
    assert along.max() == pytest.approx(np.linalg.norm(end - start))
    assert volume(mesh) > 0.0


@pytest.mark.parametrize(("angle", "translation"), [(0.3, 0.0), (2.0, 0.05), (np.pi, -0.1)])
def test_a_turning_ends_where_the_screw_does(angle: float, translation: float) -> None:
    first = np.array([1.0, 0.0, 0.0])
    mesh = screw_shapes.turning(UP, np.zeros(3), first, angle, translation, 0.004)
    r = screw_shapes.RADIUS
    end = np.array([r * np.cos(angle), r * np.sin(angle), translation])
    assert np.linalg.norm(mesh.vertices - end, axis=1).min() < 1e-9
    begin = np.array([r, 0.0, 0.0])
    assert np.linalg.norm(mesh.vertices - begin, axis=1).min() < 0.003


@pytest.mark.parametrize("direction", [UP, -UP, np.array([0.6, -0.8, 0.0])])
def test_a_frame_along_a_direction(direction: np.ndarray) -> None:
    R = screw_shapes.along(direction)
    assert np.allclose(R[:, 2], direction)
    assert np.allclose(R.T @ R, np.eye(3))
    assert np.linalg.det(R) == pytest.approx(1.0)
