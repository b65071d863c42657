"""Executions one after the other as one page that plays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from pydrake.geometry import Meshcat, MeshcatAnimation, MeshcatParams, Rgba, Shape
from pydrake.math import RigidTransform

from drake_screw.execution.simulate import Execution
from drake_screw.execution.station import Station, build_station
from drake_screw.robot import ObjectConfig, ObstacleConfig, RobotConfig, TableConfig
from drake_screw.screws import normalized
from drake_screw.typing import Array

FRAMES = 20  # a second
PAUSE = 0.6  # s, between executions
SKY = ([0.93, 0.94, 0.96], [0.70, 0.72, 0.76])
GOOD, BAD = "#1f78b5", "#d6262a"
"""Of the line along an execution that is flawless, and of any other."""

Shown = tuple[Execution, ArrayLike, RobotConfig]
"""An execution, the poses X_WO (k, 4, 4) of the objects, and the robot with the arm that moved."""


def recording_html(
    executions: Sequence[Shown],
    *,
    table: TableConfig | None = None,
    objects: Sequence[ObjectConfig] = (),
    obstacles: Sequence[ObstacleConfig] = (),
    free_objects: bool = False,
    looks: Sequence[Shape] | None = None,
) -> str:
    """A self-contained Meshcat page that plays executions, over and over.

    The line is the end effector's path: blue where the execution was flawless, red otherwise.

    Args:
        executions: all of one robot's model; `spans` says when each is played.
        table, objects, obstacles, free_objects: as the executions had them.
        looks: of the objects, each in its own frame; cylinders if None.
    """
    meshcat = Meshcat(MeshcatParams(host="localhost"))
    stations: dict[tuple[str, ...], Station] = {}
    for _, _, robot in executions:
        if robot.joints not in stations:
            stations[robot.joints] = build_station(
                robot,
                table=table,
                objects=objects,
                obstacles=obstacles,
                free_objects=free_objects,
                meshcat=meshcat,
                looks=looks,
            )
    for path in ("/Grid", "/Axes"):
        meshcat.SetProperty(path, "visible", False)
    meshcat.SetProperty("/Background", "top_color", SKY[0])
    meshcat.SetProperty("/Background", "bottom_color", SKY[1])
    _aim(meshcat, [np.asarray(X_WO, dtype=float) for _, X_WO, _ in executions])
    meshcat.StartRecording(frames_per_second=FRAMES, set_visualizations_while_recording=False)
    animation = meshcat.get_mutable_recording()
    times = spans([execution for execution, _, _ in executions])
    for number, (execution, X_WO, robot) in enumerate(executions):
        began, ended = times[number]
        station = stations[robot.joints]
        path = f"/paths/{number + 1:02d}"
        _trace(
            meshcat,
            path,
            station.arm.pose(execution.q[:: max(1, len(execution.q) // 300)])[:, :3, 3].T,
            execution,
        )
        root = station.context(execution.q[0], X_WO)
        context = station.plant.GetMyMutableContextFromRoot(root)
        positions = station.plant.GetPositions(context)
        for t in np.arange(0.0, execution.t[-1], 1.0 / FRAMES):
            k = min(int(np.searchsorted(execution.t, t)), len(execution.t) - 1)
            positions[station.columns] = execution.q[k]
            station.plant.SetPositions(context, positions)
            if execution.X_WO is not None:
                for body, X in zip(station.objects, execution.X_WO[k], strict=True):
                    station.plant.SetFreeBodyPose(context, body, RigidTransform(normalized(X)))
            root.SetTime(began + t)
            station.diagram.ForcedPublish(root)
        first, last = round(FRAMES * began), round(FRAMES * (ended + PAUSE)) - 1
        for frame, visible in ((0, number == 0), (first, True), (last, False)):
            animation.SetProperty(frame, path, "visible", visible)
    meshcat.StopRecording()
    animation.set_loop_mode(MeshcatAnimation.LoopMode.kLoopRepeat)
    meshcat.PublishRecording()
    return str(meshcat.StaticHtml())


def spans(executions: Sequence[Execution]) -> list[tuple[float, float]]:
    """When each of some executions begins and ends on the page; s."""
    lengths = np.array([float(execution.t[-1]) for execution in executions])
    began = np.concatenate([[0.0], np.cumsum(lengths + PAUSE)[:-1]])
    return list(zip(began.tolist(), (began + lengths).tolist(), strict=True))


def _trace(meshcat: Meshcat, path: str, points: Array, execution: Execution) -> None:
    color = GOOD if execution.report.flawless else BAD
    red, green, blue = (int(color[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    meshcat.SetLine(path, points, 4.0, Rgba(red, green, blue))


def _aim(meshcat: Meshcat, X_WO: Sequence[Array]) -> None:
    places = np.concatenate([X[:, :3, 3] for X in X_WO]) if X_WO else np.zeros((1, 3))
    target = 0.6 * places.mean(axis=0) + np.array([0.0, 0.0, 0.15])
    meshcat.SetCameraPose(target + np.array([1.3, -0.3, 0.7]), target)
