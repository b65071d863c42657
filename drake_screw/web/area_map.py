"""The work area from above as a small drawing, oriented like the 3-D view beside it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup, escape
from matplotlib.colors import to_hex
from matplotlib.ticker import MaxNLocator

from drake_screw.errors import listed
from drake_screw.planning import Cause
from drake_screw.tasks import Regions, Symmetry
from drake_screw.typing import Array
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

MAP_DOTS = 2_000
WIDTH, HEIGHT = 360.0, 150.0
"""Units of the drawing that the work area fits into; text is 11 of them high."""
TOKEN, HERE = 8.0, 11.0
"""Radii of marks."""
BEYOND = 30.0
"""Units that a mark may lie beside the work area and still be drawn."""


@dataclass(frozen=True)
class Frame:
    """Where the plane of the cells lies in the drawing: u to the right and v down.

    Seen from above with the robot at the top y grows to the right and x downwards, as they do in
    the 3-D view, whose camera looks at the robot. Other planes are drawn as a chart is, their
    first axis upwards.

    Attributes:
        corner: (2,) of the plane, m or rad, at u = v = 0.
        scale: (2,) units of the drawing for one of either axis; negative where it grows against
            the drawing.
        size: (2,) of the drawing, v and u.
    """

    corner: Array
    scale: Array
    size: Array

    def place(self, points: Array) -> Array:
        """(..., 2) of the plane to (..., 2) u, v."""
        return ((np.asarray(points) - self.corner) * self.scale)[..., ::-1]

    def direction(self, angle: float) -> Array:
        """(2,) u, v of the unit vector at an angle from the first axis to the second, rad."""
        way = np.array([np.cos(angle), np.sin(angle)]) * np.sign(self.scale)
        return way[::-1]


def frame_of(drawn: Cells) -> Frame:
    """The largest that fits; in proportion where both axes are lengths of one object."""
    lower, upper = drawn.lower.min(axis=0), drawn.upper.max(axis=0)
    span = np.maximum(upper - lower, 1e-3)
    scale = np.array([HEIGHT, WIDTH]) / span
    if drawn.from_above:
        scale = np.full(2, scale.min())
        return Frame(lower, scale, span * scale)
    return Frame(np.array([upper[0], lower[1]]), scale * [-1.0, 1.0], span * scale)


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
    parts += _rates(drawn, event, frame)
    parts += _axes(drawn, frame)
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


def _rates(drawn: Cells, event: Round, frame: Frame) -> Iterable[str]:
    """What part fails, in cells in which something does and that have room for it."""
    for cell, region in enumerate(drawn.region):
        ends = frame.place(np.array([drawn.lower[cell], drawn.upper[cell]]))
        rate = event.verdict.estimates[region]
        if not rate > 0.0 or (np.ptp(ends, axis=0) < [34.0, 14.0]).any():
            continue
        (u, v), color = ends.mean(axis=0), failure_color(rate)
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


def _axes(drawn: Cells, frame: Frame) -> Iterable[str]:
    """Ticks at round numbers with their unit, the axes' names, and where the robot is."""
    (low, high), (height, width) = (drawn.lower.min(axis=0), drawn.upper.max(axis=0)), frame.size
    names = [drawn.label(0), drawn.label(1)]
    for axis in (0, 1):
        most = int(np.clip(frame.size[axis] // (24.0 if axis == 0 else 48.0), 1, 6))
        ticks = MaxNLocator(most, steps=[1, 2, 2.5, 5, 10]).tick_values(low[axis], high[axis])
        for tick in ticks[(ticks >= low[axis] - 1e-9) & (ticks <= high[axis] + 1e-9)]:
            text = _number(tick, ticks)
            at = (tick - frame.corner[axis]) * frame.scale[axis]
            if axis == 0:
                yield (
                    f'<path d="M0 {at:.1f}h-4" class="tick"/><text x="-6" y="{at + 4.0:.1f}" '
                    f'text-anchor="end" class="tick-name">{text}</text>'
                )
            else:
                yield (
                    f'<path d="M{at:.1f} {height:.1f}v4" class="tick"/><text x="{at:.1f}" '
                    f'y="{height + 15.0:.1f}" text-anchor="middle" class="tick-name">{text}</text>'
                )
    yield (
        f'<text x="{width / 2.0:.1f}" y="{height + 29.0:.1f}" text-anchor="middle" '
        f'class="axis-name">{escape(names[1])} →</text>'
        f'<text transform="translate(-34 {height / 2.0:.1f}) rotate(-90)" text-anchor="middle" '
        f'class="axis-name">{escape("← " + names[0] if frame.scale[0] > 0 else names[0] + " →")}'
        "</text>"
    )
    if drawn.in_world:
        yield from _robot(frame)


def _robot(frame: Frame) -> Iterable[str]:
    """A triangle outside the edge nearest to the robot's base, the world's origin, or on it."""
    base = frame.place(np.zeros(2))
    size = frame.size[::-1]
    edge = np.clip(base, 0.0, size)
    way = base - edge
    away = np.linalg.norm(way)
    way = way / away if away > 0.0 else np.array([0.0, -1.0])
    tip, across = edge + (12.0 * way if away > 0.0 else 0.0), np.array([-way[1], way[0]])
    corners = [tip, tip - 10.0 * way + 5.0 * across, tip - 10.0 * way - 5.0 * across]
    points = " ".join(f"{u:.1f},{v:.1f}" for u, v in corners)
    end = tip[0] > size[0] - 40.0
    yield (
        f'<polygon points="{points}" fill="{INK}" class="robot"/><text x="'
        f'{tip[0] + (-9.0 if end else 9.0):.1f}" y="{tip[1] + 6.0:.1f}" '
        f'text-anchor="{"end" if end else "start"}" class="axis-name">robot</text>'
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


def _number(tick: float, ticks: Array) -> str:
    """A tick with as many decimals as any of them needs."""
    decimals = max(len(f"{abs(t):.4f}".rstrip("0").partition(".")[2]) for t in ticks)
    return f"{tick + 0.0 if abs(tick) > 1e-9 else 0.0:.{decimals}f}".replace("-", "−")


def _percent(rate: float) -> str:
    """With a decimal below 10 %."""
    return f"{rate:.1%}" if rate < 0.0995 else f"{rate:.0%}"
