"""Quantities along a plan as small charts in SVG, for pages that need no network."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup, escape

from drake_screw.screws.endless import drawn_range
from drake_screw.typing import Array
from drake_screw.visualization.attempt import FAILED, Attempt
from drake_screw.visualization.palette import STATUS_COLORS
from drake_screw.visualization.unreachable import END_OF_REACH

_LINE, _FAINT = "#2b4c7e", "#c9cbd3"


@dataclass(frozen=True, eq=False)
class Curve:
    """A quantity along a plan.

    Attributes:
        name: of the quantity.
        unit: of its values.
        values: (m,) at each point of the plan; NaN where it has none.
        height: (m,) of the curve, from 0 at the lower edge of its range to 1 at the upper.
        ends: what is written at the upper and the lower edge.
        limits: heights at which there is a limit.
        failed: whether it is what the plan failed by.
        asked: height that the end of the failing segment asks for; None if that is not known.
        bound: the limit that its values go by, in words.
    """

    name: str
    unit: str
    values: Array
    height: Array
    ends: tuple[str, str]
    limits: tuple[float, ...]
    failed: bool
    asked: float | None = None
    bound: str = ""


def joint_curves(attempt: Attempt) -> list[Curve]:
    """Each joint's angle between its limits."""
    arm = attempt.arm
    lower, upper = drawn_range(arm.lower, arm.upper, attempt.plan.q)
    heights = (attempt.plan.q - lower) / (upper - lower)
    return [
        Curve(
            name,
            arm.units[j],
            attempt.plan.q[:, j],
            heights[:, j],
            (f"{upper[j]:.2f}", f"{lower[j]:.2f}"),
            (0.0, 1.0),
            failed=j == attempt.failed_joint,
        )
        for j, name in enumerate(arm.joint_names)
    ]


def reach_curves(attempt: Attempt) -> list[Curve]:
    """What an unreachable pose is known by; none of an attempt that ended otherwise.

    Motion of the end effector for a unit of joint motion on a logarithmic scale from 0.001 to 1,
    in the direction of the screw and at the least, and the wrist's distance from the shoulder.
    """
    found = attempt.unreachable
    if found is None:
        return []
    end = float(np.log10(END_OF_REACH)) / 3.0 + 1.0
    curves = [
        Curve(
            name,
            "",
            values,
            np.clip(np.log10(np.maximum(values, 1e-9)) / 3.0 + 1.0, 0.0, 1.0),
            ("1", "0.001"),
            (end,),
            failed=bool(values[-1] < 1.1 * END_OF_REACH),
            bound=f"limit {END_OF_REACH:g}",
        )
        for name, values in (("along the screw", found.gain), ("singular value", found.singular))
    ]
    if found.wrist is not None:
        top = 1.05 * max(found.wrist.most, found.needed)
        curves.append(
            Curve(
                "shoulder to wrist",
                "m",
                found.distance,
                found.distance / top,
                (f"{top:.2f}", "0"),
                (found.wrist.least / top, found.wrist.most / top),
                failed=found.out_of_reach or found.stretched,
                asked=found.needed / top,
                bound=f"limit {found.wrist.most:.3f}",
            )
        )
    return curves


def strip(attempt: Attempt, curve: Curve, samples: Array) -> Markup:
    """A curve along the plan, as high as its range.

    The drawing is 100 units wide, one g-th for each of the g segments, and 24 high; element
    ``cursor`` is a line that a script may move.
    """
    total = len(attempt.guides)
    x, y = 100.0 * attempt.progress[samples] / total, 22.0 - 20.0 * curve.height[samples]
    color = STATUS_COLORS[FAILED] if curve.failed else _LINE
    lines = "".join(
        f'<line x1="0" x2="100" y1="{22.0 - 20.0 * h:.2f}" y2="{22.0 - 20.0 * h:.2f}" '
        'class="limit"/>'
        for h in curve.limits
    )
    lines += "".join(
        f'<line x1="{b:.2f}" x2="{b:.2f}" y1="2" y2="22" class="border"/>'
        for b in 100.0 * np.arange(1, total) / total
    )
    marks = ""
    if curve.failed:
        marks = _tick(x[-1], float(y[-1]), "hit")
    if curve.asked is not None and attempt.failed_segment is not None:
        marks += _tick(
            100.0 * (attempt.failed_segment + 1) / total, 22.0 - 20.0 * curve.asked, "asked"
        )
    return Markup(
        f'<svg class="strip" viewBox="0 0 100 24" preserveAspectRatio="none">{lines}'
        f'<polyline points="{_points(x, y, 2)}" fill="none" stroke="{color}" class="angle"/>'
        f'{marks}<line class="cursor" x1="0" x2="0" y1="0" y2="24"/></svg>'
    )


def chart(attempt: Attempt, curves: Sequence[Curve], caption: str, label: str) -> Markup:
    """Curves along the plan, one panel each, as one drawing.

    Args:
        attempt: that they are of.
        curves: at least one.
        caption: below them.
        label: what the drawing is, for those who do not see it.
    """
    samples, total = attempt.samples(160), len(attempt.guides)
    width, height, left, gap = 640.0, 54.0, 118.0, 12.0
    right = width - 60.0
    x = left + (right - left) * attempt.progress[samples] / total
    parts = []
    bands = left + (right - left) * np.arange(total + 1) / total
    bottom = len(curves) * (height + gap)
    for i, status in enumerate(attempt.status):
        a, b = bands[i], bands[i + 1]
        parts.append(
            f'<rect x="{a:.1f}" y="4" width="{b - a:.1f}" height="5" '
            f'fill="{STATUS_COLORS[status]}"/><text x="{(a + b) / 2:.1f}" y="{bottom + 28:.1f}" '
            f'text-anchor="middle">{i + 1}</text>'
        )
    for number, curve in enumerate(curves):
        top = 16.0 + number * (height + gap)
        y = top + height * (1.0 - curve.height[samples])
        color = STATUS_COLORS[FAILED] if curve.failed else _LINE
        weight = ' font-weight="700"' if curve.failed else ""
        parts.append(
            f'<text x="{left - 8:.0f}" y="{top + height / 2 + 4:.1f}" text-anchor="end"{weight}>'
            f"{escape(curve.name)}</text>"
            f'<rect x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" height="{height:.1f}" '
            f'fill="none" stroke="{_FAINT}"/>'
            f'<text x="{right + 5:.0f}" y="{top + 9:.1f}" class="end">{curve.ends[0]}</text>'
            f'<text x="{right + 5:.0f}" y="{top + height:.1f}" class="end">{curve.ends[1]}</text>'
            + "".join(
                f'<line x1="{b:.1f}" x2="{b:.1f}" y1="{top:.1f}" y2="{top + height:.1f}" '
                f'stroke="{_FAINT}" stroke-dasharray="2 3"/>'
                for b in bands[1:-1]
            )
            + "".join(
                f'<line x1="{left:.1f}" x2="{right:.1f}" y1="{top + height * (1.0 - h):.1f}" '
                f'y2="{top + height * (1.0 - h):.1f}" stroke="#9a9dab" class="limit"/>'
                for h in curve.limits
                if 0.0 < h < 1.0
            )
            + f'<polyline points="{_points(x, y, 1)}" fill="none" stroke="{color}" '
            'stroke-width="2"/>'
        )
        if curve.failed:
            parts.append(f'<circle cx="{x[-1]:.1f}" cy="{y[-1]:.1f}" r="4.5" fill="{color}"/>')
        if curve.asked is not None and attempt.failed_segment is not None:
            parts.append(
                f'<circle cx="{bands[attempt.failed_segment + 1]:.1f}" '
                f'cy="{top + height * (1.0 - curve.asked):.1f}" r="4.5" fill="none" '
                f'stroke="{color}" stroke-width="2" class="asked"/>'
            )
    parts.append(
        f'<text x="{(left + right) / 2:.0f}" y="{bottom + 44:.0f}" text-anchor="middle">'
        f"{escape(caption)}</text>"
    )
    return Markup(
        f'<svg class="chart" viewBox="0 0 {width:.0f} {bottom + 50:.0f}" '
        f'role="img" aria-label="{escape(label)}">{"".join(parts)}</svg>'
    )


def joint_chart(attempt: Attempt) -> Markup:
    """All joints' angles along the plan with their limits."""
    units = " or ".join(sorted(set(attempt.arm.units), reverse=True))
    caption = f"screw segment; angles in {units} between their limits"
    return chart(attempt, joint_curves(attempt), caption, "joint angles along the plan")


def reach_chart(attempt: Attempt) -> Markup | None:
    """How an attempt came to the end of its reach; None of one that ended otherwise."""
    curves = reach_curves(attempt)
    if not curves:
        return None
    caption = (
        "screw segment; end-effector for joint motion, end of reach at 0.01"
        + "; shoulder to wrist in m (ring: at the guiding pose)" * (len(curves) > 2)
    )
    return chart(attempt, curves, caption, "reach along the plan")


def _points(x: Array, y: Array, decimals: int) -> str:
    known = np.isfinite(y)
    return " ".join(
        f"{a:.{decimals}f},{b:.{decimals}f}" for a, b in zip(x[known], y[known], strict=True)
    )


def _tick(x: float, y: float, name: str) -> str:
    return (
        f'<line x1="{x:.2f}" x2="{x:.2f}" y1="{max(y - 3.0, 0.0):.2f}" '
        f'y2="{min(y + 3.0, 24.0):.2f}" class="{name}"/>'
    )
