"""How faithfully both methods of segmentation keep recordings, and how long they take.

    python benchmarks/fidelity.py --demonstrations 'demos/{task}' [--model arm.sdf] [--instances N]
        [--figure PNG --recording pouring/demo_30]

prints two tables in Markdown. One is of all recordings of a task: guiding poses (mean, most), the
largest deviation of the samples kept (median of the recordings, worst), the end effector's turn
near the object that is lost (mean, worst, and recordings that lose more than 0.2 rad), the share of
the time near the object that is kept, the share of N instances for which one demonstration has a
plan within the joint limits (mean), and the processor's time for a recording (median, most). The
other has a line for each recording, and the figure shows one under both methods.
`drake_screw.demonstrations.fidelity` says what is measured.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from task import TASKS

from drake_screw.assembly.setup import Setup
from drake_screw.assembly.swap_model import swap_model
from drake_screw.demonstrations import (
    Demonstration,
    Recording,
    SegmentationConfig,
    guiding_poses,
    read_library,
)
from drake_screw.demonstrations.faithful import FaithfulConfig, faithful_guiding_poses
from drake_screw.demonstrations.fidelity import Fidelity, fidelity
from drake_screw.planning import BatchPlanner
from drake_screw.robot import Arm
from drake_screw.scenario.loader import load_scenario
from drake_screw.typing import Array

METHODS = ("published", "faithful")
CONFIG = FaithfulConfig()


@dataclass(frozen=True)
class Measured:
    """One recording under one method.

    Attributes:
        demonstration: made of it.
        fidelity: of the demonstration's one object.
        near: share of the recording's time near the object.
        seconds: processor time of the segmentation, the least of three.
    """

    demonstration: Demonstration
    fidelity: Fidelity
    near: float
    seconds: float


def measure(recording: Recording, arm: Arm, method: str) -> Measured:
    """Segment a recording of one object and hold the result against it."""
    path, X_WO, times = arm.pose(recording.q), recording.X_WO, []
    for _ in range(3):
        begin = time.process_time()
        if method == "published":
            found = guiding_poses(path, X_WO, SegmentationConfig())
        else:
            found = faithful_guiding_poses(path, X_WO, CONFIG, t=recording.t)
        times.append(time.process_time() - begin)
    X_OE, objects, kept = found
    regions = CONFIG.regions(path, X_WO, [0])
    (kept_to,) = fidelity(path, recording.t, X_WO, X_OE, objects, ["bowl"], CONFIG, regions=regions)
    near = np.diff(recording.t, append=recording.t[-1])[regions.samples(0)].sum()
    return Measured(
        Demonstration(recording.name, X_OE, objects, X_WO, path, kept),
        kept_to,
        float(near / recording.duration),
        min(times),
    )


def summary(results: list[Measured], covered: Array) -> str:
    """A row's cells of the table of tasks."""
    count = np.array([r.fidelity.guiding_poses for r in results])
    position = 1e3 * np.array([r.fidelity.position for r in results])
    rotation = np.array([r.fidelity.rotation for r in results])
    lost = np.array([r.fidelity.turn_shown - r.fidelity.turn_kept for r in results])
    kept = np.array([r.fidelity.time / r.near for r in results])
    seconds = 1e3 * np.array([r.seconds for r in results])
    return (
        f"{count.mean():.1f} ({count.max()}) | "
        f"{np.median(position):.0f} ({position.max():.0f}) mm | "
        f"{np.median(rotation):.2f} ({rotation.max():.2f}) rad | "
        f"{lost.mean():.2f} ({lost.max():.2f}) rad | {(lost > 0.2).sum()} of {len(lost)} | "
        f"{kept.mean():.0%} | {covered.mean():.3f} | "
        f"{np.median(seconds):.0f} ({seconds.max():.0f}) ms"
    )


def draw(task: str, folder: Path, model: Path | None, file: Path) -> None:
    """One recording under both methods: how far its samples are from the screws, over time."""
    figure = Figure(figsize=(10, 4.6), layout="constrained")
    axes = figure.subplots(2, len(METHODS), sharex=True, sharey="row")
    for column, method in enumerate(METHODS):
        scenario = load_scenario(task, [f"segmentation.method={method}"])
        setup = Setup(scenario if model is None else swap_model(scenario, model))
        look = setup.look(setup.recorder.read(folder, "folder"))
        assert look.demonstration is not None
        (kept,) = look.demonstration.fidelity
        turn = f"turn {kept.turn_kept:.2f} of {kept.turn_shown:.2f} rad"
        title = f"{method}: {kept.guiding_poses} guiding poses, {turn}"
        axes[0, column].set_title(title, fontsize=10)
        axes[1, column].set_xlabel("time (s)")
        for near in look.deviations:
            t = look.t[near.samples]
            axes[0, column].plot(t, 1e3 * near.position, color="#0072b2")
            axes[1, column].plot(t, near.rotation, color="#0072b2")
        for ax, tolerance in zip(axes[:, column], (10.0, 0.1), strict=True):
            ax.axhline(tolerance, color="black", linestyle="--", linewidth=0.9)
            ax.set_ylim(bottom=0.0)
            ax.spines[["top", "right"]].set_visible(False)
            for guide in look.demonstration.kept:
                ax.axvline(look.t[guide], color="0.8", linewidth=0.8, zorder=0)
    axes[0, 0].set_ylabel("from the screws (mm)")
    axes[1, 0].set_ylabel("from the screws (rad)")
    figure.savefig(file, dpi=150)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--demonstrations", required=True, help="folder; {task} is replaced")
    parser.add_argument("--model", type=Path, help="of the arm that the recordings were made on")
    parser.add_argument("--instances", type=int, default=2000)
    parser.add_argument("--figure", type=Path, help="PNG to write")
    parser.add_argument("--recording", default="pouring/demo_30", help="that it shows")
    arguments = parser.parse_args()
    print(
        "| task | method | guiding poses | position | rotation | turn lost | more than 0.2 rad "
        "| time kept | coverage | time |\n" + "|---" * 10 + "|"
    )
    lines = []
    if arguments.figure is not None:
        task, name = arguments.recording.split("/")
        folder = Path(arguments.demonstrations.format(task=task)) / name
        draw(task, folder, arguments.model, arguments.figure)
    for task in TASKS:
        scenario = load_scenario(task)
        setup = Setup(
            scenario if arguments.model is None else swap_model(scenario, arguments.model)
        )
        arm, area = setup.workcell.arm, setup.regions.area
        library = read_library(
            arguments.demonstrations.format(task=task), arm.joint_names, arm.lower, arm.upper
        )
        shape = (arguments.instances, *area.lower.shape)
        X_WO = area.X_WO(np.random.default_rng(0).uniform(area.lower, area.upper, shape))
        planner = BatchPlanner(arm.screw_chain())
        measure(library[0], arm, "faithful")  # compiles
        for method in METHODS:
            results = [measure(recording, arm, method) for recording in library]
            outcomes = planner.all_outcomes(
                tuple(r.demonstration for r in results), X_WO, setup.workcell.start
            )
            covered = outcomes.success.mean(axis=0)
            print(f"| {task} | {method} | {summary(results, covered)} |", flush=True)
            lines += [
                f"| {task} {r.demonstration.name} | {method} | {r.fidelity} | {share:.3f} | "
                f"{1e3 * r.seconds:.0f} ms |"
                for r, share in zip(results, covered, strict=True)
            ]
    print("\n| recording | method | kept | coverage | time |\n" + "|---" * 5 + "|")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
