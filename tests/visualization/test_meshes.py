from __future__ import annotations

import numpy as np
import pytest

from drake_screw.screws import pose_from_planar
from drake_screw.visualization import meshes


def area(mesh: meshes.Mesh) -> float:
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def test_a_bowl_has_the_size_it_was_given() -> None:
    bowl = meshes.bowl(0.08, 0.06)
    np.testing.assert_allclose(bowl.vertices.min(axis=0), [-0.08, -0.08, 0.0], atol=1e-12)
    np.testing.assert_allclose(bowl.vertices.max(axis=0), [0.08, 0.08, 0.06], atol=1e-12)


def test_a_bowl_is_open_on_top() -> None:
    bowl = meshes.bowl(0.08, 0.06)
    near_axis = np.linalg.norm(bowl.vertices[:, :2], axis=1) < 0.03
    assert bowl.vertices[near_axis, 2].max() < 0.02


def test_a_ring_lies_flat_and_has_the_area_of_a_torus() -> None:
    ring = meshes.ring(0.1, 0.01)
    assert ring.vertices[:, 2].min() == pytest.approx(0.0, abs=1e-12)
    assert area(ring) == pytest.approx(4 * np.pi**2 * 0.1 * 0.005, rel=0.02)


def test_a_tube_keeps_its_distance_from_its_path() -> None:
    s = np.linspace(0.0, 6.0, 200)
    path = np.stack([0.3 * np.cos(s), 0.3 * np.sin(s), 0.05 * s], axis=-1)
    tube = meshes.tube(path, 0.01, sides=6)
    distance = np.linalg.norm(tube.vertices.reshape(200, 6, 3) - path[:, None], axis=-1)
    np.testing.assert_allclose(distance, 0.005, rtol=1e-9)
    length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    assert area(tube) == pytest.approx(length * 6 * 0.005, rel=0.03)


def test_a_tube_does_not_twist_where_its_path_turns_through_an_axis() -> None:
    path = np.array([[0.0, 0, 0], [1, 0, 0.1], [1.1, 1, 0.2], [1.1, 1.1, 1.2]])
    tube = meshes.tube(path, 0.02).vertices.reshape(4, 6, 3) - path[:, None]
    neighbours = (tube[1:] * tube[:-1]).sum(axis=-1) / 0.01**2
    assert neighbours.min() > 0.0


def test_rectangles_face_up_and_fill_their_corners() -> None:
    mesh = meshes.rectangles([[0.0, 0.0], [1.0, 1.0]], [[0.5, 0.2], [2.0, 3.0]], 0.7)
    assert len(mesh.vertices) == 8
    assert area(mesh) == pytest.approx(0.1 + 2.0)
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    assert (np.cross(b - a, c - a)[:, 2] > 0.0).all()
    assert (mesh.vertices[:, 2] == 0.7).all()


def test_a_frame_stays_inside_and_does_not_overlap() -> None:
    frame = meshes.frame([0.0, 1.0], [2.0, 4.0], 0.0, 0.1)
    assert area(frame) == pytest.approx(2.0 * 3.0 - 1.8 * 2.8)
    np.testing.assert_allclose(frame.vertices[:, :2].min(axis=0), [0.0, 1.0])
    np.testing.assert_allclose(frame.vertices[:, :2].max(axis=0), [2.0, 4.0])


def test_numbers_look_different_and_are_as_high_as_asked() -> None:
    strokes = {tuple(meshes.number(n, 1.0).vertices.ravel().round(6)) for n in range(20)}
    assert len(strokes) == 20
    eight = meshes.number(8, 0.02).vertices
    np.testing.assert_allclose(eight[:, 1].min(), -0.01)
    np.testing.assert_allclose(eight[:, 1].max(), 0.01)


def test_join_and_move() -> None:
    disc = meshes.disc(0.1, 0.02)
    X = pose_from_planar([1.0, 2.0, 0.5], 3.0)
    both = meshes.join([disc, disc.moved(X)])
    assert len(both.faces) == 2 * len(disc.faces)
    assert both.faces.dtype == np.int32
    assert area(both) == pytest.approx(2 * area(disc))
    np.testing.assert_allclose(both.vertices[-1], [1.0, 2.0, 3.02], atol=1e-12)
