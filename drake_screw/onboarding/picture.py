"""The reach map as a picture: where the arm reaches, what is planned for, and the work area."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle as Patch

from drake_screw.files import write_bytes
from drake_screw.onboarding.at_height import SPACING
from drake_screw.onboarding.design import Design
from drake_screw.planning import Cause
from drake_screw.visualization.palette import INK, OUTCOME_COLORS, PAPER

SHADES = ListedColormap([PAPER, "#dbe4ea", "#b5c9d6", "#8aacc0"])


def reach_figure(design: Design) -> Figure:
    """Seen from above, x up and y to the left, as one looks along with the robot."""
    reach, planned, area = design.reach, design.planned, design.found.area
    figure = Figure(figsize=(8.0, 6.0))
    ax = figure.subplots()
    half = SPACING / 2.0
    edges_x = np.append(reach.x - half, reach.x[-1] + half)
    edges_y = np.append(reach.y - half, reach.y[-1] + half)
    ax.pcolormesh(edges_y, edges_x, reach.share, cmap=SHADES, vmin=0.0, vmax=1.0, zorder=1)
    center, size = design.table.center, design.table.size
    corner = center[1] - size[1] / 2.0, center[0] - size[0] / 2.0
    ax.add_patch(
        Patch(corner, size[1], size[0], fill=False, edgecolor="#9b8a6c", linewidth=1.6, zorder=2)
    )
    ax.text(
        corner[0] + size[1] - 0.02, corner[1] + 0.02, f"table, {design.table.top:g} m high",
        color="#7d6e54", fontsize=8, va="bottom", ha="left", zorder=5,
    )  # fmt: skip
    i, j = np.nonzero(planned.good)
    ax.plot(
        planned.y[j], planned.x[i], "o", ms=2.6, color=OUTCOME_COLORS[Cause.SUCCESS],
        label="planned for, with one demonstration", zorder=3,
    )  # fmt: skip
    ax.add_patch(
        Patch(
            (area.y[0], area.x[0]), area.size[1], area.size[0], fill=False, edgecolor=INK,
            linewidth=2.2, zorder=4, label="work area",
        )
    )  # fmt: skip
    ax.plot(
        design.found.corner[1], design.found.corner[0], "*", ms=13, color="#ffd60a",
        markeredgecolor=INK, zorder=5, label="first demonstration",
    )  # fmt: skip
    _draw_arm(ax, design)
    for number, words in enumerate(("one of three", "two", "all three"), start=1):
        label = f"reached from {words}{' directions' if number == 1 else ''}"
        ax.plot([], [], "s", ms=8, color=SHADES(number), label=label)
    ax.set_aspect("equal")
    ax.set_xlabel("y in m")
    ax.set_ylabel("x in m")
    ax.set_title(f"{design.robot.file.name}, arm '{design.arm.name}'", fontsize=11)
    ax.invert_xaxis()
    ax.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), fontsize=8, frameon=False)
    ax.grid(color="#00000018", linewidth=0.5)
    return figure


def _draw_arm(ax: object, design: Design) -> None:
    """The base, and the arm at the start: points on its axes, seen from above."""
    X = design.chain.pose(np.array(design.start.q))
    p, z, base = X[:3, 3], X[:3, 2], design.chain.shoulder
    motions = design.chain.motions(np.array([design.start.q]))[:, 0]
    points = [base]
    for M, S in zip(motions[1:], design.chain.screws[1:], strict=True):
        w = M[:3, :3] @ S[:3]
        if np.linalg.norm(w) < 0.5:
            continue
        v = M[:3, :3] @ S[3:] + np.cross(M[:3, 3], w)
        q = np.cross(w, v)
        points.append(q + w * (w @ (points[-1] - q)))
    points.append(p)
    line = np.array(points)
    ax.plot(line[:, 1], line[:, 0], "-", color="#5b5566", lw=3, alpha=0.6, zorder=4)  # type: ignore[attr-defined]
    ax.plot(0.0, 0.0, "s", ms=9, color=INK, zorder=5, label="base")  # type: ignore[attr-defined]
    ax.plot(base[1], base[0], "o", ms=7, color="#5b5566", zorder=5, label="shoulder")  # type: ignore[attr-defined]
    ax.annotate(  # type: ignore[attr-defined]
        "", xy=(p[1] + 0.12 * z[1], p[0] + 0.12 * z[0]), xytext=(p[1], p[0]), zorder=6,
        arrowprops={"arrowstyle": "-|>", "color": "#d55e00", "lw": 2.0},
    )  # fmt: skip
    ax.plot([], [], "-", color="#d55e00", lw=2.0, label="hand at the start")  # type: ignore[attr-defined]


def save_reach_picture(design: Design, file: Path) -> None:
    """Write the picture as PNG.

    Raises:
        OSError: it cannot be written.
    """
    content = io.BytesIO()
    reach_figure(design).savefig(
        content,
        format="png",
        dpi=150,
        metadata={"Software": None},
        facecolor=PAPER,
        bbox_inches="tight",
    )
    write_bytes(file, content.getvalue())
