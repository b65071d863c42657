"""Small charts as SVG, for pages that need no network."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup, escape
from matplotlib.colors import to_hex

from drake_screw.errors import listed
from drake_screw.planning import Cause
from drake_screw.screws.endless import drawn_range
from drake_screw.tasks import Regions
from drake_screw.typing import Array
from drake_screw.visualization.attempt import FAILED, Attempt
from drake_screw.visualization.cells import axis_name, cells
from drake_screw.visualization.outlines import Outline
from drake_screw.visualization.palette import (
    ACCENT,
    INK,
    OUTCOME_COLORS,
    PAPER,
    STATUS_COLORS,
    failure_color,
)
from drake_screw.visualization.rounds import Round, Sample, sample

MAP_DOTS = 2_000
_LINE, _FAINT = "#2b4c7e", "#c9cbd3"


def joint_strip(attempt: Attempt, joint: int, samples: Array) -> Markup:
    """A joint's angle along the plan, from the lower to the upper edge of its range.

    The drawing is 100 units wide, one g-th for each of the g segments, and 24 high; element
    ``cursor`` is a line that a script may move.
    """
    arm, total = attempt.arm, len(attempt.guides)
    x = 100.0 * attempt.progress[samples] / total
    q = attempt.plan.q[samples, joint]
    lower, upper = drawn_range(arm.lower, arm.upper, attempt.plan.q)
    share = (q - lower[joint]) / (upper[joint] - lower[joint])
    y = 22.0 - 20.0 * share
    points = " ".join(f"{a:.2f},{b:.2f}" for a, b in zip(x, y, strict=True))
    hit = joint == attempt.failed_joint
    color = STATUS_COLORS[FAILED] if hit else _LINE
    borders = "".join(
        f'<line x1="{b:.2f}" x2="{b:.2f}" y1="2" y2="22" class="border"/>'
        for b in 100.0 * np.arange(1, total) / total
    )
    dot = ""
    if hit:
        dot = (
            f'<line x1="{x[-1]:.2f}" x2="{x[-1]:.2f}" y1="{max(y[-1] - 3, 0):.2f}" '
            f'y2="{min(y[-1] + 3, 24):.2f}" class="hit"/>'
        )
    return Markup(
        '<svg class="strip" viewBox="0 0 100 24" preserveAspectRatio="none">'
        '<line x1="0" x2="100" y1="2" y2="2" class="limit"/>'
        '<line x1="0" x2="100" y1="22" y2="22" class="limit"/>'
        f'{borders}<polyline points="{points}" fill="none" stroke="{color}" class="angle"/>{dot}'
        '<line class="cursor" x1="0" x2="0" y1="0" y2="24"/></svg>'
    )


def joint_chart(attempt: Attempt) -> Markup:
    """All joints' angles along the plan with their limits, one panel each, as one drawing."""
    arm, samples, total = attempt.arm, attempt.samples(160), len(attempt.guides)
    width, height, left, gap = 640.0, 54.0, 118.0, 12.0
    lows, highs = drawn_range(arm.lower, arm.upper, attempt.plan.q)
    x = left + (width - left - 60.0) * attempt.progress[samples] / total
    right = width - 60.0
    parts = []
    bands = left + (right - left) * np.arange(total + 1) / total
    bottom = arm.n * (height + gap)
    for i, status in enumerate(attempt.status):
        a, b = bands[i], bands[i + 1]
        parts.append(
            f'<rect x="{a:.1f}" y="4" width="{b - a:.1f}" height="5" '
            f'fill="{STATUS_COLORS[status]}"/><text x="{(a + b) / 2:.1f}" y="{bottom + 28:.1f}" '
            f'text-anchor="middle">{i + 1}</text>'
        )
    for joint in range(arm.n):
        top = 16.0 + joint * (height + gap)
        lower, upper = float(lows[joint]), float(highs[joint])
        q = attempt.plan.q[samples, joint]
        y = top + height * (1.0 - (q - lower) / (upper - lower))
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
        hit = joint == attempt.failed_joint
        color = STATUS_COLORS[FAILED] if hit else _LINE
        weight = ' font-weight="700"' if hit else ""
        parts.append(
            f'<text x="{left - 8:.0f}" y="{top + height / 2 + 4:.1f}" text-anchor="end"{weight}>'
            f"{escape(arm.joint_names[joint])}</text>"
            f'<rect x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" height="{height:.1f}" '
            f'fill="none" stroke="{_FAINT}"/>'
            f'<text x="{right + 5:.0f}" y="{top + 9:.1f}" class="end">{upper:.2f}</text>'
            f'<text x="{right + 5:.0f}" y="{top + height:.1f}" class="end">{lower:.2f}</text>'
            + "".join(
                f'<line x1="{b:.1f}" x2="{b:.1f}" y1="{top:.1f}" y2="{top + height:.1f}" '
                f'stroke="{_FAINT}" stroke-dasharray="2 3"/>'
                for b in bands[1:-1]
            )
            + f'<polyline points="{points}" fill="none" stroke="{color}" stroke-width="2"/>'
        )
        if hit:
            parts.append(f'<circle cx="{x[-1]:.1f}" cy="{y[-1]:.1f}" r="4.5" fill="{color}"/>')
    units = sorted(set(arm.units), reverse=True)
    parts.append(
        f'<text x="{(left + right) / 2:.0f}" y="{bottom + 44:.0f}" text-anchor="middle">'
        f"screw segment; angles in {' or '.join(units)} between their limits</text>"
    )
    return Markup(
        f'<svg class="chart" viewBox="0 0 {width:.0f} {bottom + 50:.0f}" '
        f'role="img" aria-label="joint angles along the plan">{"".join(parts)}</svg>'
    )


def work_area_map(
    event: Round,
    regions: Regions,
    *,
    here: Array | None = None,
    dots: int = MAP_DOTS,
    things: Sequence[Outline] = (),
) -> Markup:
    """The work area from above, as the heat map shows it, small and light.

    y runs to the left and x away from the robot. The drawing's units are mm; ``data-y`` and
    ``data-x`` hold the m at its left upper corner, so that a script knows where it was clicked.

    Args:
        event: the round.
        regions: of the run.
        here: (k, c) an instance to mark.
        dots: of so many instances, drawn at random, those that fail are drawn.
        things: obstacles, which are drawn as far as they are in the work area.
    """
    drawn = cells(regions, event.verdict.estimates)
    (x0, y0), (x1, y1) = drawn.lower.min(axis=0), drawn.upper.max(axis=0)

    def place(x: float, y: float) -> tuple[float, float]:
        return 1e3 * (y1 - y), 1e3 * (x1 - x)

    parts = []
    for cell, region in enumerate(drawn.region):
        (a, b), (c, d) = drawn.lower[cell], drawn.upper[cell]
        left, top = place(c, d)
        color = to_hex(failure_color(event.verdict.estimates[region]))
        parts.append(
            f'<rect x="{left:.1f}" y="{top:.1f}" width="{1e3 * (d - b):.1f}" '
            f'height="{1e3 * (c - a):.1f}" fill="{color}" class="cell" data-region="{region}">'
            f"<title>region {region}: {event.verdict.estimates[region]:.2%} fail</title></rect>"
        )
    shown = sample(event.evaluation, dots)
    for cause, color in OUTCOME_COLORS.items():
        chosen = (shown.cause == cause) & (cause != Cause.SUCCESS)
        points = drawn.place(shown.coordinates[chosen])
        path = "".join(f"M{u:.0f} {v:.0f}h0" for u, v in (place(x, y) for x, y in points))
        if path:
            parts.append(
                f'<path d="{path}" stroke="{color}" stroke-width="9" stroke-linecap="round"/>'
            )
    for thing in things if drawn.in_world else ():
        edge = " ".join(f"{u:.0f},{v:.0f}" for u, v in (place(x, y) for x, y in thing.corners))
        parts.append(
            f'<polygon points="{edge}" fill="{PAPER}" fill-opacity="0.45" stroke="{INK}" '
            f'stroke-width="5" pointer-events="none" class="obstacle"/>'
        )
    for number, demonstration in enumerate(event.demonstrations, start=1):
        u, v = place(*drawn.place_of(demonstration.X_WO))
        parts.append(
            f'<circle cx="{u:.1f}" cy="{v:.1f}" r="26" fill="{PAPER}" stroke="{INK}" '
            f'stroke-width="4"/><text x="{u:.1f}" y="{v + 12:.1f}" text-anchor="middle" '
            f'class="token">{number}</text>'
        )
    marks: Sequence[tuple[Array | None, str, str]] = (
        (None if event.suggestion is None else event.suggestion.coordinates, ACCENT, "suggested"),
        (here, INK, "here"),
    )
    for coordinates, color, name in marks:
        if coordinates is not None:
            u, v = place(*drawn.place(coordinates))
            parts.append(
                f'<circle cx="{u:.1f}" cy="{v:.1f}" r="{20 if name == "suggested" else 32}" '
                f'fill="{color if name == "suggested" else "none"}" stroke="{INK}" '
                f'stroke-width="{4 if name == "suggested" else 8}" class="{name}"/>'
            )
    return Markup(
        f'<svg class="map" viewBox="-40 -40 {1e3 * (y1 - y0) + 80:.0f} {1e3 * (x1 - x0) + 80:.0f}" '
        f'data-y="{y1:.6f}" data-x="{x1:.6f}">{"".join(parts)}</svg>'
    )


def map_words(event: Round, shown: Sample, regions: Regions) -> str:
    """What the dots of `work_area_map` are, and how many of the instances `shown` in 3-D."""
    words = f"dots: what fails of {sample(event.evaluation, MAP_DOTS).statement}"
    drawn = cells(regions, event.verdict.estimates)
    if drawn.others or not drawn.in_world:
        up, aside = (axis_name(drawn.area, axis) for axis in drawn.axes)
        words = f"{up} upwards, {aside} to the left; {words}"
    if drawn.others:
        how = "the worst region" if drawn.stack > 1 else "the mean"
        words += f"; colours: {how} over {listed(drawn.others)}"
    return words if len(shown.cause) == shown.total else f"{words} (in 3-D: {len(shown.cause):,})"
