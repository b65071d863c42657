"""What the panel beside an inspected attempt says, as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from markupsafe import Markup

from drake_screw.acquisition import RoundFinished
from drake_screw.assembly.symmetries import object_symmetries
from drake_screw.planning import Cause, Outcomes
from drake_screw.planning.touching import known_pair
from drake_screw.robot import Workcell
from drake_screw.runs.reader import RunReader
from drake_screw.runs.summary import round_in_run
from drake_screw.tasks import WorkArea
from drake_screw.typing import Array
from drake_screw.visualization.attempt import (
    AHEAD,
    DONE,
    FAILED,
    describe_segment,
    headline,
)
from drake_screw.visualization.inspector import COPY, Drawn
from drake_screw.visualization.outlines import outlines
from drake_screw.visualization.palette import ACCENT, OUTCOME_COLORS, OUTCOME_NAMES, STATUS_COLORS
from drake_screw.visualization.rounds import mean_failure, sample
from drake_screw.visualization.scene import MOST_DOTS
from drake_screw.visualization.screw_drawing import AXIS
from drake_screw.web.area_map import map_words, work_area_map
from drake_screw.web.charts import joint_curves, reach_curves, strip
from drake_screw.web.selection import Selection, steps

PLAN_KEY = (
    (STATUS_COLORS[DONE], "screw segment done"),
    (STATUS_COLORS[FAILED], "failed: the segment, the arm's ghost, the joint or what touches"),
    (STATUS_COLORS[AHEAD], "never reached"),
    (AXIS, "screw axis; the arrow around it is its turn"),
    (ACCENT, "where the guiding pose asks for the wrist"),
)
"""What the colours of a drawn attempt mean."""

KEY = (*PLAN_KEY, (COPY, "the arm with the demonstration beside"))
"""And those of another beside it."""


def panel_state(
    reader: RunReader, selection: Selection, drawn: Mapping[int, Drawn], *, live: bool
) -> dict[str, Any]:
    """All that the panel shows.

    Args:
        reader: the run.
        selection: what is looked at.
        drawn: attempts at the selected instance that are drawn, by their demonstration.
        live: whether a program answers the panel's messages.
    """
    event = reader.event(selection.round)
    regions, rates = event.regions, event.verdict.estimates
    here, attempts = None, []
    instance: dict[str, Any] = {"key": None, "where": "no instance", "which": ""}
    if selection.instance is not None:
        here = event.evaluation.coordinates[selection.instance]
        found = reader.outcomes(selection.round, selection.instance)
        attempts = [
            attempt_entry(
                number,
                demonstration.name,
                found[number],
                drawn.get(number),
                reader.setup.workcell,
                reader.setup.arm_name(found[number]),
            )
            for number, demonstration in enumerate(event.demonstrations)
        ]
        instance = {
            "key": [selection.round, selection.instance],
            "where": where(reader.setup.area, here),
            "which": describe_instance(reader, selection),
        }
    return {
        "live": live,
        "title": reader.setup.scenario.name,
        "round": selection.round,
        "rounds": [{"value": r, "text": f"round {r + 1}"} for r in range(reader.rounds)],
        "region": selection.region,
        "regions": [
            {"value": None, "text": "all regions"},
            *(
                {"value": j, "text": f"region {j}: {regions.name(j)}, {rates[j]:.1%} fail"}
                for j in np.unique(reader.catalogue(selection.round).region).tolist()
            ),
        ],
        "instance": instance,
        "steps": list(steps(reader, selection)),
        "attempts": attempts,
        "selected": selection.demonstration,
        "against": selection.against,
        "before": _round_before(reader, selection),
        "headline": round_in_run(event, reader.directory.record),
        "map": _map(reader, event, here),
        "map_words": map_words(event, sample(event.evaluation, MOST_DOTS), regions),
    }


def _round_before(reader: RunReader, selection: Selection) -> dict[str, Any] | None:
    """The round before the selected one: its map, and what has changed since; None of the first."""
    if selection.round == 0:
        return None
    event, before = reader.event(selection.round), reader.event(selection.round - 1)
    here, tried = None, ""
    if selection.instance is not None:
        here = event.evaluation.coordinates[selection.instance]
        tried = tried_before(reader.outcomes(selection.round, selection.instance), before)
    return {
        "title": f"round {before.round + 1}",
        "map": _map(reader, before, here),
        "words": f"{changed(before, event)}{tried}",
    }


def _map(reader: RunReader, event: RoundFinished, here: Array | None) -> Markup:
    return work_area_map(
        event,
        event.regions,
        here=here,
        things=outlines(reader.setup.obstacles),
        symmetries=object_symmetries(reader.setup.scenario),
    )


def changed(before: RoundFinished, event: RoundFinished) -> str:
    """What part of the work area, and of the worst region, failed in a round and in the next."""
    parts = [
        (mean_failure(each.verdict, each.regions), float(np.nanmax(each.verdict.estimates)))
        for each in (before, event)
    ]
    (all0, worst0), (all1, worst1) = parts
    return (
        f"round {before.round + 1} → {event.round + 1}: of the work area {all0:.1%} → {all1:.1%} "
        f"fail, of the worst region {worst0:.1%} → {worst1:.1%}"
    )


def tried_before(found: Outcomes, before: RoundFinished) -> str:
    """What the demonstrations of an earlier round do at an instance with outcomes (D,)."""
    earlier = found[: len(before.demonstrations)]
    if earlier.success.any():
        return "; this instance succeeds with the demonstrations it had"
    if (earlier.cause == Cause.NOT_TRIED).any():
        return ""
    return "; this instance fails with the demonstrations it had"


def attempt_entry(
    number: int,
    name: str,
    found: Outcomes,
    drawn: Drawn | None,
    workcell: Workcell,
    arm_name: str | None = None,
) -> dict[str, Any]:
    """A line of the panel's list of demonstrations.

    Args:
        number: of the demonstration, from 0.
        name: of the demonstration.
        found: of shape (), what the run found.
        drawn: the attempt, if it is drawn; its own outcome is shown then.
        workcell: knows bodies that touch by their names.
        arm_name: of the arm that it found this with, where there are several.
    """
    outcome = found if drawn is None else drawn.attempt.plan.outcome
    cause = Cause(int(outcome.cause))
    words = OUTCOME_NAMES[cause]
    if cause not in (Cause.SUCCESS, Cause.NOT_TRIED):
        words += f" in segment {int(outcome.segment) + 1}, {float(outcome.fraction):.0%} along it"
    arm_name = arm_name if drawn is None else drawn.attempt.arm_name
    if arm_name is not None and cause != Cause.NOT_TRIED:
        words += f", arm {arm_name}"
    pair = known_pair(outcome, workcell)
    bodies = (() if pair is None else (pair,)) if drawn is None else drawn.attempt.bodies[:1]
    words += "".join(f": {a}, {b}" for a, b in bodies)
    return {
        "number": number + 1,
        "name": name,
        "color": OUTCOME_COLORS[cause],
        "words": words,
        "drawn": None if drawn is None else drawn_state(drawn),
    }


def drawn_state(drawn: Drawn) -> dict[str, Any]:
    """A drawn attempt as the panel's script takes it."""
    attempt, samples = drawn.attempt, drawn.samples
    arm, segment = attempt.arm, attempt.plan.segment[samples]
    failed = attempt.failed_segment
    focus = failed if failed is not None else 0
    start = int(np.argmax(segment >= focus)) if (segment >= focus).any() else len(segment) - 1
    counts = np.bincount(segment, minlength=len(attempt.guides))
    return {
        "path": drawn.path,
        "copied": drawn.copied,
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
                "unit": arm.units[j],
                "lower": None if arm.endless[j] else float(arm.lower[j]),
                "upper": None if arm.endless[j] else float(arm.upper[j]),
                "strip": strip(attempt, curve, samples),
            }
            for j, (name, curve) in enumerate(
                zip(arm.joint_names, joint_curves(attempt), strict=True)
            )
        ],
        "reach": [
            {
                "name": curve.name,
                "unit": curve.unit,
                "strip": strip(attempt, curve, samples),
                "failed": curve.failed,
                "bound": curve.bound,
                "values": [
                    None if np.isnan(v) else float(f"{v:.4g}") for v in curve.values[samples]
                ],
            }
            for curve in reach_curves(attempt)
        ],
        "q": np.round(attempt.plan.q[samples], 5).tolist(),
        "at": [
            [int(i), round(float(s), 4)]
            for i, s in zip(segment, attempt.plan.s[samples], strict=True)
        ],
        "start": start,
        "moving": {path: _columns(X) for path, X in drawn.moving.items()},
    }


def describe_instance(reader: RunReader, selection: Selection) -> str:
    """An instance's number, its region, and its place among those that fail."""
    assert selection.instance is not None
    book = reader.catalogue(selection.round)
    event = reader.event(selection.round)
    region = int(event.evaluation.region[selection.instance])
    words = (
        f"instance {selection.instance:,} of {len(event.evaluation.coordinates):,}, region {region}"
    )
    place = book.find(selection.instance)
    if place is not None and place < book.failing:
        order = book.of_region(selection.region)
        failing = order[order < book.failing]
        among = "" if selection.region is None else " in this region"
        words += f"; failing, {int((failing < place).sum()) + 1:,} of {len(failing):,}{among}"
    elif event.evaluation.outcomes[selection.instance].success.any():
        words += "; succeeds"
    if place is not None and place == book.suggested():
        words += "; the suggested place for the next demonstration"
    return words


def where(area: WorkArea, coordinates: Array) -> str:
    """Where the objects of an instance (k, c) are, in words."""
    return ", ".join(
        f"{o.name} at {area.words(i, coordinates)}" for i, o in enumerate(area.objects)
    )


def _number(value: float) -> float | None:
    """To four digits; None where there is none."""
    return None if np.isnan(value) else float(f"{value:.4g}")


def _columns(X: Array) -> list[list[float]]:
    """Poses (m, 4, 4) in three.js's order."""
    return np.round(np.swapaxes(X, -1, -2).reshape(len(X), 16), 5).tolist()
