"""Charts of a look show the numbers of the look."""

from __future__ import annotations

import base64

import numpy as np
import pytest
from pydrake.geometry import Meshcat

from drake_screw.robot import ObjectConfig
from drake_screw.screws import pose
from drake_screw.visualization.figure_files import figure_address
from drake_screw.visualization.look_figures import (
    deviation_figure,
    distance_figure,
    joint_figure,
)
from drake_screw.visualization.look_scene import draw_look
from drake_screw.visualization.look_view import view_figure
from tests.demonstrations.test_look import looked

OBJECTS = (ObjectConfig("jug", 0.08, 0.06), ObjectConfig("mug", 0.04, 0.1))


def far():
    return looked(X_WO=pose(np.eye(3), [[0.5, -0.8, 0.0], [0.5, 1.4, 0.0]]))


def lines(ax, gid):
    return [line for line in ax.lines if line.get_gid() == gid]


def test_distances_with_their_regions() -> None:
    look = looked()
    (ax,) = distance_figure(look).axes
    for i, line in enumerate(lines(ax, "distance")):
        np.testing.assert_array_equal(line.get_ydata(), look.distance[:, i])
    assert [line.get_ydata()[0] for line in lines(ax, "radius")] == look.radius.tolist()
    spans = [patch for patch in ax.patches if patch.get_gid() == "visit"]
    assert len(spans) == len(look.shown.regions.visits) > 1
    for span, visit in zip(spans, look.shown.regions.visits, strict=True):
        assert span.get_x() == look.t[visit.start]
        assert span.get_x() + span.get_width() == pytest.approx(look.t[visit.stop - 1])


def test_deviations_with_their_tolerances() -> None:
    look = looked()
    place, turn = deviation_figure(look).axes
    drawn = [line.get_ydata().max() for line in place.lines if len(line.get_xdata()) > 2]
    assert max(drawn) == pytest.approx(1e3 * max(d.position.max() for d in look.deviations))
    assert lines(place, "tolerance")[0].get_ydata()[0] == 10.0
    assert lines(turn, "tolerance")[0].get_ydata()[0] == 0.1
    assert place.get_ylim()[1] > 10.0


def test_joints_between_their_limits() -> None:
    look = looked()
    axes = joint_figure(look).axes
    assert len(axes) == 4
    for j, ax in enumerate(axes):
        assert [line.get_ydata()[0] for line in lines(ax, "limit")] == [-1.0, 1.0]
        (dot,) = lines(ax, "tightest")
        margin = 1.0 - abs(float(dot.get_ydata()[0]))
        assert margin == pytest.approx(look.margin[:, j].min())


def test_the_path_in_three_dimensions() -> None:
    look = looked()
    whole, near = view_figure(look, OBJECTS).axes
    assert len(lines(whole, "screw")) == len(lines(near, "screw")) == len(look.screws)
    path = np.stack(lines(whole, "path")[0].get_data_3d(), axis=1)
    np.testing.assert_array_equal(path, look.X_WE[:, :3, 3])


def test_what_is_refused_is_drawn_without_screws() -> None:
    look = far()
    assert look.demonstration is None
    (whole,) = view_figure(look, OBJECTS).axes
    assert lines(whole, "screw") == []
    assert len(distance_figure(look).axes) == 1


def test_a_figure_becomes_the_same_bytes_every_time() -> None:
    look = looked()
    first, second = (figure_address(distance_figure(look)) for _ in range(2))
    assert first == second
    assert b"<svg" in base64.b64decode(first.split(",")[1])


def test_the_scene_has_each_screw_once(meshcat: Meshcat) -> None:
    for look in (far(), looked()):
        draw_look(meshcat, look, OBJECTS)
        count = len(look.screws)
        assert meshcat.HasPath("/recording/path")
        assert meshcat.HasPath("/recording/objects/mug")
        assert meshcat.HasPath("/recording/regions/jug") == (count > 0)
        assert meshcat.HasPath(f"/recording/screws/{max(count, 1):02d}") == (count > 0)
        assert not meshcat.HasPath(f"/recording/screws/{count + 1:02d}")
