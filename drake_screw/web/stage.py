"""A run in Meshcat with one instance looked at, and what the panel beside it says."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.geometry import Meshcat

from drake_screw.runs.reader import RunReader
from drake_screw.visualization import Scene
from drake_screw.visualization.inspector import Inspector
from drake_screw.visualization.rounds import sample
from drake_screw.visualization.scene import MOST_DOTS
from drake_screw.web.choice import Choice, steps, which
from drake_screw.web.panel import attempt_entry, round_state, where


class Stage:
    """A Meshcat with the scene of a run and an inspector in it."""

    def __init__(self, reader: RunReader, meshcat: Meshcat) -> None:
        setup = reader.setup
        self.reader = reader
        self.meshcat = meshcat
        self.scene = Scene(
            self.meshcat,
            setup.robot,
            setup.table,
            setup.objects,
            setup.area,
            scenario=setup.scenario.name,
        )
        self.inspector = Inspector(self.meshcat, setup.workcell, setup.objects)
        self._shown: int | None = None

    def show(self, choice: Choice, *, live: bool) -> dict[str, Any]:
        """Draw a choice; returns the panel's state."""
        setup = self.reader.setup
        if self._shown != choice.round:
            event = self.reader.event(choice.round)
            self.scene.show_round(event, event.regions)
            self.meshcat.SetProperty("/demonstrations", "visible", False)
            self.meshcat.SetProperty("/objects", "visible", False)
            for item in setup.objects:
                self.meshcat.Delete(f"/rounds/{choice.round + 1:02d}/next/{item.name}/object")
            if self._shown is None and choice.instance is not None:
                here = event.evaluation.x_y_yaw[choice.instance]
                self.inspector.aim(setup.area.X_WO(here))
            self._shown = choice.round
        drawn = state(self.reader, choice, self.inspector, live=live)
        self.meshcat.Flush()
        return drawn


def state(reader: RunReader, choice: Choice, inspector: Inspector, *, live: bool) -> dict[str, Any]:
    """Draw what is chosen, and say it: the panel's state.

    A live panel gets the chosen attempt only, as planning takes its time; a saved page all.
    """
    event = reader.event(choice.round)
    regions = event.regions
    book = reader.catalogue(choice.round)
    rates = event.verdict.estimates
    inspector.clear()
    here, attempts = None, []
    instance: dict[str, Any] = {"key": None, "where": "no instance", "which": ""}
    if choice.instance is not None:
        here = event.evaluation.x_y_yaw[choice.instance]
        inspector.show_instance(reader.setup.area.X_WO(here))
        for d, demonstration in enumerate(event.demonstrations):
            drawn, outcome = None, reader.outcomes(choice.round, choice.instance)[d]
            if d == choice.demonstration or not live:
                tried = reader.attempt(choice.round, choice.instance, d)
                drawn, outcome = inspector.draw(tried), tried.plan.outcome
            attempts.append(attempt_entry(d, demonstration.name, outcome, drawn))
        instance = {
            "key": [choice.round, choice.instance],
            "where": where(reader.setup.area, here),
            "which": which(reader, choice),
        }
    return {
        "live": live,
        "title": reader.setup.scenario.name,
        "round": choice.round,
        "rounds": [{"value": r, "text": f"round {r + 1}"} for r in range(reader.rounds)],
        "region": choice.region,
        "regions": [
            {"value": None, "text": "all regions"},
            *(
                {"value": j, "text": f"region {j}: {regions.name(j)}, {rates[j]:.1%} fail"}
                for j in np.unique(book.region).tolist()
            ),
        ],
        "instance": instance,
        "steps": list(steps(reader, choice)),
        "attempts": attempts,
        "chosen": choice.demonstration,
        **round_state(event, regions, here, sample(event.evaluation, MOST_DOTS)),
    }
