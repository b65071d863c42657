"""How many demonstrations a certificate takes, by how the next one is asked for.

Runs of the tasks with every asking rule (`demonstrations.ask`), with the first demonstration at a
random place, in the middle or at the farthest corner (`demonstrations.first`), given by a simulated
teacher and, with --demonstrations, out of recordings by every way to choose one (`teacher.choose`);
where that is by planning, the place hardly matters, so only the first rule is tried. All have the
same seeds, and are compared run by run: "more" is how many demonstrations more a run takes than the
same one in the first row of its table. A run without a certificate counts by the demonstrations it
ended with.

    python benchmarks/asking.py [TASK ...] [--runs 300] [--demonstrations DIR [--model FILE]]

DIR has a folder of recordings for each task; --rules names other rules, also your own. With --table
FILE finished runs are kept there, and a measurement that was interrupted goes on.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from drake_screw.plugins import names
from drake_screw.scenario.loader import load_scenario
from drake_screw.sharing import share_out
from drake_screw.studies.experiment import Experiment

RULES, PLACES, CHOICES = (
    names("asking_rules"),
    ("random", "middle", "farthest"),
    ("nearest", "covers_most"),
)


@dataclass(frozen=True)
class Way:
    """A task, the columns of its row, and what is changed in its scenario for it."""

    task: str
    teacher: str
    ask: str
    first: str
    choose: str
    changes: tuple[str, ...]


@dataclass(frozen=True)
class Job:
    """One run; as text it is the key of its line in a table."""

    way: Way
    K: int
    run: int

    def __str__(self) -> str:
        return " ".join((self.way.task, *self.way.changes, f"K={self.K}", f"run={self.run}"))


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
    parser.add_argument("--table", type=Path, metavar="FILE", help="keep finished runs here")
    arguments = parser.parse_args()
    ways = list(_ways(arguments))
    jobs = [Job(way, arguments.regions, i) for way in ways for i in range(arguments.runs)]
    found = _kept(arguments.table)
    missing = [job for job in jobs if str(job) not in found]
    shown = _show(ways, 0, arguments, found)
    for place, answer in share_out(_carry_out, missing, build=dict, workers=arguments.workers):
        found[str(missing[place])] = answer
        if arguments.table is not None:
            with arguments.table.open("a", newline="") as table:
                csv.writer(table).writerow((str(missing[place]), *answer))
        if sys.stderr.isatty():
            done = sum(str(job) in found for job in jobs)
            print(f"\r{done} of {len(jobs)} runs\r", end="", file=sys.stderr, flush=True)
        shown = _show(ways, shown, arguments, found)


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
            rules = arguments.rules[:1] if choose == "covers_most" else arguments.rules
            for first in arguments.first:
                for rule in rules:
                    asked = (f"demonstrations.ask={rule}", f"demonstrations.first={first}")
                    yield Way(task, teacher, rule, first, choose, (*changes, *asked, *always))


def _kept(table: Path | None) -> dict[str, tuple[int, bool]]:
    """Demonstrations and whether certified, of the runs in a table."""
    if table is None or not table.exists():
        return {}
    with table.open(newline="") as lines:
        return {key: (int(number), text == "True") for key, number, text in csv.reader(lines)}


def _carry_out(_: dict[str, str], job: Job) -> tuple[int, bool]:
    run = _experiment(job.way.task, job.way.changes).run(job.K, job.run)
    return run.demonstrations, run.certified


@cache
def _experiment(task: str, changes: tuple[str, ...]) -> Experiment:
    return Experiment(load_scenario(task, changes))


def _show(
    ways: list[Way],
    shown: int,
    arguments: argparse.Namespace,
    found: dict[str, tuple[int, bool]],
) -> int:
    """Print the rows that are whole, after the first `shown`; returns how many are shown then."""

    def runs(way: Way) -> np.ndarray:
        keys = [str(Job(way, arguments.regions, i)) for i in range(arguments.runs)]
        return np.array([found[key] for key in keys if key in found]).reshape(-1, 2)

    while shown < len(ways) and len(runs(ways[shown])) == arguments.runs:
        way = ways[shown]
        base = next(w for w in ways if (w.task, w.teacher) == (way.task, way.teacher))
        number, certified = runs(way).T
        if way == base:
            print(f"\n{way.task}, {way.teacher} teacher, {len(number)} runs\n")
            print("| ask | first | choose | demonstrations | more | not certified | distribution |")
            print("|---|---|---|---|---|---|---|")
        more = "" if way == base else _mean(number - runs(base)[:, 0], "+.2f")
        counts = sorted(Counter(number.tolist()).items())
        shares = ", ".join(f"{k}: {100 * n / len(number):.3g} %" for k, n in counts)
        without = np.count_nonzero(certified == 0)
        cells = (way.ask, way.first, way.choose, _mean(number, ".2f"), more, without, shares)
        print(f"| {' | '.join(map(str, cells))} |", flush=True)
        shown += 1
    return shown


def _mean(values: np.ndarray, form: str) -> str:
    """Mean and its standard error."""
    error = values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else float("nan")
    return f"{values.mean():{form}} ± {error:.2f}"


if __name__ == "__main__":
    main()
