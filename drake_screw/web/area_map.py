"""The work area from above as a small drawing, oriented like the 3-D view beside it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from markupsafe import Markup
from matplotlib.colors import to_hex

from drake_screw.errors import listed
from drake_screw.planning import Cause
from drake_screw.tasks import Regions, Symmetry
from drake_screw.typing import Array
from drake_screw.visualization.cell_text import clear_spot, marked_places
from drake_screw.visualization.cells import Cells, cells
from drake_screw.visualization.outlines import Outline
from drake_screw.visualization.palette import (
    ACCENT,
    INK,
    OUTCOME_COLORS,
    PAPER,
    failure_color,
    ink_on,
)
from drake_screw.visualization.rim_marks import mark_angles
from drake_screw.visualization.rounds import Round, Sample, sample
from drake_screw.web.map_frame import Frame, draw_axes, frame_of

MAP_DOTS = 2_000
TOKEN, HERE = 8.0, 11.0
"""Radii of marks."""
BEYOND = 30.0
"""Units that a mark may lie beside the work area and still be drawn."""


def work_area_map(
    event: Round,
    regions: Regions,
    *,
    here: Array | None = None,
    dots: int = MAP_DOTS,
    things: Sequence[Outline] = (),
    symmetries: Sequence[Symmetry | None] = (),
) -> Markup:
    """Failure rates, what fails, demonstrations, and where the next is wanted, as SVG.

    Marks on the rim of a demonstration and of an instance show how the object is turned: one where
    it has no symmetry, as many as there are turns that leave it the same, and a second rim around
    a body of revolution. ``data-at`` holds the plane's corner and scale, so that a script knows
    where it was clicked: first axis, its units, second axis, its units.

    Args:
        event: the round.
        regions: of the run.
        here: (k, c) an instance to mark.
        dots: of so many instances, drawn at random, those that fail are drawn.
        things: obstacles, which are drawn as far as they are in the work area.
        symmetries: of the objects; none has any where left out.
    """
    drawn = cells(regions, event.verdict.estimates)
    frame = frame_of(drawn)
    known = symmetries[drawn.object] if symmetries else None
    parts = [*_cells(drawn, event, frame), *_dots(drawn, event, frame, dots)]
    parts += _things(drawn, frame, things)
    parts += _rates(drawn, event, frame, here)
    parts += draw_axes(drawn, frame)
    shown: list[Array] = []
    for number, demonstration in enumerate(event.demonstrations, start=1):
        given = drawn.area.coordinates(demonstration.X_WO)
        at = frame.place(drawn.place(given))
        if ((at > -BEYOND) & (at < frame.size[::-1] + BEYOND)).all():
            shown.append(at)
            parts.append(_token(at, number))
            parts += _rim(at, TOKEN, given[drawn.object], frame, known, drawn)
    if event.suggestion is not None:
        at = frame.place(drawn.place(event.suggestion.coordinates))
        shown.append(at)
        parts.append(_circle(at, 6.0, ACCENT, 1.5, "suggested"))
    if here is not None:
        at = frame.place(drawn.place(here))
        shown.append(at)
        parts.append(_circle(at, HERE, "none", 2.5, "here"))
        parts += _rim(at, HERE, np.asarray(here)[drawn.object], frame, known, drawn)
    left, top = np.min([np.array([-46.0, -22.0]), *(at - HERE - 8.0 for at in shown)], axis=0)
    ends = frame.size[::-1] + np.array([18.0, 34.0])
    right, bottom = np.max([ends, *(at + HERE + 8.0 for at in shown)], axis=0)
    corner = ",".join(
        f"{v:.9g}" for pair in zip(frame.corner, frame.scale, strict=True) for v in pair
    )
    return Markup(
        f'<svg class="map" viewBox="{left:.1f} {top:.1f} {right - left:.1f} {bottom - top:.1f}" '
        f'data-at="{corner}">{"".join(parts)}</svg>'
    )


def map_words(event: Round, shown: Sample, regions: Regions) -> str:
    """What the dots of `work_area_map` are, and how many of the instances `shown` in 3-D."""
    drawn_of = sample(event.evaluation, MAP_DOTS)
    some = drawn_of.count(Cause.SUCCESS) < len(drawn_of.cause)
    words = f"{'dots: what fails of' if some else 'nothing fails of'} {drawn_of.statement}"
    drawn = cells(regions, event.verdict.estimates)
    if drawn.others:
        how = "the worst region" if drawn.stack > 1 else "the mean"
        words = f"{words}; colours: {how} over {listed(drawn.others)}"
    return words if len(shown.cause) == shown.total else f"{words} (in 3-D: {len(shown.cause):,})"


def _cells(drawn: Cells, event: Round, frame: Frame) -> Iterable[str]:
    for cell, region in enumerate(drawn.region):
        ends = frame.place(np.array([drawn.lower[cell], drawn.upper[cell]]))
        (u, v), (w, h) = ends.min(axis=0), np.ptp(ends, axis=0)
        rate = event.verdict.estimates[region]
        yield (
            f'<rect x="{u:.2f}" y="{v:.2f}" width="{w:.2f}" height="{h:.2f}" '
            f'fill="{to_hex(failure_color(rate))}" class="cell" data-region="{region}">'
            f"<title>region {region}: {rate:.2%} fail</title></rect>"
        )


def _rates(drawn: Cells, event: Round, frame: Frame, here: Array | None) -> Iterable[str]:
    """What part fails, beside marks, in cells in which something does and that have room for it."""
    marks = marked_places(drawn, event)
    if here is not None:
        marks = np.concatenate([marks, drawn.place(here)[None]])
    for cell, region in enumerate(drawn.region):
        ends = frame.place(np.array([drawn.lower[cell], drawn.upper[cell]]))
        rate, (width, height) = event.verdict.estimates[region], np.ptp(ends, axis=0)
        if not rate > 0.0 or width < 34.0 or height < 14.0:
            continue
        text = np.array([4.0 / height, 3.4 * len(_percent(rate)) / width])
        gap = text + HERE / np.array([height, width])
        spot = clear_spot(drawn.lower[cell], drawn.upper[cell], marks, text, gap)
        (u, v), color = frame.place(spot), failure_color(rate)
        halo = PAPER if ink_on(color) == INK else INK
        yield (
            f'<text x="{u:.1f}" y="{v + 4.0:.1f}" text-anchor="middle" fill="{ink_on(color)}" '
            f'stroke="{halo}" class="rate">{_percent(rate)}</text>'
        )


def _dots(drawn: Cells, event: Round, frame: Frame, dots: int) -> Iterable[str]:
    shown = sample(event.evaluation, dots)
    for cause, color in OUTCOME_COLORS.items():
        chosen = (shown.cause == cause) & (cause != Cause.SUCCESS)
        points = frame.place(drawn.place(shown.coordinates[chosen]))
        path = "".join(f"M{u:.1f} {v:.1f}h0" for u, v in points)
        if path:
            yield (f'<path d="{path}" stroke="{color}" stroke-width="2.6" stroke-linecap="round"/>')


def _things(drawn: Cells, frame: Frame, things: Sequence[Outline]) -> Iterable[str]:
    for thing in things if drawn.in_world else ():
        edge = " ".join(f"{u:.1f},{v:.1f}" for u, v in frame.place(thing.corners))
        yield (
            f'<polygon points="{edge}" fill="{PAPER}" fill-opacity="0.45" stroke="{INK}" '
            f'stroke-width="1.5" pointer-events="none" class="obstacle"/>'
        )


def _token(at: Array, number: int) -> str:
    return (
        f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{TOKEN}" fill="{PAPER}" stroke="{INK}" '
        f'stroke-width="1.4"/><text x="{at[0]:.1f}" y="{at[1] + 3.7:.1f}" text-anchor="middle" '
        f'class="token">{number}</text>'
    )


def _circle(at: Array, radius: float, fill: str, line: float, name: str) -> str:
    return (
        f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius}" fill="{fill}" stroke="{INK}" '
        f'stroke-width="{line}" class="{name}"/>'
    )


def _rim(
    at: Array,
    radius: float,
    coordinates: Array,
    frame: Frame,
    symmetry: Symmetry | None,
    drawn: Cells,
) -> Iterable[str]:
    """How an object with `coordinates` (c,) is turned, on the rim of its mark."""
    if not drawn.from_above:
        return
    angles = mark_angles(symmetry)
    if angles is None:
        yield (
            f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius + 2.6}" fill="none" '
            f'stroke="{INK}" stroke-width="0.8" class="round"/>'
        )
        return
    yaw = float(coordinates[2])
    for angle in angles:
        way = frame.direction(yaw + float(angle))
        (u, v), (w, z) = at + radius * way, at + (radius + 6.0) * way
        yield (
            f'<path d="M{u:.1f} {v:.1f}L{w:.1f} {z:.1f}" stroke="{INK}" stroke-width="3" '
            'class="turn"/>'
        )


def _percent(rate: float) -> str:
    """With a decimal below 10 %."""
    return f"{rate:.1%}" if rate < 0.0995 else f"{rate:.0%}"
