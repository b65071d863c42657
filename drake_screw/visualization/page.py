"""Meshcat's page with a legend: it has no text of its own."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from matplotlib.colors import to_hex

from drake_screw.tasks import Regions
from drake_screw.visualization.palette import (
    ACCENT,
    INK,
    OUTCOME_COLORS,
    OUTCOME_NAMES,
    PAPER,
    failure_color,
)
from drake_screw.visualization.rounds import Round, Sample, details, headline

_STYLE = """
#legend { position: fixed; left: 16px; top: 16px; max-width: 21em; padding: 12px 16px;
  font: 14px/1.45 system-ui, sans-serif; color: INK; background: rgba(255, 255, 255, 0.86);
  border-radius: 8px; }
#legend h1 { margin: 0 0 2px; font-size: 16px; }
#legend p { margin: 2px 0; }
#legend .scale { height: 10px; border: 1px solid INK; margin-top: 8px; }
#legend .ends { display: flex; justify-content: space-between; font-size: 12px; }
#legend i { display: inline-block; width: 10px; height: 10px; border-radius: 50%;
  margin-right: 6px; border: 1px solid rgba(0, 0, 0, 0.35); }
#legend .key { margin-right: 12px; white-space: nowrap; }
#legend button { margin: 6px 3px 0 0; min-width: 2.2em; padding: 3px; cursor: pointer; }
#legend button[aria-pressed=true] { color: white; background: INK; }
"""

_SCRIPT = """
const slides = SLIDES;
const legend = document.getElementById("legend");
const show = (name, visible) => viewer.set_property(name.split("/"), "visible", visible);
function open_round(chosen) {
  const last = slides.length - 1, demonstrations = slides[chosen].demonstrations;
  slides.forEach((slide, i) => show("rounds/" + slide.name, i === chosen));
  for (let i = 1; i <= slides[last].demonstrations; ++i)
    show("demonstrations/" + String(i).padStart(2, "0"), i <= demonstrations);
  for (const name of ["instances", "objects"]) show(name, chosen === last);
  legend.querySelector("#headline").textContent = slides[chosen].headline;
  legend.querySelector("#details").textContent = slides[chosen].details;
  legend.querySelector("#instances").hidden = chosen !== last;
  legend.querySelectorAll("button").forEach((b, i) => b.setAttribute("aria-pressed", i === chosen));
  viewer.set_dirty();
}
legend.querySelectorAll("button").forEach((b, i) => { b.onclick = () => open_round(i); });
"""


@dataclass(frozen=True)
class Slide:
    """A round as the page knows it: its name in the scene tree, its text, its demonstrations."""

    name: str
    headline: str
    details: str
    demonstrations: int


def slide(event: Round, regions: Regions) -> Slide:
    """What the page says of a round."""
    name, count = f"{event.round + 1:02d}", len(event.demonstrations)
    return Slide(name, headline(event), details(event, regions), count)


def with_legend(page: str, slides: Sequence[Slide], shown: Sample, *, scenario: str = "") -> str:
    """Meshcat's page with a title, the verdicts of the rounds, and what the colours mean.

    Args:
        page: as `Meshcat.StaticHtml` gives it.
        slides: at least one; the page opens on the last. Several get buttons.
        shown: the instances of the last round that were drawn.
        scenario: its name.
    """
    entries = [
        (OUTCOME_COLORS[cause], f"{name} ({shown.count(cause):,})")
        for cause, name in OUTCOME_NAMES.items()
        if shown.count(cause)
    ]
    stops = ", ".join(to_hex(color) for color in failure_color(np.linspace(0.0, 1.0, 9)))
    last, title = slides[-1], escape(scenario or "drake_screw")
    legend = f"""
<style>{_STYLE.replace("INK", INK)}</style>
<div id="legend">
  <h1>{title}</h1>
  <p><b id="headline">{escape(last.headline)}</b></p>
  <p id="details">{escape(last.details)}</p>
  <div class="scale" style="background: linear-gradient(to right, {stops})"></div>
  <div class="ends"><span>0</span><span>failure probability</span><span>1</span></div>
  <p>{_keys([(PAPER, "demonstration"), (ACCENT, "next demonstration")])}</p>
  <div id="instances"><p>{_keys(entries)}</p><p>{escape(shown.statement)}</p></div>
  <div>{_buttons(slides)}</div>
</div>
<script>{{{_SCRIPT.replace("SLIDES", _json(slides))}}}</script>
"""
    page = page.replace("<title>Drake MeshCat</title>", f"<title>{title}</title>", 1)
    body, end, rest = page.rpartition("</body>")
    return body + legend + end + rest


def _keys(entries: Sequence[tuple[str, str]]) -> str:
    dot = '<span class="key"><i style="background: {}"></i>{}</span>'
    return " ".join(dot.format(color, escape(text)) for color, text in entries)


def _buttons(slides: Sequence[Slide]) -> str:
    if len(slides) < 2:
        return ""
    pressed = [str(s is slides[-1]).lower() for s in slides]
    return "round " + "".join(
        f'<button aria-pressed="{p}">{int(s.name)}</button>'
        for s, p in zip(slides, pressed, strict=True)
    )


def _json(slides: Sequence[Slide]) -> str:
    """The slides as a script may contain them: no ``<``, which could end it."""
    return json.dumps([vars(s) for s in slides]).replace("<", "\\u003c")
