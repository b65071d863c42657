"""A run as it happens, in the browser: regions fill, the suggested place glows."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.acquisition import (
    DemonstrationAdded,
    DemonstrationRequested,
    Event,
    Finished,
    InstancesExecuted,
    RegionsEvaluated,
    RoundFinished,
    RoundStarted,
    Status,
)
from drake_screw.assembly.setup import Setup
from drake_screw.assembly.symmetries import object_symmetries
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import confidence
from drake_screw.planning import Cause
from drake_screw.runs.narration import describe
from drake_screw.runs.pictures import make_scene
from drake_screw.visualization.legend import upright_numerals
from drake_screw.visualization.lifetime import page_meshcat
from drake_screw.visualization.meshcat_page import render
from drake_screw.visualization.outlines import outlines
from drake_screw.visualization.palette import (
    ACCENT,
    INK,
    OUTCOME_COLORS,
    OUTCOME_NAMES,
    PAPER,
    UNKNOWN,
    failure_scale,
)
from drake_screw.visualization.rounds import details
from drake_screw.web.area_map import map_words, work_area_map
from drake_screw.web.server import PanelServer

REDRAW_PERIOD = 0.15
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
        kept: where the run keeps its scene as a page, if it does.

    Attributes:
        url: of the page.

    Raises:
        DrakeScrewError: the page cannot be served there.
    """

    def __init__(
        self,
        setup: Setup,
        *,
        host: str = "localhost",
        port: int | None = None,
        teach: str = "",
        kept: Path | None = None,
    ) -> None:
        self._setup = setup
        self._meshcat = page_meshcat(host)
        self._scene = make_scene(setup, self._meshcat)
        panel = render("drake_screw.web", "live.html.j2", ink=INK, scale=failure_scale(), key=_KEY)
        panel += upright_numerals()
        name = setup.scenario.name
        self._server = PanelServer(self._meshcat.port(), panel, name, host=host, port=port)
        self.url = self._server.url
        self._redrawn = 0.0
        self._teach, self._kept = teach, kept
        self._demonstrations: tuple[Demonstration, ...] = ()
        goal = setup.goal
        self._state: dict[str, Any] = {
            "title": name,
            "headline": "starting",
            "details": "",
            "color": INK,
            "teach": "",
            "goal": f"every region succeeds at least {confidence(goal.beta)} of the time, measured "
            f"to {goal.epsilon:g} with confidence {confidence(1.0 - goal.delta)}",
            "map": "",
            "map_words": "",
            "finished": "",
            "rounds": [],
            "demonstrations": [],
        }
        self._server.show(self._state)

    def __call__(self, event: Event) -> None:
        """Show an event."""
        match event:
            case RoundStarted():
                self._start_round(event)
            case RegionsEvaluated():
                self._fill_regions(event)
            case InstancesExecuted():
                self._update(details=describe(event, self._setup.regions))
            case RoundFinished():
                self._finish_round(event)
            case DemonstrationRequested():
                self._scene.show_suggestion(event.suggestion.coordinates)
                words = describe(event, self._setup.regions)
                self._update(headline=words, color=INK, teach=self._teach)
            case DemonstrationAdded():
                words = f"{event.recording.name}: {event.remark}"
                line = {"number": event.number + 1, "color": INK, "words": words}
                self._update(demonstrations=[*self._state["demonstrations"], line], teach="")
            case Finished():
                certified = event.status is Status.CERTIFIED
                cause = Cause.SUCCESS if certified else Cause.JOINT_LIMIT
                claim = "" if event.verdict is None else f"{event.verdict.claim}; "
                self._update(
                    headline=event.status.value,
                    details=f"{claim}{event.reason}",
                    color=OUTCOME_COLORS[cause],
                    teach="",
                    finished=self._farewell(),
                )

    def close(self) -> None:
        """Stop serving the page."""
        self._server.close()

    def _farewell(self) -> str:
        """What is to be said when the run has finished."""
        kept = "" if self._kept is None else f" What is shown here is kept in {self._kept}"
        return f"The run has finished; this page does not change any more.{kept}"

    def _start_round(self, event: RoundStarted) -> None:
        self._demonstrations = event.demonstrations
        listed = self._state["demonstrations"]
        given = [
            {"number": i + 1, "color": INK, "words": d.name}
            for i, d in enumerate(event.demonstrations)
        ]
        self._update(
            headline=describe(event, self._setup.regions),
            details="",
            color=INK,
            teach="",
            demonstrations=[*listed, *given[len(listed) :]],
        )

    def _fill_regions(self, event: RegionsEvaluated) -> None:
        """Fill the regions with the failure rates of a round so far."""
        if time.monotonic() - self._redrawn < REDRAW_PERIOD:
            return
        self._redrawn = time.monotonic()
        regions = self._setup.regions
        with np.errstate(invalid="ignore"):
            rates = event.failures / event.samples
        if len(rates) == regions.K:
            self._scene.show_rates(rates, regions, self._demonstrations)
        worst = int(np.nan_to_num(rates, nan=-1.0).argmax())
        where = f" in region {worst}" if len(rates) > 1 else ""
        self._update(
            details=f"{event.samples.sum():,} instances so far; highest failure rate "
            f"{np.nan_to_num(rates[worst]):.2%}{where}"
        )

    def _finish_round(self, event: RoundFinished) -> None:
        shown = self._scene.show_round(event, event.regions)
        verdict, number = event.verdict, event.round + 1
        region = event.verdict.weakest
        worst = "none fails"
        if region is not None:
            worst = f"weakest: region {region}, {verdict.estimates[region]:.2%} fail "
            worst += f"(at most {verdict.upper[region]:.2%})"
        color = OUTCOME_COLORS[Cause.SUCCESS if verdict.certified else Cause.JOINT_LIMIT]
        line = {
            "number": number,
            "color": color,
            "words": f"{worst}; {len(event.evaluation.region):,} instances",
        }
        self._update(
            headline=f"round {number}: {'certified' if verdict.certified else 'not certified'}",
            details=details(event, event.regions),
            color=color,
            map=work_area_map(
                event,
                event.regions,
                things=outlines(self._setup.obstacles),
                symmetries=object_symmetries(self._setup.scenario),
            ),
            map_words=f"after round {number}; {map_words(event, shown, event.regions)}",
            rounds=[*self._state["rounds"], line],
        )

    def _update(self, **changes: Any) -> None:
        self._meshcat.Flush()
        self._state |= changes
        self._server.show(self._state)
