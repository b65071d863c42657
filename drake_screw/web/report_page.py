"""``report.html``: a whole run on one page that needs no network."""

from __future__ import annotations

import base64
from html import escape
from pathlib import Path

import numpy as np

from drake_screw.acquisition import RoundFinished
from drake_screw.planning import Cause
from drake_screw.runs.reader import RunReader
from drake_screw.visualization.attempt import Attempt, headline
from drake_screw.visualization.linkage import Linkage
from drake_screw.visualization.palette import OUTCOME_COLORS, OUTCOME_NAMES
from drake_screw.visualization.rounds import details
from drake_screw.visualization.rounds import headline as round_headline
from drake_screw.web.arm_sketch import arm_sketch
from drake_screw.web.charts import joint_chart
from drake_screw.web.choice import Choice, choose
from drake_screw.web.inspector_page import save_page
from drake_screw.web.panel import web, where

PAGES = "inspect"
WORST = 8
"""Regions listed for each round."""
OTHERS = 2
"""Instances of other regions that are pictured for each round."""


def write_report(reader: RunReader, folder: Path | None = None) -> Path:
    """Write report.html, and a 3-D page for an instance of each round into the folder inspect.

    Args:
        reader: of the run.
        folder: where to; the run directory if None.

    Returns:
        The report.
    """
    folder = reader.directory.path if folder is None else folder
    folder.mkdir(parents=True, exist_ok=True)
    linkage = Linkage(reader.setup.workcell)
    sections = []
    for round in range(reader.rounds):
        choice = choose(reader, round)
        page = f"{PAGES}/round_{round + 1:02d}.html"
        save_page(reader, choice, folder / page)
        sections.append(_round(reader, choice, linkage, page))
    name = escape(reader.setup.scenario.name)
    text = (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta name="viewport" content="width=device-width"><title>{name}: report</title>'
        f"<style>{web('report.css')}</style></head><body>\n"
        f"{_head(reader)}\n{''.join(sections)}\n{_demonstrations(reader)}</body></html>\n"
    )
    file = folder / "report.html"
    file.write_text(text, encoding="utf-8")
    return file


def _head(reader: RunReader) -> str:
    """Scenario, certificate, facts, and the course of the run."""
    record, scenario = reader.directory.record, reader.setup.scenario
    stated = record.certificate
    certified = stated is not None and stated.certified
    color = OUTCOME_COLORS[Cause.SUCCESS if certified else Cause.JOINT_LIMIT]
    title = "Certificate" if certified else f"No certificate: {record.status}"
    lines = () if stated is None else stated.statement
    words = "".join(f"<br>{escape(line)}" for line in lines)
    block = scenario.coverage
    facts = [
        ("goal", f"every region succeeds at least {block.beta:g} of the time"),
        ("accuracy, confidence", f"{block.epsilon:g}, {1 - block.delta:g}"),
        ("strategy", block.strategy),
        ("demonstrations", str(len(record.demonstrations))),
        ("rounds", str(reader.rounds)),
        ("seed", str(record.seed)),
        ("started", record.started),
        ("finished", record.finished or "not yet"),
        ("versions", ", ".join(f"{k} {v}" for k, v in record.versions.items())),
    ]
    rows = "".join(f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in facts)
    picture = _picture(reader.directory.path / "rounds.png", "all rounds of the run")
    return (
        f'<h1>{escape(scenario.name)}</h1><p class="quiet">{escape(scenario.description)}</p>'
        f'<div class="verdict" style="border-color: {color}"><b>{escape(title)}</b>{words}</div>'
        f"<table>{rows}</table>{picture}"
    )


def _round(reader: RunReader, choice: Choice, linkage: Linkage, page: str) -> str:
    """One round: its heat map, its worst regions, and one instance of it looked at closely."""
    event = reader.event(choice.round)
    folder = reader.directory.round_folder(choice.round)
    return (
        f'<section id="round-{choice.round + 1}"><h2>{escape(round_headline(event)).capitalize()}'
        f"</h2><p>{escape(details(event, event.regions))}</p>"
        f"{_picture(folder / 'heat_map.png', 'heat map of the round')}{_regions(event)}"
        f"{_instance(reader, choice, linkage, page)}{_others(reader, choice, linkage)}"
        "</section>\n"
    )


def _regions(event: RoundFinished) -> str:
    verdict, regions = event.verdict, event.regions
    order = np.argsort(-np.nan_to_num(verdict.estimates, nan=-1.0), kind="stable")[:WORST]
    rows = "".join(
        f'<tr><td class="number">{j}</td><td>{escape(regions.name(j))}</td>'
        f'<td class="number">{verdict.failures[j]:,} / {verdict.samples[j]:,}</td>'
        f'<td class="number">{verdict.estimates[j]:.4f}</td>'
        f'<td class="number">{verdict.upper[j]:.4f}</td></tr>'
        for j in order.tolist()
    )
    return (
        f"<h3>The {len(order)} regions that fail most, of {regions.K}</h3><table><tr>"
        '<th class="number">region</th><th>where</th><th class="number">failed</th>'
        '<th class="number">rate</th><th class="number">at most</th></tr>'
        f"{rows}</table>"
    )


def _instance(reader: RunReader, choice: Choice, linkage: Linkage, page: str) -> str:
    """The suggested instance, or the earliest failing: all attempts, the best of them drawn."""
    if choice.instance is None or choice.demonstration is None:
        return ""
    setup, event = reader.setup, reader.event(choice.round)
    book = reader.catalogue(choice.round)
    place = book.find(choice.instance)
    kind = "The suggested place for the next demonstration"
    if place is None or place != book.suggested():
        failing = place is not None and place < book.failing
        kind = "The instance that fails earliest" if failing else "An instance that succeeds"
    attempts = reader.attempts(choice.round, choice.instance)
    best = attempts[choice.demonstration]
    x_y_yaw = event.evaluation.x_y_yaw[choice.instance]
    sketch = arm_sketch(best, linkage, setup.area, setup.objects, setup.table)
    stem = page.removesuffix(".html")
    return (
        f"<h3>{kind}: {escape(where(setup.area, x_y_yaw))}</h3>"
        f"<table>{''.join(_attempt(tried) for tried in attempts)}</table>"
        f'<p><a href="{page}">See it in 3-D</a> · numbers: <a href="{stem}.json">JSON</a>, '
        f'<a href="{stem}.csv">CSV</a> · instance {choice.instance} of the round</p>'
        f"<h3>Demonstration {best.number + 1} there, joint by joint</h3>"
        f'<div class="attempt"><div>{joint_chart(best)}</div><div>{sketch}</div></div>'
    )


def _others(reader: RunReader, choice: Choice, linkage: Linkage) -> str:
    """The earliest failing instance of each of the worst regions but the chosen one's, pictured."""
    setup, event = reader.setup, reader.event(choice.round)
    book, verdict = reader.catalogue(choice.round), event.verdict
    here = None if choice.instance is None else event.evaluation.region[choice.instance]
    order = np.argsort(-np.nan_to_num(verdict.estimates, nan=-1.0), kind="stable").tolist()
    parts = []
    for region in order:
        failing = book.of_region(region)
        if region == here or len(failing) == 0 or failing[0] >= book.failing:
            continue
        instance = int(book.instance[failing[0]])
        best = reader.best(choice.round, instance)
        if best is None:
            continue
        tried = reader.attempt(choice.round, instance, best)
        place = where(setup.area, event.evaluation.x_y_yaw[instance])
        sketch = arm_sketch(tried, linkage, setup.area, setup.objects, setup.table)
        parts.append(
            f"<div><p><b>region {region}: {escape(place)}</b> (instance {instance})<br>"
            f"demonstration {best + 1} {escape(headline(tried))}</p>{sketch}</div>"
        )
        if len(parts) == OTHERS:
            break
    if not parts:
        return ""
    return f'<h3>Elsewhere</h3><div class="others">{"".join(parts)}</div>'


def _attempt(tried: Attempt) -> str:
    color, name = OUTCOME_COLORS[tried.cause], OUTCOME_NAMES[tried.cause]
    return (
        f'<tr><td class="number">{tried.number + 1}</td><td>{escape(tried.demonstration.name)}'
        f'</td><td style="white-space: nowrap"><span class="chip" style="background: {color}">'
        f"</span>{name}</td><td>{escape(headline(tried))}</td></tr>"
    )


def _demonstrations(reader: RunReader) -> str:
    rows = "".join(
        f'<tr><td class="number">{number}</td><td>{escape(entry.name)}</td>'
        f"<td>{escape(entry.remark)}</td><td>{escape('; '.join(entry.notes))}</td></tr>"
        for number, entry in enumerate(reader.directory.record.demonstrations, start=1)
    )
    return (
        '<section><h2>Demonstrations</h2><table><tr><th class="number"></th><th>name</th>'
        f"<th>remark</th><th>notes</th></tr>{rows}</table></section>"
    )


def _picture(file: Path, words: str) -> str:
    """A picture inside the page; nothing where the file is missing."""
    if not file.is_file():
        return ""
    data = base64.b64encode(file.read_bytes()).decode()
    return f'<img alt="{escape(words)}" src="data:image/png;base64,{data}">'
