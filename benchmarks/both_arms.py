"""Coverage of one demonstration with either arm of scenario pouring_both, and with both.

python benchmarks/both_arms.py --figure docs/images/both_arms.png

Over the work area of pouring_both, as the scenario has it and with a bowl that may not be turned,
and over that of scenario pouring, on fresh instances. The demonstration is the one that the
scenario asks its simulated teacher for first. An instance counts for both arms if one of them has a
plan that touches nothing: each from its own start, the other at rest.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from drake_screw import Setup, load_scenario
from drake_screw.acquisition.events import DemonstrationAdded
from drake_screw.acquisition.loop import acquire
from drake_screw.demonstrations import Demonstration
from drake_screw.tasks import draw_in_all
from drake_screw.visualization.palette import failure_color, ink_on

ROUND = 2_000_000
"""The round whose instances are planned. No run gets that far, so they are fresh."""

SHIPPED = (
    "objects.0.x=[0.7056, 1.0796]",
    "objects.0.y=[-0.2367, 0.7833]",
    "table.center=[0.90, 0.27]",
    "table.size=[0.72, 1.50]",
    "regions.grid={x: 4, y: 4}",
)
"""Area, table and regions of scenario pouring."""

CASES = {
    "area of both arms": (),
    "area of both arms, no turns": ("objects.0.symmetry=null",),
    "area of pouring": SHIPPED,
    "area of pouring, no turns": (*SHIPPED, "objects.0.symmetry=null"),
}


@dataclass(frozen=True, eq=False)
class Measured:
    """Failure rates (K,) by who moves, and the regions' corners (K, 2, 2) in m, x and y."""

    rates: dict[str, np.ndarray]
    bounds: np.ndarray
    said: str


def first_demonstration(setup: Setup) -> tuple[Demonstration, str]:
    """The demonstration that a run of the scenario begins with, and the teacher's remark."""

    def never(*_: object) -> tuple[object, object]:
        raise AssertionError("asked for before the first round")

    events = acquire(
        never, setup.teacher, setup.learn, setup.regions,
        initial=1, budget=1, seed=setup.scenario.seed, first=setup.first,
    )  # fmt: skip
    for event in events:
        if isinstance(event, DemonstrationAdded):
            return event.demonstration, event.remark
    raise AssertionError("no demonstration")


def measure(overrides: Sequence[str], per_region: int) -> Measured:
    """One work area, with either arm and with both."""
    setup = Setup(load_scenario("pouring_both", list(overrides)))
    demonstration, remark = first_demonstration(setup)
    regions = setup.regions
    places, _ = draw_in_all(regions, per_region, seed=setup.scenario.seed, round=ROUND)
    X_WO = setup.area.X_WO(places)
    solved = {
        one.name: one.careful_planner.any_success([demonstration], X_WO, one.start).any_success
        for one in setup.arms
    }
    both = setup.planner.any_success([demonstration], X_WO, setup.start).any_success
    assert (both == np.any(list(solved.values()), axis=0)).all()
    solved["both"] = both
    rates = {
        name: 1.0 - good.reshape(regions.K, per_region).mean(axis=1)
        for name, good in solved.items()
    }
    lower, upper = regions.bounds(np.arange(regions.K))
    return Measured(rates, np.stack([lower[:, 0, :2], upper[:, 0, :2]], axis=1), remark)


def main() -> None:
    """Measure, print a table, draw a figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--per-region", type=int, default=60)
    parser.add_argument("--figure", type=Path, help="PNG to write")
    args = parser.parse_args()
    found = {name: measure(overrides, args.per_region) for name, overrides in CASES.items()}
    print(f"{'':28} {'arm':>6} {'coverage':>9} {'worst region fails':>19}")
    for name, case in found.items():
        print(f"{name}: {case.said}")
        for who, rate in case.rates.items():
            print(f"{'':28} {who:>6} {1 - rate.mean():9.3f} {rate.max():19.3f}")
    if args.figure is None:
        return
    tall = [float(np.ptp(case.bounds[..., 0])) for case in found.values()]
    figure = Figure(figsize=(13, 6.4), layout="constrained")
    axes = figure.subplots(len(found), 3, gridspec_kw={"height_ratios": tall})
    for row, (name, case) in zip(axes, found.items(), strict=True):
        for ax, (who, rate) in zip(row, case.rates.items(), strict=True):
            for (low, high), value in zip(case.bounds, rate, strict=True):
                color = failure_color(value)
                (x0, y0), (x1, y1) = low, high
                ax.fill([y0, y1, y1, y0], [x0, x0, x1, x1], fc=tuple(color), ec="#d5d8de", lw=0.6)
                middle = (y0 + y1) / 2, (x0 + x1) / 2
                ink = ink_on(color)
                ax.text(*middle, f"{value:.2f}", ha="center", va="center", color=ink, fontsize=8)
            arm = "both arms" if who == "both" else f"{who} arm"
            ax.set_title(f"{name}: {arm}, {1 - rate.mean():.1%} covered", fontsize=9)
            ax.set_xlim(-0.8, 0.8)
            ax.invert_yaxis()
            ax.set_aspect("equal")
            ax.set_xlabel("y in m", fontsize=8)
            ax.set_ylabel("x in m", fontsize=8)
    figure.suptitle(
        f"Failure rates of one demonstration, {args.per_region} instances in each region"
    )
    figure.savefig(args.figure, dpi=100)


if __name__ == "__main__":
    main()
