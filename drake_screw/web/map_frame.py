"""Where a plane of cells lies in a small drawing, with its axes and the robot beside it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from markupsafe import escape
from matplotlib.ticker import MaxNLocator

from drake_screw.typing import Array
from drake_screw.visualization.cells import Cells
from drake_screw.visualization.palette import INK

WIDTH, HEIGHT = 360.0, 150.0
"""Units of the drawing that the work area fits into; text is 11 of them high."""


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


def draw_axes(drawn: Cells, frame: Frame) -> Iterable[str]:
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
    out = np.sign(base - edge) * [base[1] == edge[1], 1.0]  # over the edge, not beside its corner
    middle, across = edge + 7.0 * out, np.array([-way[1], way[0]])
    tip = middle + 5.0 * way
    corners = [tip, tip - 10.0 * way + 5.0 * across, tip - 10.0 * way - 5.0 * across]
    points = " ".join(f"{u:.1f},{v:.1f}" for u, v in corners)
    end = tip[0] > size[0] - 40.0
    yield (
        f'<polygon points="{points}" fill="{INK}" class="robot"/><text x="'
        f'{middle[0] + (-9.0 if end else 9.0):.1f}" y="{middle[1] + 1.0:.1f}" '
        f'text-anchor="{"end" if end else "start"}" class="axis-name">robot</text>'
    )


def _number(tick: float, ticks: Array) -> str:
    """A tick with as many decimals as any of them needs."""
    decimals = max(len(f"{abs(t):.4f}".rstrip("0").partition(".")[2]) for t in ticks)
    return f"{tick + 0.0 if abs(tick) > 1e-9 else 0.0:.{decimals}f}".replace("-", "−")
