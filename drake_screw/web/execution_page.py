"""An execution in the browser, while which the objects may be moved."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from pydrake.geometry import Meshcat
from pydrake.systems.analysis import Simulator

from drake_screw.assembly.placing import InstanceLike, placed
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Demonstration
from drake_screw.execution import ExecutionStatus, Mode, Phase, TimeLimits
from drake_screw.runs.executions import planning_station
from drake_screw.runs.run import open_run
from drake_screw.tasks import ANGLES
from drake_screw.typing import Array, PathLike
from drake_screw.visualization.lifetime import page_meshcat
from drake_screw.visualization.meshcat_page import render
from drake_screw.visualization.palette import ACCENT
from drake_screw.web.server import PanelServer, check_address, warning

SLOWLY = TimeLimits(speed=0.1, acceleration=0.3)
"""Slowly enough that there is time to move something."""
PERIOD = 0.05
"""s, of the simulation, between looks at the sliders."""
PUSH = (0.25, 1.0)
"""m/s and rad/s at which objects go where the sliders are: pushed, not thrown."""
SKY = ([0.93, 0.94, 0.96], [0.70, 0.72, 0.76])
WORDS = {
    Mode.WAITING: "waits for the objects to come to rest in a new place",
    Mode.FOLLOWING: "approaches; an object that is moved now is followed",
    Mode.COMMITTED: "is at work; an object that is moved now ends the execution",
    Mode.STOPPING: "comes to rest",
    Mode.ENDED: "has stopped; start again",
}


class LiveExecution:
    """A simulated station that plans for itself, and objects that go where sliders are.

    Args:
        setup: of the scenario.
        demonstrations: to plan with.
        coordinates: (k, c) where the objects are at first.
        meshcat: to draw in.

    Attributes:
        coordinates: (k, c) where the objects are.
        wanted: (k, 3) where the sliders are.
        running: whether it has been started.
        done: how many executions have ended well.
    """

    def __init__(
        self,
        setup: Setup,
        demonstrations: tuple[Demonstration, ...],
        coordinates: Array,
        meshcat: Meshcat | None = None,
    ) -> None:
        self._setup = setup
        self._station = planning_station(setup, demonstrations, limits=SLOWLY, meshcat=meshcat)
        self.coordinates, self.wanted = coordinates.copy(), coordinates.copy()
        self.sliders = [
            (i, j)
            for i, (low, high) in enumerate(zip(setup.area.lower, setup.area.upper, strict=True))
            for j in np.flatnonzero(low < high).tolist()
        ]
        self.done, self.running = 0, False
        self._reset()
        self._station.diagram.ForcedPublish(self._root)

    def _reset(self) -> None:
        """The arm at its start again, the objects where they are."""
        X_WO = self._setup.area.X_WO(self.coordinates)
        self._root = self._station.context(self._setup.workcell.start, X_WO)
        self._simulator = Simulator(self._station.diagram, self._root)
        self._simulator.set_target_realtime_rate(1.0)
        self._simulator.Initialize()
        self._status = ExecutionStatus()

    def handle(self, message: dict[str, Any]) -> None:
        """A message of the page; one that means nothing changes nothing.

        Messages: ``{"do": "start"}``, ``{"slider": i, "value": v}`` in m or rad.
        """
        match message:
            case {"do": "start"}:
                self._reset()
                self.running = True
            case {"slider": int(n), "value": int() | float() as value}:
                if 0 <= n < len(self.sliders) and np.isfinite(value):
                    i, j = self.sliders[n]
                    area = self._setup.area
                    self.wanted[i, j] = np.clip(value, area.lower[i, j], area.upper[i, j])

    def step(self) -> None:
        """A period of the simulation, with the objects on their way to the sliders."""
        area = self._setup.area
        most = PERIOD * np.array([PUSH[axis in ANGLES] for axis in area.axes])
        step = np.clip(self.wanted - self.coordinates, -most, most)
        if step.any():
            self.coordinates = self.coordinates + step
            self._station.place(self._root, area.X_WO(self.coordinates))
        if not self.running:
            self._station.diagram.ForcedPublish(self._root)
            return
        self._simulator.ResetStatistics()  # time that was lost is not made up for in a rush
        self._simulator.AdvanceTo(self._root.get_time() + PERIOD)
        for log in (self._station.measured, self._station.desired):
            log.FindMutableLog(self._root).Clear()
        before, self._status = self._status, self._get("status")
        if self._status.phase is Phase.DONE and before.phase is not Phase.DONE:
            self.done += 1

    def state(self) -> dict[str, Any]:
        """What the panel shows."""
        mode, outcome = self._get("mode"), self._get("outcome")
        names = [item.name for item in self._setup.area.objects]
        area = self._setup.area
        return {
            "title": f"{self._setup.scenario.name}: execution",
            "headline": str(self._status),
            "mode": f"The arm {WORDS[mode]}." if self.running else "Start when you are ready.",
            "outcome": str(outcome),
            "done": f"{self.done} done",
            "start": "start again" if self.running else "start",
            "sliders": [
                {
                    "name": f"{names[i]} {area.axes[j]}",
                    "low": float(area.lower[i, j]),
                    "high": float(area.upper[i, j]),
                    "value": float(self.wanted[i, j]),
                    "unit": "rad" if area.axes[j] in ANGLES else "m",
                }
                for i, j in self.sliders
            ],
        }

    def _get(self, port: str) -> Any:
        return self._station.diagram.GetOutputPort(port).Eval(self._root)


def execute_live(
    run: PathLike,
    *,
    instance: InstanceLike | None = None,
    host: str = "localhost",
    port: int | None = None,
    announce: Callable[[str], None] = print,
) -> int:
    """Simulate executions of a run on a page with a slider for each way an object can be moved.

    Args:
        run: its directory.
        instance: where the objects are at first, as `placed` takes it; in the middle of the work
            area if None.
        host: "localhost", or an address to listen on, so that others can look, too.
        port: of the page; any free one if None.
        announce: called with the warning of an open address, the page's address, and at the end.

    Returns:
        How many executions ended well, until it was interrupted.

    Raises:
        DrakeScrewError: the run cannot be read or has no demonstrations, the instance is not one,
            the model lacks inertia, or the page cannot be served there.
    """
    check_address(host, port)
    opened = open_run(run)
    area, demonstrations = opened.setup.area, opened.demonstrations
    coordinates = area.middle if instance is None else placed(area, instance)
    meshcat = page_meshcat(host)
    live = LiveExecution(opened.setup, demonstrations, np.asarray(coordinates), meshcat)
    _look(meshcat, area.X_WO(coordinates))
    panel = render("drake_screw.web", "execution.html.j2", accent=ACCENT)
    title = f"{opened.setup.scenario.name}: execution"
    server = PanelServer(meshcat.port(), panel, title, host=host, port=port)
    risk = warning(host)
    if risk is not None:
        announce(risk)
    announce(f"open {server.url} in a browser; Ctrl-C ends it")
    shown: dict[str, Any] = {}
    try:
        while True:
            wait = 0.0 if live.running else PERIOD
            while (message := server.message(wait)) is not None:
                live.handle(message)
            live.step()
            if (state := live.state()) != shown:
                server.show(state)
                shown = state
    except KeyboardInterrupt:
        announce(f"ended; {live.state()['done']}")
    finally:
        server.close()
    return live.done


def _look(meshcat: Meshcat, X_WO: Array) -> None:
    for path in ("/Grid", "/Axes"):
        meshcat.SetProperty(path, "visible", False)
    meshcat.SetProperty("/Background", "top_color", SKY[0])
    meshcat.SetProperty("/Background", "bottom_color", SKY[1])
    target = 0.6 * X_WO[:, :3, 3].mean(axis=0) + np.array([0.0, 0.0, 0.15])
    meshcat.SetCameraPose(target + np.array([1.4, -0.4, 0.8]), target)
