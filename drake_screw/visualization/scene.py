"""The workcell in Meshcat, with the heat map lying on the table.

Everything hangs under these paths of the scene tree, where the browser's control panel can hide it:
``/workcell`` (robot, table and obstacles), ``/work_area``, ``/objects``, ``/demonstrations/01``,
..., ``/instances`` (the last round's) and ``/rounds/01``, ....
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from pydrake.geometry import (
    Meshcat,
)
from pydrake.perception import BaseField, Fields, PointCloud

from drake_screw.demonstrations import Demonstration
from drake_screw.files import write_text
from drake_screw.planning import Cause
from drake_screw.robot import ObjectConfig, ObstacleConfig, RobotConfig, TableConfig
from drake_screw.screws import pose_from_planar
from drake_screw.tasks import Regions, WorkArea
from drake_screw.typing import Array
from drake_screw.visualization import meshes
from drake_screw.visualization.camera import camera_pose
from drake_screw.visualization.cells import Cells, cells, table_axes
from drake_screw.visualization.drawing import draw, draw_frames, rgba
from drake_screw.visualization.legend import Slide, slide, with_legend
from drake_screw.visualization.palette import (
    ACCENT,
    INK,
    OUTCOME_COLORS,
    OUTCOME_NAMES,
    PAPER,
    failure_color,
    linear_from_srgb,
)
from drake_screw.visualization.rounds import Round, Sample, sample
from drake_screw.visualization.workcell_drawing import draw_workcell

MOST_DOTS = 6_000
CLAY = "#efeee6"
PATH = "#3d3a4a"
BACK = (1.12, -0.15, 0.84)
"""From the workcell to the camera."""
AROUND = 0.1
"""m, around the work area, for objects at its border."""
SKY = ([0.93, 0.94, 0.96], [0.70, 0.72, 0.76])


class Scene:
    """Draws a run into Meshcat, round by round.

    The robot stands in its start configuration. Shown of a round are the regions coloured by
    estimated failure probability with the weakest framed, instances coloured by outcome, the
    suggested place as glowing objects; of the demonstrations in hand the path of the end effector,
    the guiding poses as triads and a numbered token where the object stood, with the objects
    themselves at the latest one. Earlier rounds stay in the scene tree, hidden.

    Args:
        meshcat: drawn into; the paths above are replaced.
        robot: model and start configuration.
        table: drawn if there is one.
        objects: how the objects look, in the order of the area's objects.
        area: the work area.
        scenario: its name, for the legend of the saved page.
        dots: most instances to draw of a round; more are thinned to a random sample.
        obstacles: drawn where they are.

    Raises:
        ModelError: the robot's model or a mesh cannot be read, or the model lacks a name the
            configuration asks for.
    """

    def __init__(
        self,
        meshcat: Meshcat,
        robot: RobotConfig,
        table: TableConfig | None,
        objects: Sequence[ObjectConfig],
        area: WorkArea,
        *,
        scenario: str = "",
        dots: int = MOST_DOTS,
        obstacles: Sequence[ObstacleConfig] = (),
    ) -> None:
        self.meshcat = meshcat
        self._objects = tuple(objects)
        self._area = area
        self._table = table
        self._scenario = scenario
        self._dots = dots
        self._slides: dict[int, Slide] = {}
        self._shown: Sample | None = None
        for path in ("/workcell", "/work_area", "/objects", "/demonstrations", "/instances"):
            meshcat.Delete(path)
        meshcat.Delete("/rounds")
        meshcat.SetProperty("/Grid", "visible", False)
        meshcat.SetProperty("/Axes", "visible", False)
        meshcat.SetProperty("/Background", "top_color", SKY[0])
        meshcat.SetProperty("/Background", "bottom_color", SKY[1])
        p_WR = draw_workcell(meshcat, robot, table, obstacles)
        self._draw_area()
        self._aim_camera(p_WR)

    def show_round(self, event: Round, regions: Regions) -> Sample:
        """Draw a finished round in place of the one before.

        Returns:
            The instances that were drawn.
        """
        path = _round_path(event.round)
        self._hide_rounds()
        self.meshcat.Delete(path)
        drawn = cells(regions, event.verdict.estimates, table_axes(self._area))
        self._draw_regions(path, drawn, event)
        if event.suggestion is not None:
            self._draw_suggestion(f"{path}/next", event.suggestion.coordinates)
        self.meshcat.SetProperty(path, "visible", True)
        self._draw_demonstrations(event.demonstrations, drawn)
        shown = sample(event.evaluation, self._dots)
        self._draw_instances(shown, drawn)
        self._slides.pop(event.round, None)
        self._slides[event.round] = slide(event, regions)
        self._shown = shown
        return shown

    def show_rates(
        self,
        rates: Array,
        regions: Regions,
        demonstrations: Sequence[Demonstration],
    ) -> None:
        """Draw a round that is still going on in place of the one before.

        Args:
            rates: (K,) failure rates so far, NaN where there is none.
            regions: what they are of.
            demonstrations: in hand.
        """
        drawn = cells(regions, rates, table_axes(self._area))
        if not self.meshcat.HasPath("/progress/regions"):
            self._hide_rounds()
            self.meshcat.Delete("/instances")
            self._draw_demonstrations(demonstrations, drawn)
        self._draw_tiles("/progress/regions", drawn, rates)

    def show_suggestion(self, coordinates: Array) -> None:
        """Let the place (k, c) of a wanted demonstration glow, and no other."""
        if self._slides:
            self.meshcat.Delete(f"{_round_path(max(self._slides))}/next")
        self._draw_suggestion("/progress/next", coordinates)

    def clear_suggestion(self) -> None:
        """Let no place glow."""
        self.meshcat.Delete("/progress/next")

    def save_html(self, path: str | Path) -> Path:
        """Write the scene as one page that needs no network, with a legend.

        It opens on the last round; buttons in the legend lead to the earlier ones.
        """
        page = self.meshcat.StaticHtml()
        if self._shown is not None:
            slides = list(self._slides.values())
            page = with_legend(page, slides, self._shown, scenario=self._scenario)
        path = Path(path)
        write_text(path, page)
        return path

    def _hide_rounds(self) -> None:
        self.meshcat.Delete("/progress")
        for earlier in self._slides:
            self.meshcat.SetProperty(_round_path(earlier), "visible", False)

    def _draw_area(self) -> None:
        for i, item in enumerate(self._area.objects):
            lower, upper = np.array(item.lower[:2]) - 0.006, np.array(item.upper[:2]) + 0.006
            outline = meshes.frame(lower, upper, self._height(i), 0.006)
            draw(self.meshcat, f"/work_area/{item.name}", outline.moved(self._X_WP(i)), INK)

    def _aim_camera(self, p_WR: Array) -> None:
        """Have the robot, around which points (n, 3) are, and the work area in the picture."""
        stands = np.array([item.on is None for item in self._area.objects])
        lower, upper = self._area.lower[stands, :2], self._area.upper[stands, :2]
        z = float(self._area.z[stands].min())
        (x0, y0), (x1, y1) = lower.min(axis=0) - AROUND, upper.max(axis=0) + AROUND
        corners = np.array([[x, y, z] for x in (x0, x1) for y in (y0, y1)])
        points = np.concatenate([p_WR, corners])
        self.meshcat.SetCameraPose(*camera_pose(points, BACK, corners.mean(axis=0)))

    def _draw_tiles(self, path: str, drawn: Cells, rates: Array) -> float:
        """The regions coloured by failure rates (K,); returns the height they lie at."""
        z = self._height(drawn.object)
        tiles = meshes.rectangles(drawn.lower, drawn.upper, z).moved(self._X_WP(drawn.object))
        color = np.repeat(_vertex_color(failure_color(rates[drawn.region])), 4, axis=0)
        self.meshcat.SetTriangleColorMesh(path, tiles.vertices.T, tiles.faces.T, color.T)
        return z

    def _draw_regions(self, path: str, drawn: Cells, event: Round) -> None:
        z = self._draw_tiles(f"{path}/regions", drawn, event.verdict.estimates)
        region = event.verdict.weakest
        if region is None:
            return
        lower, upper = drawn.outlines[region]
        X_WP = self._X_WP(drawn.object)
        inner = meshes.frame(lower, upper, z + 0.001, 0.014).moved(X_WP)
        outer = meshes.frame(lower, upper, z + 0.0015, 0.008).moved(X_WP)
        draw(self.meshcat, f"{path}/weakest/halo", inner, PAPER)
        draw(self.meshcat, f"{path}/weakest/line", outer, INK)

    def _draw_suggestion(self, path: str, coordinates: Array) -> None:
        for item, X_WO in zip(self._objects, self._area.X_WO(coordinates), strict=True):
            bowl = meshes.bowl(item.radius, item.height).moved(X_WO)
            ring = meshes.ring(1.25 * item.radius, 0.008).moved(X_WO)
            draw(self.meshcat, f"{path}/{item.name}/object", bowl, ACCENT, 0.65)
            draw(self.meshcat, f"{path}/{item.name}/ring", ring, ACCENT)

    def _draw_demonstrations(self, demonstrations: Sequence[Demonstration], drawn: Cells) -> None:
        self.meshcat.Delete("/demonstrations")
        self.meshcat.Delete("/objects")
        for i, demonstration in enumerate(demonstrations):
            path, latest = f"/demonstrations/{i + 1:02d}", i + 1 == len(demonstrations)
            points = _spaced(demonstration.path[:, :3, 3], 0.01)
            if len(points) > 1:
                tube = meshes.tube(points, 0.005 if latest else 0.003)
                draw(self.meshcat, f"{path}/path", tube, PATH, 1.0 if latest else 0.6)
            guides = demonstration.transfer(demonstration.X_WO)
            draw_frames(self.meshcat, f"{path}/guiding_poses", guides)
            place = demonstration.X_WO[drawn.object, :3, 3]
            lift = self._objects[drawn.object].height if latest else 0.0
            token = np.eye(4)
            token[:3, 3] = [*place[:2], self._above(float(place[2])) + lift]
            _draw_token(self.meshcat, f"{path}/place", i + 1, token)
        if demonstrations:
            for item, X_WO in zip(self._objects, demonstrations[-1].X_WO, strict=True):
                bowl = meshes.bowl(item.radius, item.height).moved(X_WO)
                draw(self.meshcat, f"/objects/{item.name}", bowl, CLAY)

    def _draw_instances(self, shown: Sample, drawn: Cells) -> None:
        self.meshcat.Delete("/instances")
        flat = self._area.objects[drawn.object].height is not None
        for cause, name in OUTCOME_NAMES.items():
            p_WO = self._area.X_WO(shown.coordinates[shown.cause == cause])[:, drawn.object, :3, 3]
            if len(p_WO) == 0:
                continue
            if flat:
                p_WO[:, 2] = self._height(drawn.object) + 0.002
            cloud = PointCloud(len(p_WO), Fields(BaseField.kXYZs))
            cloud.mutable_xyzs()[:] = p_WO.T
            size = 0.003 if cause == Cause.SUCCESS else 0.006
            path = f"/instances/{name}"
            self.meshcat.SetObject(path, cloud, size, rgba(OUTCOME_COLORS[cause]))

    def _X_WP(self, i: int) -> Array:
        """What object i's x, y are seen from: the world, or what it stands on, but level."""
        X_WP = self._area.X_WP(i)
        level: Array = pose_from_planar([*X_WP[:2, 3], np.arctan2(X_WP[1, 0], X_WP[0, 0])])
        return level

    def _height(self, i: int) -> float:
        """Just above the least height of object i in the world."""
        return self._above(float(self._area.z[i] + self._area.X_WP(i)[2, 3]))

    def _above(self, z: float) -> float:
        """Just above the table, so that what lies flat at height z is not inside of it."""
        return max(z, self._table.top if self._table is not None else z) + 0.002


def _round_path(number: int) -> str:
    return f"/rounds/{number + 1:02d}"


def _draw_token(meshcat: Meshcat, path: str, number: int, X_WT: Array) -> None:
    """A numbered disc; the page turns the numeral upright (``numerals.js``)."""
    draw(meshcat, f"{path}/rim", meshes.disc(0.030, 0.003).moved(X_WT), INK)
    draw(meshcat, f"{path}/token", meshes.disc(0.027, 0.004).moved(X_WT), PAPER)
    X_TN = np.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0.005], [0, 0, 0, 1.0]])
    draw(meshcat, f"{path}/number", meshes.number(number, 0.026), INK)
    meshcat.SetTransform(f"{path}/number", X_WT @ X_TN)


def _spaced(path: Array, spacing: float) -> Array:
    """A path (m, 3) resampled to steps of about `spacing` m, or fewer points if it is shorter."""
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    places = np.linspace(0.0, length[-1], 1 + round(length[-1] / spacing))
    return np.stack([np.interp(places, length, p) for p in path.T], axis=-1)


def _vertex_color(rgb: Array) -> Array:
    """Vertex colours that look like the sRGB colours (..., 3) under Meshcat's own lights.

    On screenshots the lights and the tone curve brighten all but the lightest by about half; the
    correction was chosen by eye.
    """
    linear = linear_from_srgb(rgb)
    return linear * (0.7 + 0.3 * linear)
