"""How fast the batch planner is against another checkout of this project.

    git worktree add ../before v0.1
    python benchmarks/against.py ../before [--demonstrations 'demos/{task}' --model arm.sdf]

Each checkout plans the same instances with its own code in a process of its own, one thread each.
They take turns, and each turn of the one is compared with the turn of the other beside it, by
processor time: what else the machine does hits both alike. Where memory happens to lie makes one
process faster than the next by up to a fifth, so that both are begun afresh some times. Run it with
the same checkout on both sides to see what is noise.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

TREE = Path(__file__).parents[1]


def worker(task_name: str, folder: str | None, model: str | None, instances: int) -> None:
    """Plans once for every line it reads, and answers with the seconds of processor time."""
    from task import load_task

    from drake_screw.planning import BatchPlanner

    task = load_task(task_name, folder, None if model is None else Path(model))
    X_WO = task.instances(instances, np.random.default_rng(0))
    planner = BatchPlanner(task.arm.screw_chain(), threads=1)
    planner.all_outcomes(task.demonstrations, X_WO[:1], task.q_start)
    print("plans", len(X_WO) * len(task.demonstrations), flush=True)
    print("poses", sum(len(d.X_OE) for d in task.demonstrations), flush=True)
    for _ in sys.stdin:
        began = time.process_time()
        planner.all_outcomes(task.demonstrations, X_WO, task.q_start)
        print("seconds", time.process_time() - began, flush=True)


class Checkout:
    """A worker that runs one checkout's code."""

    def __init__(self, tree: Path, arguments: list[str]) -> None:
        paths = os.pathsep.join((str(tree), str(tree / "benchmarks")))
        self._process = subprocess.Popen(
            [sys.executable, "-P", __file__, "--worker", *arguments],
            env=os.environ | {"PYTHONPATH": paths},
            cwd=tree,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.plans, self.poses = int(self._answer("plans")), int(self._answer("poses"))

    def turn(self) -> float:
        """Seconds of processor time that one turn takes."""
        assert self._process.stdin is not None
        self._process.stdin.write("\n")
        self._process.stdin.flush()
        return float(self._answer("seconds"))

    def end(self) -> None:
        """End the worker."""
        self._process.communicate()

    def _answer(self, name: str) -> str:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            if line.startswith(f"{name} "):
                return line.split()[1]
        raise SystemExit("a worker ended too early; its words stand above")


def compare(before: Path, begun: int, turns: int, arguments: list[str]) -> str:
    """A line of words about one task."""
    taken = [take_turns(before, turns, arguments) for _ in range(begun)]
    plans, seconds = taken[0][0], np.stack([each for _, each in taken])
    ratios = np.median(seconds[..., 0] / seconds[..., 1], axis=1)
    speeds = plans / seconds.min(axis=(0, 1))
    return (
        f"{arguments[0]:10} speed {np.median(ratios):.3f} of before ({begun} pairs of processes: "
        f"{', '.join(f'{ratio:.2f}' for ratio in sorted(ratios))}); at best {speeds[0]:,.0f} "
        f"before, {speeds[1]:,.0f} plans/s here"
    )


def take_turns(before: Path, turns: int, arguments: list[str]) -> tuple[int, np.ndarray]:
    """Plans in a turn, and seconds (turns, 2) of the other checkout and of this one."""
    other, here = Checkout(before, arguments), Checkout(TREE, arguments)
    if other.poses != here.poses:
        raise SystemExit(
            f"not the same work: {other.poses} guiding poses before, {here.poses} here; have both "
            "cut recordings alike (segmentation.method in the scenario)"
        )
    seconds = np.empty((turns, 2))
    for i in range(turns):  # ABBA, so that a drift of the machine's speed hits both alike
        order = ((0, other), (1, here)) if i % 2 == 0 else ((1, here), (0, other))
        for column, checkout in order:
            seconds[i, column] = checkout.turn()
    for checkout in (other, here):
        checkout.end()
    return here.plans, seconds


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("before", type=Path, help="the other checkout")
    parser.add_argument("--tasks", nargs="+", default=["pouring", "scooping"])
    parser.add_argument("--demonstrations", metavar="DIR", help="a library; {task} is replaced")
    parser.add_argument("--model", type=Path, help="of the arm that they were recorded on")
    parser.add_argument("--instances", type=int, default=1000)
    parser.add_argument("--begun", type=int, default=9, help="pairs of processes")
    parser.add_argument("--turns", type=int, default=8, help="of each process")
    given = parser.parse_args()
    folder = None if given.demonstrations is None else os.path.abspath(given.demonstrations)
    model = None if given.model is None else os.path.abspath(given.model)
    for task in given.tasks:
        rest = [task, folder or "", model or "", str(given.instances)]
        print(compare(given.before.resolve(), given.begun, given.turns, rest))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--worker"]:
        name, folder, model, instances = sys.argv[2:]
        worker(name, folder or None, model or None, int(instances))
    else:
        main()
