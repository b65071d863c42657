"""The panel beside an inspected attempt: what it says, as plain data, and its page."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from html import escape
from importlib.resources import files
from typing import Any

import numpy as np

from drake_screw.planning import Cause, Outcomes
from drake_screw.tasks import Regions, WorkArea
from drake_screw.typing import Array
from drake_screw.visualization.attempt import (
    AHEAD,
    DONE,
    FAILED,
    describe_segment,
    headline,
    unit,
)
from drake_screw.visualization.inspector import AXIS, Drawn
from drake_screw.visualization.palette import OUTCOME_COLORS, OUTCOME_NAMES, STATUS_COLORS
from drake_screw.visualization.rounds import Round, Sample, sample
from drake_screw.visualization.rounds import headline as round_headline
from drake_screw.web.charts import MAP_DOTS, joint_strip, work_area_map

KEY = (
    (STATUS_COLORS[DONE], "screw segment done"),
    (STATUS_COLORS[FAILED], "failed: the segment, the arm's ghost, the joint"),
    (STATUS_COLORS[AHEAD], "never reached"),
    (AXIS, "screw axis; the arrow around it is its turn"),
)


def drawn_state(drawn: Drawn) -> dict[str, Any]:
    """An attempt as the panel's script takes it."""
    attempt, samples = drawn.attempt, drawn.samples
    arm, segment = attempt.arm, attempt.plan.segment[samples]
    failed = attempt.failed_segment
    focus = failed if failed is not None else 0
    start = int(np.argmax(segment >= focus)) if (segment >= focus).any() else len(segment) - 1
    counts = np.bincount(segment, minlength=len(attempt.guides))
    return {
        "path": drawn.path,
        "headline": f"Demonstration {attempt.number + 1} {headline(attempt)}.",
        "color": STATUS_COLORS[DONE if attempt.plan.success else FAILED],
        "segments": [
            {
                "status": status,
                "color": STATUS_COLORS[status],
                "words": describe_segment(attempt, i),
                "first": int(np.argmax(segment >= i)) if counts[i] else -1,
                "share": int(counts[i]),
            }
            for i, status in enumerate(attempt.status)
        ],
        "joints": [
            {
                "name": name,
                "unit": unit(arm, j),
                "lower": float(arm.lower[j]),
                "upper": float(arm.upper[j]),
                "strip": joint_strip(attempt, j, samples),
            }
            for j, name in enumerate(arm.joint_names)
        ],
        "q": np.round(attempt.plan.q[samples], 5).tolist(),
        "at": [
            [int(i), round(float(s), 4)]
            for i, s in zip(segment, attempt.plan.s[samples], strict=True)
        ],
        "start": start,
        "moving": {path: _columns(X) for path, X in drawn.moving.items()},
    }


def attempt_entry(number: int, name: str, outcome: Outcomes, drawn: Drawn | None) -> dict[str, Any]:
    """A line of the panel's list of demonstrations; `outcome` is of shape ()."""
    cause = Cause(int(outcome.cause))
    words = OUTCOME_NAMES[cause]
    if cause not in (Cause.SUCCESS, Cause.NOT_TRIED):
        words += f" in segment {int(outcome.segment) + 1}, {float(outcome.fraction):.0%} along it"
    return {
        "number": number + 1,
        "name": name,
        "color": OUTCOME_COLORS[cause],
        "words": words,
        "drawn": None if drawn is None else drawn_state(drawn),
    }


def round_state(
    event: Round, regions: Regions, here: Array | None, shown: Sample
) -> dict[str, Any]:
    """What the panel says of a round; `here` (k, 3) is marked on its map, `shown` is in 3-D."""
    return {
        "headline": round_headline(event),
        "map": work_area_map(event, regions, here=here),
        "map_words": map_words(event, shown),
    }


def map_words(event: Round, shown: Sample) -> str:
    """What the dots of `work_area_map` are, and how many of the instances 3-D has."""
    words = f"dots: what fails of {sample(event.evaluation, MAP_DOTS).statement}"
    return words if len(shown.cause) == shown.total else f"{words} (in 3-D: {len(shown.cause):,})"


def where(area: WorkArea, x_y_yaw: Array) -> str:
    """Where the objects of an instance (k, 3) are, for people."""
    return ", ".join(
        f"{o.name} at x {x:.3f} m, y {y:.3f} m"
        + (f", yaw {yaw:.2f} rad" if o.lower[2] != o.upper[2] else "")
        for o, (x, y, yaw) in zip(area.objects, x_y_yaw.tolist(), strict=True)
    )


def inspector_body(state: Mapping[str, Any] | None) -> str:
    """The panel as HTML: of a saved page with its state, or of a live one with None."""
    lines = f"const page = {script_json(state)}, KEY = {script_json(KEY)};"
    return body("inspector.html", lines, ("panel.js", "inspector.js"))


def body(html: str, lines: str, scripts: Sequence[str]) -> str:
    """A panel from its parts in the folder ``static``, `lines` before the scripts."""
    script = "\n".join([lines, *(web(name) for name in scripts)])
    return f"<style>{web('panel.css')}</style>\n{web(html)}\n<script>\n{{{script}}}\n</script>\n"


def web(name: str) -> str:
    """A file of the folder ``static``."""
    return (files("drake_screw.web") / "static" / name).read_text(encoding="utf-8")


def with_panel(page: str, panel: str, title: str, head: str = "") -> str:
    """Meshcat's page with a panel, a title of its own, and perhaps more in its head."""
    page = page.replace("<title>Drake MeshCat</title>", f"<title>{escape(title)}</title>", 1)
    page = page.replace("<head>", f"<head>\n{head}", 1)
    before, end, rest = page.rpartition("</body>")
    return before + panel + end + rest


def script_json(value: Any) -> str:
    """Data as a script may contain it: no ``<``, which could end it."""
    return json.dumps(value, separators=(",", ":")).replace("<", "\\u003c")


def _columns(X: Array) -> list[list[float]]:
    """Poses (m, 4, 4) in three.js's order."""
    return np.round(np.swapaxes(X, -1, -2).reshape(len(X), 16), 5).tolist()
