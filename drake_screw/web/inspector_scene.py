"""A run in Meshcat, with one of its instances and the attempts there."""

from __future__ import annotations

from typing import Any

from pydrake.geometry import Meshcat

from drake_screw.assembly.symmetries import object_symmetries
from drake_screw.runs.pictures import make_scene
from drake_screw.runs.reader import RunReader
from drake_screw.visualization.inspector import Drawn, Inspector
from drake_screw.web.inspector_panel import panel_state
from drake_screw.web.selection import Selection


class InspectorScene:
    """Draws what is selected of a run.

    Args:
        reader: the run.
        meshcat: drawn into.
    """

    def __init__(self, reader: RunReader, meshcat: Meshcat) -> None:
        setup = reader.setup
        self.meshcat = meshcat
        self._reader = reader
        self._scene = make_scene(setup, meshcat)
        self._inspector = Inspector(
            meshcat, setup.workcells, setup.objects, object_symmetries(setup.scenario)
        )
        self._round: int | None = None

    def show(self, selection: Selection, *, live: bool) -> dict[str, Any]:
        """Draw a selection; returns the panel's state.

        A live page gets the attempts that are looked at, as planning takes its time; a saved page
        all.
        """
        if self._round != selection.round:
            self._show_round(selection)
        drawn = self._draw_attempts(selection, selected_only=live)
        self.meshcat.Flush()
        return panel_state(self._reader, selection, drawn, live=live)

    def _show_round(self, selection: Selection) -> None:
        setup, event = self._reader.setup, self._reader.event(selection.round)
        self._scene.show_round(event, event.regions)
        self.meshcat.SetProperty("/demonstrations", "visible", False)
        self.meshcat.SetProperty("/objects", "visible", False)
        for item in setup.objects:
            self.meshcat.Delete(f"/rounds/{selection.round + 1:02d}/next/{item.name}/object")
        if self._round is None and selection.instance is not None:
            here = event.evaluation.coordinates[selection.instance]
            self._inspector.aim(setup.area.X_WO(here))
        self._round = selection.round

    def _draw_attempts(self, selection: Selection, *, selected_only: bool) -> dict[int, Drawn]:
        """The instance's attempts by their demonstration."""
        self._inspector.clear()
        if selection.instance is None:
            return {}
        event = self._reader.event(selection.round)
        here = event.evaluation.coordinates[selection.instance]
        self._inspector.show_instance(self._reader.setup.area.X_WO(here))
        count = len(event.demonstrations)
        numbers = [d for d in range(count) if d in selection.drawn or not selected_only]
        return {
            number: self._inspector.draw(
                self._reader.attempt(selection.round, selection.instance, number),
                copy=len(numbers) > 1,
            )
            for number in numbers
        }
