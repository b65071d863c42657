"""Mesh files that Drake does not read, converted once by trimesh and kept in the cache folder."""

from __future__ import annotations

import hashlib
import importlib
import logging
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drake_screw.errors import ModelError
from drake_screw.robot.kept_files import is_whole, keep_sealed, kept_folder
from drake_screw.typing import Array

CONVERTED = (".stl", ".dae", ".glb", ".ply", ".off")
"""Formats that are converted because Drake does not read them."""

MOST_FACES = 8_000
"""Triangles of a look; meshes of more are coarsened, so that pages stay small."""

CELLS = 128
"""Cells along the longest side of a mesh to be coarsened, to begin with."""

_VERSION = "3"
"""Of what is made of a mesh: a new number makes it all again."""

_log = logging.getLogger(__name__)


class _Part(NamedTuple):
    """Vertices (v, 3), triangles (f, 3), and a colour (3,) in 0..1 where the file has one."""

    vertices: Array
    faces: Array
    color: Array | None


def hull_file(file: Path) -> Path:
    """The convex hull of a mesh, which is what Drake looks at for collisions, as an OBJ file.

    Coordinates are those of the file. Of COLLADA they are in m, its unit taken into account; its
    up axis is not, which is how ROS, Gazebo and Pinocchio read it. Of glTF z is up, as Drake has
    it.

    Raises:
        ModelError: it cannot be read, or is flat.
    """
    kept = _kept(file, "hull")
    if not is_whole(kept):
        from scipy.spatial import ConvexHull, QhullError  # take long to import

        points = np.concatenate([part.vertices for part in _parts(file)])
        try:
            hull = ConvexHull(points)
        except (QhullError, ValueError) as error:
            raise ModelError("is flat, or next to nothing", file=file) from error
        number = np.full(len(points), -1)
        number[hull.vertices] = np.arange(len(hull.vertices))
        part = _Part(points[hull.vertices], number[hull.simplices], None)
        keep_sealed(kept, "".join(_lines([part])))
        _log.debug("hull of %s: %d corners", file, len(hull.vertices))
    return kept


def look_file(file: Path) -> Path:
    """A mesh as it looks, with its colours, as an OBJ file; coarser where it has many triangles.

    Raises:
        ModelError: it cannot be read.
    """
    kept = _kept(file, "look")
    materials = kept.with_suffix(".mtl")
    if not is_whole(kept) or (_has_materials(kept) and not is_whole(materials)):
        parts = _parts(file)
        share = MOST_FACES / max(sum(len(part.faces) for part in parts), 1)
        if share < 1.0:
            parts = [_coarser(part, max(int(share * len(part.faces)), 100)) for part in parts]
        parts = [_merged(part) for part in parts]
        colors = [part.color for part in parts]
        if any(color is not None for color in colors):
            keep_sealed(materials, "".join(_materials(colors)))
        keep_sealed(kept, "".join(_lines(parts, materials.name)))
    return kept


def content_hash(file: Path) -> str:
    """SHA-256 of a mesh, without the files that it refers to."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _kept(file: Path, what: str) -> Path:
    text = f"{_VERSION}\0{what}\0{file.suffix.lower()}\0{content_hash(file)}"
    name = hashlib.sha256(text.encode()).hexdigest()[:32]
    return kept_folder("meshes") / f"{file.stem}_{name}.obj"


def _has_materials(look: Path) -> bool:
    with look.open("rb") as lines:
        return lines.readline().startswith(b"mtllib")


def _parts(file: Path) -> list[_Part]:
    """The meshes in a file, each where it is in the file's frame."""
    suffix = file.suffix.lower()
    if suffix not in (*CONVERTED, ".obj"):
        raise ModelError(
            f"is of a kind ('{file.suffix}') that neither Drake reads nor we convert", file=file
        )
    try:
        trimesh: Any = importlib.import_module("trimesh")
        if suffix == ".dae":
            importlib.import_module("collada")
    except ImportError as error:
        raise ModelError(
            f"needs {error.name} to be converted, which is not installed "
            "(pip install 'drake-screw[meshes]')",
            file=file,
        ) from error
    _announce()
    try:
        scene = trimesh.load_scene(str(file))
        parts = list(_placed(scene, 1.0 if suffix != ".dae" else _unit(file)))
    except Exception as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise ModelError(f"cannot be read ({reason})", file=file) from error
    if not parts:
        raise ModelError("holds no triangles", file=file)
    if suffix == ".glb":
        turned = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
        parts = [part._replace(vertices=part.vertices @ turned.T) for part in parts]
    return parts


@lru_cache
def _announce() -> None:
    _log.info("converting meshes, once; this takes a few seconds")


def _placed(scene: Any, unit: float) -> Iterator[_Part]:
    for node in scene.graph.nodes_geometry:
        X, name = scene.graph[node]
        mesh = scene.geometry[name]
        faces = getattr(mesh, "faces", ())
        if len(faces):
            vertices = np.asarray(mesh.vertices, dtype=float) @ X[:3, :3].T + X[:3, 3]
            if np.isfinite(vertices).all():
                yield _Part(unit * vertices, np.asarray(faces), _color(mesh))


def _unit(file: Path) -> float:
    """Metres that 1 stands for in a COLLADA file."""
    collada: Any = importlib.import_module("collada")
    document = collada.Collada(str(file), ignore=[collada.common.DaeError])
    unit = document.assetInfo.unitmeter
    return 1.0 if unit is None else float(unit)


def _color(mesh: Any) -> Array | None:
    """The colour of a mesh that has one for all of it."""
    visual = mesh.visual
    found = None
    if visual.kind == "texture":
        found = getattr(visual.material, "main_color", None)
    elif visual.kind in ("face", "vertex"):
        found = visual.main_color
    return None if found is None else np.asarray(found, dtype=float)[:3] / 255.0


def _coarser(part: _Part, most: int) -> _Part:
    """About as it looks, with `most` triangles or fewer: vertices of a cell become one."""
    lower = part.vertices.min(axis=0)
    side = float((part.vertices.max(axis=0) - lower).max()) or 1.0
    cells = CELLS
    while True:
        cell = np.floor((part.vertices - lower) / side * cells).astype(int)
        _, into, count = np.unique(cell, axis=0, return_inverse=True, return_counts=True)
        into = into.reshape(-1)
        faces = into[part.faces]
        distinct = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
        faces = np.unique(faces[distinct], axis=0)
        if len(faces) <= most or cells <= 4:
            middle = np.zeros((len(count), 3))
            np.add.at(middle, into, part.vertices)
            return _Part(middle / count[:, None], faces, part.color)
        cells = int(cells * 0.8)


def _merged(part: _Part) -> _Part:
    """The same with every vertex once."""
    vertices, into = np.unique(part.vertices, axis=0, return_inverse=True)
    return part._replace(vertices=vertices, faces=into.reshape(-1)[part.faces])


def _lines(parts: list[_Part], materials: str | None = None) -> Iterator[str]:
    colored = materials is not None and any(part.color is not None for part in parts)
    if colored:
        yield f"mtllib {materials}\n"
    first = 1
    for i, part in enumerate(parts):
        if colored:
            yield f"usemtl part_{i}\n"
        yield from (f"v {x:.7g} {y:.7g} {z:.7g}\n" for x, y, z in part.vertices.tolist())
        yield from (f"f {a} {b} {c}\n" for a, b, c in (part.faces + first).tolist())
        first += len(part.vertices)


def _materials(colors: list[Array | None]) -> Iterator[str]:
    for i, color in enumerate(colors):
        r, g, b = (0.8, 0.8, 0.8) if color is None else color.tolist()
        yield f"newmtl part_{i}\nKd {r:.4f} {g:.4f} {b:.4f}\n"
