"""Small charts as SVG, for pages that need no network."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup, escape

from drake_screw.screws.endless import drawn_range
from drake_screw.typing import Array
from drake_screw.visualization.attempt import FAILED, Attempt
from drake_screw.visualization.palette import STATUS_COLORS

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
