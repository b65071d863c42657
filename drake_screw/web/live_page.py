"""A run as it happens, in the browser: regions fill, the suggested place glows."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from matplotlib.colors import to_hex

from drake_screw.acquisition import (
    DemonstrationAdded,
    DemonstrationRequested,
    Event,
    Finished,
    RegionsEvaluated,
    RoundFinished,
    RoundStarted,
    Status,
)
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Cause
from drake_screw.runs.narration import describe
from drake_screw.visualization import Scene
from drake_screw.visualization.lifetime import page_meshcat
from drake_screw.visualization.palette import (
    ACCENT,
    INK,
    OUTCOME_COLORS,
    OUTCOME_NAMES,
    PAPER,
    UNKNOWN,
    failure_color,
)
from drake_screw.web.charts import work_area_map
from drake_screw.web.panel import body, map_words, script_json
from drake_screw.web.panel_server import PanelServer

EVERY = 0.15
"""s. Regions are not drawn more often than this while a round goes on."""

_KEY = (
    *((OUTCOME_COLORS[cause], f"instance: {name}") for cause, name in OUTCOME_NAMES.items()),
    (PAPER, "demonstration"),
    (ACCENT, "next demonstration wanted"),
    (UNKNOWN, "not sampled yet"),
)


class LivePage:
    """A listener that shows a run's events in Meshcat, with a panel that says them.

    To be used from one thread, as Meshcat is.

    Args:
        setup: of the run.
        host: "localhost", or an address to listen on, so that others can look, too.
        port: of the page; any free one if None.
        teach: address of the page where a person gives demonstrations, if there is one.

    Attributes:
        url: of the page.
    """

    def __init__(
        self,
        setup: Setup,
        *,
        host: str = "localhost",
        port: int | None = None,
        teach: str = "",
    ) -> None:
        self._setup = setup
        self.meshcat = page_meshcat(host)
        name = setup.scenario.name
        self.scene = Scene(
            self.meshcat, setup.robot, setup.table, setup.objects, setup.area, scenario=name
        )
        scale = [to_hex(color) for color in failure_color(np.linspace(0.0, 1.0, 9))]
        lines = f"const KEY = {script_json(_KEY)}, SCALE = {script_json(scale)};"
        panel = body("live.html", lines, ("panel.js", "live.js"))
        self.server = PanelServer(self.meshcat.port(), panel, name, host=host, port=port)
        self.url = self.server.url
        self._drawn = 0.0
        self._teach = teach
        self._hand: tuple[Demonstration, ...] = ()
        goal = setup.goal
        self._state: dict[str, Any] = {
            "title": name,
            "headline": "starting",
            "details": "",
            "color": INK,
            "teach": "",
            "goal": f"every region succeeds at least {goal.beta:.0%} of the time, measured to "
            f"{goal.epsilon:g} with confidence {1 - goal.delta:.0%}",
            "map": "",
            "map_words": "",
            "rounds": [],
            "demonstrations": [],
        }
        self.server.show(self._state)

    def _fill(self, event: RegionsEvaluated) -> None:
        """Fill the regions with the failure rates of a round so far."""
        if time.monotonic() - self._drawn < EVERY:
            return
        self._drawn = time.monotonic()
        regions = self._setup.regions
        with np.errstate(invalid="ignore"):
            rates = event.failures / event.samples
        if len(rates) == regions.K:
            self.scene.show_rates(rates, regions, self._hand)
        worst = int(np.nan_to_num(rates, nan=-1.0).argmax())
        where = f" in region {worst}" if len(rates) > 1 else ""
        self._say(
            details=f"{event.samples.sum():,} instances so far; highest failure rate "
            f"{np.nan_to_num(rates[worst]):.2%}{where}"
        )

    def __call__(self, event: Event) -> None:
        """Show an event."""
        words = describe(event, self._setup.regions)
        match event:
            case RoundStarted():
                self._hand = event.demonstrations
                known = self._state["demonstrations"]
                given = [
                    {"number": i + 1, "color": INK, "words": d.name}
                    for i, d in enumerate(self._hand)
                ]
                self._say(
                    headline=words,
                    details="",
                    color=INK,
                    teach="",
                    demonstrations=[*known, *given[len(known) :]],
                )
            case RegionsEvaluated():
                self._fill(event)
            case RoundFinished():
                shown = self.scene.show_round(event, event.regions)
                verdict = event.verdict
                good = OUTCOME_COLORS[Cause.SUCCESS]
                color = good if verdict.certified else OUTCOME_COLORS[Cause.JOINT_LIMIT]
                line = {
                    "number": event.round + 1,
                    "color": color,
                    "words": f"weakest: region {verdict.region}, "
                    f"{verdict.estimates[verdict.region]:.2%} fail "
                    f"(at most {verdict.upper[verdict.region]:.2%}); "
                    f"{len(event.evaluation.region):,} instances",
                }
                self._say(
                    headline=f"round {event.round + 1}: "
                    + ("certified" if verdict.certified else "not certified"),
                    details=f"weakest region {verdict.region}: "
                    f"{event.regions.name(verdict.region)}; {verdict.reason}",
                    color=color,
                    map=work_area_map(event, event.regions),
                    map_words=f"after round {event.round + 1}; {map_words(event, shown)}",
                    rounds=[*self._state["rounds"], line],
                )
            case DemonstrationRequested():
                self.scene.show_suggestion(event.suggestion.x_y_yaw)
                self._say(headline=words, color=INK, teach=self._teach)
            case DemonstrationAdded():
                line = {
                    "number": event.number + 1,
                    "color": INK,
                    "words": f"{event.recording.name}: {event.remark}",
                }
                self._say(demonstrations=[*self._state["demonstrations"], line], teach="")
            case Finished():
                certified = event.status is Status.CERTIFIED
                cause = Cause.SUCCESS if certified else Cause.JOINT_LIMIT
                claim = "" if event.verdict is None else f"{event.verdict.claim}; "
                self._say(
                    headline=event.status.value,
                    details=f"{claim}{event.reason}",
                    color=OUTCOME_COLORS[cause],
                    teach="",
                )

    def close(self) -> None:
        """Stop serving the page."""
        self.server.close()

    def _say(self, **changes: Any) -> None:
        self.meshcat.Flush()
        self._state |= changes
        self.server.show(self._state)
