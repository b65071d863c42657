"""A look at a recording in Meshcat, beside the workcell that `Scene` draws.

Under ``/recording``: ``path`` (the end effector's), ``objects``, ``regions`` (spheres, the regions
of interest), ``guiding_poses``, and of each screw ``screws/01``, ... (the path along it) and
``axes/01``, ....
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydrake.geometry import Meshcat, MeshcatAnimation, Sphere
from pydrake.math import RigidTransform

from drake_screw.demonstrations import Look
from drake_screw.demonstrations.faithful import thin
from drake_screw.robot import ObjectConfig
from drake_screw.typing import Array
from drake_screw.visualization import meshes
from drake_screw.visualization.drawing import draw, draw_frames, rgba
from drake_screw.visualization.inspector import BOWL
from drake_screw.visualization.linkage import Linkage
from drake_screw.visualization.look_figures import object_color
from drake_screw.visualization.palette import QUIET
from drake_screw.visualization.screw_drawing import draw_screw, screw_track

FRAMES = 12
"""A second, of the arm as it was led."""
VIEW = (0.8, 0.55, 0.5)
"""m, of the camera from what it looks at."""


def draw_look(meshcat: Meshcat, look: Look, objects: Sequence[ObjectConfig]) -> None:
    """Draw a recording in place of the one before, and aim the camera.

    Args:
        meshcat: drawn into.
        look: at the recording.
        objects: how they look, in their order.
    """
    draw_path(meshcat, look)
    for i, (item, X) in enumerate(zip(objects, look.X_WO, strict=True)):
        bowl = meshes.bowl(item.radius, item.height).moved(X)
        draw(meshcat, f"/recording/objects/{item.name}", bowl, BOWL)
        if look.shown.regions.task[i]:
            place = f"/recording/regions/{item.name}"
            meshcat.SetObject(place, Sphere(float(look.radius[i])), rgba(object_color(i), 0.09))
            meshcat.SetTransform(place, RigidTransform(X[:3, 3]))
    draw_frames(meshcat, "/recording/guiding_poses", look.guides, size=0.04)
    for number, segment in enumerate(look.screws, start=1):
        track, color = screw_track(segment.X_WA, segment.X_WB), object_color(segment.object)
        if len(track) > 1:
            line = meshes.tube(track, 0.009, sides=8)
            draw(meshcat, f"/recording/screws/{number:02d}", line, color)
        draw_screw(meshcat, f"/recording/axes/{number:02d}", segment.X_WA, segment.X_WB, color)
    target = 0.5 * (look.X_WE[:, :3, 3].mean(axis=0) + look.X_WO[:, :3, 3].mean(axis=0))
    meshcat.SetCameraPose(target + np.array(VIEW), target)


def draw_path(meshcat: Meshcat, look: Look, color: str = QUIET) -> None:
    """Draw the end effector's path alone, in place of the recording before."""
    clear_path(meshcat)
    path = look.X_WE[thin(look.X_WE, 0.004, np.inf), :3, 3]
    if len(path) > 1:
        draw(meshcat, "/recording/path", meshes.tube(path, 0.006), color)


def clear_path(meshcat: Meshcat) -> None:
    """Show no recording."""
    meshcat.Delete("/recording")


def animate(meshcat: Meshcat, linkage: Linkage, t: Array, q: Array) -> None:
    """Let the arm of `Scene` move as it was led, over and over.

    Args:
        meshcat: that shows it.
        linkage: of the arm.
        t: (m,) s.
        q: (m, n) rad or m.
    """
    animation = MeshcatAnimation(FRAMES)
    animation.set_loop_mode(MeshcatAnimation.LoopMode.kLoopRepeat)
    at = np.arange(0.0, t[-1] + 1.0 / FRAMES, 1.0 / FRAMES)
    X_WL = linkage.poses(q[np.minimum(np.searchsorted(t, at), len(t) - 1)])
    for link, name in enumerate(linkage.names):
        for frame, X in enumerate(X_WL[:, link]):
            animation.SetTransform(frame, f"/workcell/{name}", RigidTransform(X))
    meshcat.SetAnimation(animation)
