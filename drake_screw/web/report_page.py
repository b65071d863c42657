"""``report.html``: a whole run on one page that needs no network."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from drake_screw.acquisition import RoundFinished
from drake_screw.assembly.setup import Setup
from drake_screw.errors import confidence
from drake_screw.files import write_text, writing
from drake_screw.planning import Cause
from drake_screw.planning.touching import count_collisions
from drake_screw.runs.reader import RunReader
from drake_screw.runs.summary import count_executions, round_in_run
from drake_screw.steps import Step, Tell, to_nobody
from drake_screw.typing import Array
from drake_screw.visualization.attempt import Attempt, headline
from drake_screw.visualization.linkage import Linkage
from drake_screw.visualization.meshcat_page import render
from drake_screw.visualization.palette import OUTCOME_COLORS, OUTCOME_NAMES
from drake_screw.visualization.rounds import bounds_over, details
from drake_screw.web.arm_sketch import arm_sketch
from drake_screw.web.charts import joint_chart, reach_chart
from drake_screw.web.inspector_page import save_page
from drake_screw.web.inspector_panel import changed, where
from drake_screw.web.selection import Selection, select

PAGES = "inspect"
WORST = 8
"""Regions listed for each round."""
OTHERS = 2
"""Instances of other regions that are pictured for each round."""

_REMEDY = "A report is written into its run directory; make the folder writable."


def write_report(reader: RunReader, folder: Path | None = None, tell: Tell = to_nobody) -> Path:
    """Write report.html, and a 3-D page for an instance of each round into the folder inspect.

    Args:
        reader: the run.
        folder: where to; the run directory if None.
        tell: told how far it is.

    Returns:
        The report.

    Raises:
        DrakeScrewError: it cannot be written there.
    """
    folder = reader.directory.path if folder is None else folder
    with writing(folder, _REMEDY):
        folder.mkdir(parents=True, exist_ok=True)
    linkages = tuple(Linkage(workcell) for workcell in reader.setup.workcells)
    rounds = []
    for round in range(reader.rounds):
        tell(Step("drawing instances", round, reader.rounds))
        selection = select(reader, round)
        page = f"{PAGES}/round_{round + 1:02d}"
        save_page(reader, selection, folder / f"{page}.html")
        rounds.append(_round(reader, selection, linkages, page))
    text = render(
        "drake_screw.web",
        "report.html.j2",
        scenario=reader.setup.scenario,
        rounds_picture=_picture(reader.directory.path / "rounds.png"),
        rounds=rounds,
        **_record(reader),
    )
    file = folder / "report.html"
    with writing(file, _REMEDY):
        write_text(file, text + "\n")
    return file


def _record(reader: RunReader) -> dict[str, Any]:
    """What the run's record says: verdict, facts, and demonstrations."""
    record, block = reader.directory.record, reader.setup.scenario.coverage
    stated = record.certificate
    certified = stated is not None and stated.certified
    facts = [
        ("goal", f"every region succeeds at least {confidence(block.beta)} of the time"),
        ("accuracy, confidence", f"{block.epsilon:g}, {confidence(1.0 - block.delta)}"),
        ("strategy", block.strategy),
        ("demonstrations", len(record.demonstrations)),
        ("rounds", reader.rounds),
        ("seed", record.seed),
        ("started", record.started),
        ("finished", record.finished or "not yet"),
        ("versions", ", ".join(f"{k} {v}" for k, v in record.versions.items())),
    ]
    return {
        "verdict": {
            "color": OUTCOME_COLORS[Cause.SUCCESS if certified else Cause.JOINT_LIMIT],
            "title": "Certificate" if certified else f"No certificate: {record.status}",
            "lines": () if stated is None else stated.statement,
        },
        "facts": facts,
        "demonstrations": [
            {
                "name": entry.name,
                "remark": entry.remark,
                "kept": [str(each) for each in entry.fidelity],
                "notes": "; ".join(entry.notes),
            }
            for entry in record.demonstrations
        ],
    }


def _round(
    reader: RunReader, selection: Selection, linkages: Sequence[Linkage], page: str
) -> dict[str, Any]:
    """One round: its heat map, its worst regions, and one instance of it looked at closely."""
    event = reader.event(selection.round)
    folder = reader.directory.round_folder(selection.round)
    before = _rates_before(reader, selection.round)
    return {
        "number": selection.round + 1,
        "headline": round_in_run(event, reader.directory.record),
        "details": details(event, event.regions),
        "executions": str(count_executions(event.evaluation) or ""),
        "collisions": _collisions(reader, event),
        "heat_map": _picture(folder / "heat_map.png"),
        "K": event.regions.K,
        "regions": _regions(event, before),
        "before": before is not None,
        "changed": ""
        if selection.round == 0
        else changed(reader.event(selection.round - 1), event),
        "bounds": bounds_over(event.verdict, reader.setup.scenario.coverage.beta),
        "instance": _instance(reader, selection, linkages, page),
        "others": _others(reader, selection, linkages),
    }


def _collisions(reader: RunReader, event: RoundFinished) -> str:
    """Which bodies touch in the failing instances; "" where none do."""
    found = count_collisions(event.evaluation.outcomes, reader.setup.workcell)
    return str(found) if found.collisions else ""


def _rates_before(reader: RunReader, round: int) -> Array | None:
    """(K,) failure rates in the round before; None of the first, and where regions were others."""
    if round == 0:
        return None
    event, before = reader.event(round), reader.event(round - 1)
    every = np.arange(event.regions.K)
    same = before.regions.K == event.regions.K and all(
        np.allclose(one, other)
        for one, other in zip(
            event.regions.bounds(every), before.regions.bounds(every), strict=True
        )
    )
    return before.verdict.estimates if same else None


def _regions(event: RoundFinished, before: Array | None) -> list[dict[str, Any]]:
    """The worst regions of a round, and how they did in the round before if that is known."""
    verdict, regions = event.verdict, event.regions
    return [
        {
            "number": j,
            "name": regions.name(j),
            "failed": f"{verdict.failures[j]:,} / {verdict.samples[j]:,}",
            "rate": f"{verdict.estimates[j]:.4f}",
            "at_most": f"{verdict.upper[j]:.4f}",
            "before": "" if before is None else f"{before[j]:.4f}",
        }
        for j in _worst_first(event)[:WORST]
    ]


def _instance(
    reader: RunReader, selection: Selection, linkages: Sequence[Linkage], page: str
) -> dict[str, Any] | None:
    """The suggested instance, or the earliest failing: all attempts, the best of them drawn."""
    if selection.instance is None or selection.demonstration is None:
        return None
    setup, event = reader.setup, reader.event(selection.round)
    book = reader.catalogue(selection.round)
    place = book.find(selection.instance)
    kind = "The suggested place for the next demonstration"
    if place is None or place != book.suggested():
        failing = place is not None and place < book.failing
        kind = "The instance that fails earliest" if failing else "An instance that succeeds"
    attempts = reader.attempts(selection.round, selection.instance)
    best = attempts[selection.demonstration]
    return {
        "kind": kind,
        "number": selection.instance,
        "where": where(setup.area, event.evaluation.coordinates[selection.instance]),
        "page": page,
        "attempts": [
            {
                "number": tried.number + 1,
                "name": tried.demonstration.name,
                "color": OUTCOME_COLORS[tried.cause],
                "outcome": OUTCOME_NAMES[tried.cause],
                "headline": headline(tried),
            }
            for tried in attempts
        ],
        "best": best.number + 1,
        "chart": joint_chart(best),
        "reach": reach_chart(best),
        "sketch": _sketch(best, linkages, setup),
    }


def _others(
    reader: RunReader, selection: Selection, linkages: Sequence[Linkage]
) -> list[dict[str, Any]]:
    """The earliest failing instance of each of the worst regions but the selected one's."""
    setup, event = reader.setup, reader.event(selection.round)
    book = reader.catalogue(selection.round)
    here = None if selection.instance is None else event.evaluation.region[selection.instance]
    others: list[dict[str, Any]] = []
    for region in _worst_first(event):
        failing = book.of_region(region)
        if region == here or len(failing) == 0 or failing[0] >= book.failing:
            continue
        instance = int(book.instance[failing[0]])
        best = reader.best(selection.round, instance)
        if best is None:
            continue
        tried = reader.attempt(selection.round, instance, best)
        others.append(
            {
                "region": region,
                "where": where(setup.area, event.evaluation.coordinates[instance]),
                "number": instance,
                "best": best + 1,
                "headline": headline(tried),
                "sketch": _sketch(tried, linkages, setup),
            }
        )
        if len(others) == OTHERS:
            break
    return others


def _sketch(tried: Attempt, linkages: Sequence[Linkage], setup: Setup) -> Markup:
    joints = [arm.robot.joints for arm in setup.arms]
    number = joints.index(tried.arm.joint_names)
    return arm_sketch(
        tried,
        linkages[number],
        setup.area,
        setup.objects,
        setup.table,
        obstacles=setup.obstacles,
        tool=setup.arms[number].robot.tool,
    )


def _worst_first(event: RoundFinished) -> list[int]:
    """Regions by how much of them fails, those without samples last."""
    estimates = np.nan_to_num(event.verdict.estimates, nan=-1.0)
    return np.argsort(-estimates, kind="stable").tolist()


def _picture(file: Path) -> str:
    """A picture as the address of itself; nothing where the file is missing."""
    if not file.is_file():
        return ""
    return f"data:image/png;base64,{base64.b64encode(file.read_bytes()).decode()}"
