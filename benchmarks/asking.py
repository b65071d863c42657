"""How many demonstrations a certificate takes, by how the next one is asked for.

Runs of the tasks with every asking rule (`demonstrations.ask`), with the first demonstration at a
random place or in the middle (`demonstrations.first`), given by a simulated teacher and, with
--demonstrations, out of recordings by every way to choose one (`teacher.choose`). All have the same
seeds, so that means are compared run by run: "more" is how many demonstrations more a run takes
than the same one in the first row of its table.

    python benchmarks/asking.py [TASK ...] [--runs 300] [--demonstrations DIR [--model FILE]]

DIR has a folder of recordings for each task; --rules names other rules, also your own.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from drake_screw.plugins import names
from drake_screw.processes import share_out
from drake_screw.scenario.loader import load_scenario
from drake_screw.studies.experiment import Experiment, StudyRun

RULES, PLACES, CHOICES = names("asking_rules"), ("random", "middle"), ("nearest", "covers_most")


@dataclass(frozen=True)
class Way:
    """A task, what is changed in its scenario, and the columns of its row."""

    task: str
    teacher: str
    ask: str
    first: str
    choose: str
    changes: tuple[str, ...]


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("tasks", nargs="*", default=["pouring", "scooping"], metavar="TASK")
    parser.add_argument("--demonstrations", type=Path, metavar="DIR", help="recordings, by task")
    parser.add_argument("--model", type=Path, metavar="FILE", help="robot of the recordings")
    parser.add_argument("--only-recorded", action="store_true", help="no simulated teacher")
    parser.add_argument("--rules", nargs="+", default=RULES, metavar="RULE")
    parser.add_argument("--first", nargs="+", default=PLACES, choices=PLACES)
    parser.add_argument("--choose", nargs="+", default=CHOICES, choices=CHOICES)
    parser.add_argument("--regions", type=int, default=16, metavar="K")
    parser.add_argument("--runs", type=int, default=300)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--set", nargs="+", default=[], metavar="KEY=VALUE", help="in all runs")
    arguments = parser.parse_args()
    ways = list(_ways(arguments))
    jobs = [(way, arguments.regions, run) for way in ways for run in range(arguments.runs)]
    found: dict[Way, dict[int, StudyRun]] = {way: {} for way in ways}
    shown = 0
    for done, (place, run) in enumerate(
        share_out(_carry_out, jobs, build=dict, workers=arguments.workers), start=1
    ):
        found[jobs[place][0]][run.run] = run
        print(f"\r{done} of {len(jobs)} runs", end="", file=sys.stderr, flush=True)
        while shown < len(ways) and len(found[ways[shown]]) == arguments.runs:
            _show(ways, shown, found)
            shown += 1


def _ways(arguments: argparse.Namespace) -> Iterator[Way]:
    always = ("demonstrations.budget=16", *arguments.set)
    for task in arguments.tasks:
        chosen = [] if arguments.only_recorded else [("simulated", "-", ())]
        if arguments.demonstrations is not None:
            folder = (arguments.demonstrations / task).resolve()
            recorded = ("teacher={kind: recorded}", f"teacher.folder={folder}")
            if arguments.model is not None:
                model = arguments.model.resolve()
                recorded = (*recorded, f"robot.model={model}", "robot.parked={}")
            chosen += [
                ("recorded", choose, (*recorded, f"teacher.choose={choose}"))
                for choose in arguments.choose
            ]
        for teacher, choose, changes in chosen:
            for first in arguments.first:
                for rule in arguments.rules:
                    asked = (f"demonstrations.ask={rule}", f"demonstrations.first={first}")
                    yield Way(task, teacher, rule, first, choose, (*changes, *asked, *always))


def _carry_out(_: dict[str, str], job: tuple[Way, int, int]) -> StudyRun:
    way, K, run = job
    return _experiment(way.task, way.changes).run(K, run)


@cache
def _experiment(task: str, changes: tuple[str, ...]) -> Experiment:
    return Experiment(load_scenario(task, changes))


def _show(ways: list[Way], row: int, found: dict[Way, dict[int, StudyRun]]) -> None:
    way = ways[row]
    table = [other for other in ways if (other.task, other.teacher) == (way.task, way.teacher)]
    runs, base = (
        np.array([found[w][i].demonstrations for i in sorted(found[w])]) for w in (way, table[0])
    )
    print("\r", end="", file=sys.stderr, flush=True)
    if way == table[0]:
        print(f"\n{way.task}, {way.teacher} teacher, {len(runs)} runs\n")
        print("| ask | first | choose | demonstrations | more | not certified | distribution |")
        print("|---|---|---|---|---|---|---|")
    without = sum(not run.certified for run in found[way].values())
    shares = ", ".join(
        f"{k}: {100 * n / len(runs):.3g} %" for k, n in sorted(Counter(runs.tolist()).items())
    )
    more = "" if way == table[0] else _mean(runs - base, "+.2f")
    cells = (way.ask, way.first, way.choose, _mean(runs, ".2f"), more, without, shares)
    print(f"| {' | '.join(map(str, cells))} |", flush=True)


def _mean(values: np.ndarray, form: str) -> str:
    """Mean and its standard error."""
    error = values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else float("nan")
    return f"{values.mean():{form}} ± {error:.2f}"


if __name__ == "__main__":
    main()
