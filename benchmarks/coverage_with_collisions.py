"""Coverage of finished runs without and with collision checking, and what the checking costs.

python benchmarks/coverage_with_collisions.py runs/pouring/TIME --figure coverage.png
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from drake_screw.runs.run import open_run
from drake_screw.tasks import draw_in_all
from drake_screw.visualization.palette import failure_color, ink_on

ROUND = 2_000_000
"""The round whose instances are planned. No run gets that far, so they are fresh."""


def measure(run: Path, per_region: int) -> tuple[str, list[np.ndarray], np.ndarray, list[float]]:
    """Name, failure rates (K,) without and with collisions, bounds (K, 2, 2), instances/s."""
    opened = open_run(run)
    setup, demonstrations = opened.setup, opened.demonstrations
    regions, start = setup.regions, setup.workcell.start
    places, _ = draw_in_all(regions, per_region, seed=setup.scenario.seed, round=ROUND)
    X_WO = setup.area.X_WO(places)
    rates, speeds = [], []
    for planner in (setup.batch_planner, setup.careful_planner):
        planner.any_success(demonstrations, X_WO[:2], start)
        began = time.perf_counter()
        outcomes = planner.any_success(demonstrations, X_WO, start)
        speeds.append(len(places) / (time.perf_counter() - began))
        rates.append(1.0 - outcomes.any_success.reshape(regions.K, per_region).mean(axis=1))
    lower, upper = regions.bounds(np.arange(regions.K))
    count, turning = len(demonstrations), any(o.symmetry for o in setup.scenario.objects)
    title = f"{setup.scenario.name}, {count} demonstration{'s' if count > 1 else ''}"
    title += ", turned" if turning else ", as it stands"
    return title, rates, np.stack([lower[:, 0, :2], upper[:, 0, :2]], axis=1), speeds


def main() -> None:
    """Measure, print a table, draw a figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", nargs="+", type=Path, help="directories of finished runs")
    parser.add_argument("--per-region", type=int, default=40)
    parser.add_argument("--figure", type=Path, help="PNG to write")
    args = parser.parse_args()
    figure = Figure(figsize=(11, 2.7 * len(args.runs)), layout="constrained")
    axes = figure.subplots(len(args.runs), 2, squeeze=False)
    print(f"{'run':34} {'checked':>14} {'coverage':>9} {'worst':>7} {'instances/s':>12}")
    for row, run in zip(axes, args.runs, strict=True):
        title, rates, bounds, speeds = measure(run, args.per_region)
        kinds = ("joint limits", "and collisions")
        for ax, kind, rate, speed in zip(row, kinds, rates, speeds, strict=True):
            print(f"{title:34} {kind:>14} {1 - rate.mean():9.3f} {rate.max():7.3f} {speed:12,.0f}")
            for j, value in enumerate(rate):
                (x0, y0), (x1, y1) = bounds[j]
                color = failure_color(value)
                ax.fill([y0, y1, y1, y0], [x0, x0, x1, x1], color=tuple(color))
                middle = (y0 + y1) / 2, (x0 + x1) / 2
                ax.text(*middle, f"{value:.2f}", ha="center", va="center", color=ink_on(color))
            ax.invert_yaxis()
            ax.set_aspect("equal")
            ax.set_title(f"{title}: {kind}", fontsize=10)
            ax.set_xlabel("y in m", fontsize=8)
            ax.set_ylabel("x in m", fontsize=8)
    if args.figure:
        figure.suptitle(f"Failure rates by region, {args.per_region} fresh instances each")
        figure.savefig(args.figure, dpi=100)


if __name__ == "__main__":
    main()
