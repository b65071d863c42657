"""How the batch planner's answers and cost depend on its step tolerance.

    python benchmarks/convergence.py [--output FIGURE.png]

Random pairs of instance and demonstration of each scenario are planned with a row of tolerances
and compared with the reference planner's method in small steps (fine_steps.py). Takes some minutes;
every tolerance is compiled once.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from fine_steps import fine_outcomes
from task import TASKS, Task, load_task

from drake_screw.planning import BatchPlanner, Cause, Outcomes
from drake_screw.planning.batch import EVALUATIONS_PER_STEP
from drake_screw.planning.compiled import Settings
from drake_screw.typing import Array

TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
TIGHTEST = 1e-9
COLORS = {"pouring": "#0072b2", "scooping": "#d55e00"}


@dataclass(frozen=True)
class Convergence:
    """What a row of T tolerances gives for one task.

    Attributes:
        differing: (T,) share of pairs whose success differs from small steps.
        failing_segment: (T,) share of common failures in another segment.
        off: (T,) rad, 99th percentile of the largest joint error at the end of successes.
        evaluations: (T,) of dq/ds for one plan.
    """

    differing: Array
    failing_segment: Array
    off: Array
    evaluations: Array


def converge(task: Task, pairs: int, seed: int) -> Convergence:
    """Plan random pairs with every tolerance."""
    rng, D = np.random.default_rng(seed), len(task.demonstrations)
    X_WO, which = task.instances(pairs, rng), rng.integers(0, D, pairs)
    chain = task.arm.screw_chain()
    guides = [task.demonstrations[d].transfer(X) for d, X in zip(which, X_WO, strict=True)]
    fine = fine_outcomes(chain, task.q_start, guides, step=0.01, joint_step=0.005)
    exact = _ends(task, X_WO, which, TIGHTEST)
    rows = []
    for tolerance in TOLERANCES:
        planner = BatchPlanner(chain, tolerance=tolerance)
        ours: Outcomes = planner.all_outcomes(task.demonstrations, X_WO, task.q_start)
        ours = ours[np.arange(pairs), which]
        both = ~ours.success & (fine.cause != Cause.SUCCESS)
        off = np.abs(_ends(task, X_WO, which, tolerance) - exact).max(axis=1)
        rows.append(
            (
                (ours.success != (fine.cause == Cause.SUCCESS)).mean(),
                (ours.segment != fine.segment)[both].mean(),
                np.nanpercentile(off, 99.0),
                planner.evaluations / (pairs * D),
            )
        )
        print(f"{task.name:10}{tolerance:8.0e}  " + "  ".join(f"{v:.3g}" for v in rows[-1]))
    return Convergence(*np.array(rows).T)


def _ends(task: Task, X_WO: Array, which: Array, tolerance: float) -> Array:
    """(pairs, n) joint angles at the end of each success, NaN elsewhere."""
    planner = BatchPlanner(task.arm.screw_chain(), tolerance=tolerance)
    plans = planner.plans(task.demonstrations, X_WO, task.q_start, which)
    return np.array([plan.q[-1] if plan.success else 0.0 * plan.q[-1] + np.nan for plan in plans])


def draw(results: dict[str, Convergence], pairs: int, file: Path) -> None:
    """Agreement, error and cost against the tolerance."""
    figure, axes = plt.subplots(1, 3, figsize=(10.5, 3.3), layout="constrained")
    for name, c in results.items():
        look = {"marker": "o", "color": COLORS.get(name), "label": name}
        axes[0].plot(TOLERANCES, 100.0 * np.maximum(c.differing, 0.0), **look)
        axes[1].loglog(TOLERANCES, c.off, **look)
        axes[2].plot(TOLERANCES, c.evaluations, **look)
    axes[0].set(title="success differs from small steps", ylabel="% of pairs", ylim=(0.0, None))
    axes[1].set(title="joint error at the end", ylabel="rad, 99th percentile")
    axes[1].loglog(TOLERANCES, TOLERANCES, ":", color="0.5", label="= tolerance")
    axes[2].set(title=f"cost ({EVALUATIONS_PER_STEP} a step)", ylabel="evaluations a plan")
    axes[2].set_ylim(0.0, None)
    for ax in axes:
        ax.set_xscale("log")
        ax.axvline(Settings().tolerance, color="0.75", zorder=0)
        ax.set_xlabel("step tolerance, rad")
        ax.grid(alpha=0.3)
    axes[1].legend(frameon=False)
    axes[0].annotate(
        "default",
        (Settings().tolerance, 0.97),
        xycoords=("data", "axes fraction"),
        xytext=(4, 0),
        textcoords="offset points",
        va="top",
        color="0.4",
    )
    figure.savefig(file, dpi=110)
    print(f"{file}: {pairs} pairs a task")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", default=TASKS, help="shipped scenarios")
    parser.add_argument("--demonstrations", metavar="DIR", help="a library; {task} is replaced")
    parser.add_argument("--model", type=Path, help="of the arm that they were recorded on")
    parser.add_argument("--pairs", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--output", type=Path, default=Path("convergence.png"))
    arguments = parser.parse_args()
    results = {
        name: converge(
            load_task(name, arguments.demonstrations, arguments.model),
            arguments.pairs,
            arguments.seed,
        )
        for name in arguments.tasks
    }
    draw(results, arguments.pairs, arguments.output)


if __name__ == "__main__":
    main()
