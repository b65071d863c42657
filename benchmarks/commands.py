"""What each verb costs at the keyboard: processor time of a whole command, and how long one waits.

    python benchmarks/commands.py [--verbs VERB ...] [--repeats N] [--history FILE]

Processor time is the operating system's account of the command and all the processes that it
started. Every command is run once before, so that compiled code is in the cache and files are in
memory; of the repeats the least counts, since other work can only add. With --history a line of
JSON is appended to FILE for each call, and where the file has one already the times of the last are
printed beside: a slip is seen there. commands.jsonl, beside this file, has such lines; clock
times before 2026-11-27T11 are of a machine that had much else to do.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from drake_screw.files import now
from drake_screw.versions import versions

PLACES = "x,y\n" + "".join(f"{0.75 + 0.01 * i:.2f},{0.02 * i:.2f}\n" for i in range(20))

VERBS: dict[str, tuple[str, ...]] = {
    "help": ("--help",),
    "list": ("list",),
    "check": ("check", "pouring"),
    "run": ("run", "pouring", "--quiet", "--output", "{fresh}"),
    "report": ("report", "run"),
    "compare": ("compare", "run", "other", "--html", "both.html"),
    "inspect": ("inspect", "run", "--html", "inspected.html"),
    "export": ("export", "run", "--instance", "0.9", "0.3", "--output", "plan.csv"),
    "evaluate": (
        *("evaluate", "pouring", "--demonstrations", "run/demonstrations"),
        *("--instances", "places.csv", "--output", "outcomes.csv"),
    ),
    "look": ("look", "run/demonstrations", "--html", "looks.html"),
    "select": ("select", "pouring", "--demonstrations", "run/demonstrations"),
    "execute": ("execute", "run", "--instance", "0.9", "0.3", "--workers", "1"),
    "study": ("study", "pouring", "--regions", "4", "--runs", "2", "--output", "{fresh}"),
}
"""Verbs and their arguments; {fresh} stands for a folder that does not exist yet."""


def measured(arguments: Sequence[str], folder: Path) -> tuple[float, float]:
    """Processor time and time by the clock, s, of a drake-screw command run in a folder.

    Raises:
        RuntimeError: it failed; with what it said.
    """
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "drake_screw", *arguments],
        cwd=folder,
        env=os.environ | {"COLUMNS": "100"},
        capture_output=True,
        text=True,
        check=False,
    )
    waited, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(arguments)}: {done.stderr.strip()[-500:]}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, waited


def least(verb: str, folder: Path, repeats: int) -> dict[str, float]:
    """The least processor time and time by the clock of a verb, s, after a call that warms up."""
    found = []
    for number in range(repeats + 1):
        arguments = [word.format(fresh=f"{verb}_{number}") for word in VERBS[verb]]
        found.append(measured(arguments, folder))
    processor, clock = zip(*found[1:], strict=True)
    return {"processor_s": min(processor), "clock_s": min(clock)}


def last_in(history: Path | None) -> dict[str, Any]:
    """The verbs of the last line of a history; none where there is no history yet."""
    if history is None or not history.is_file():
        return {}
    lines = history.read_text(encoding="utf-8").splitlines()
    return dict(json.loads(lines[-1])["verbs"]) if lines else {}


def main() -> None:
    """Measure the verbs asked for, print a table, and remember it."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--verbs", nargs="+", choices=VERBS, default=list(VERBS), metavar="VERB")
    parser.add_argument("--repeats", type=int, default=3, help="of each, the least counts")
    parser.add_argument("--history", type=Path, help="file to append a line of JSON to")
    options = parser.parse_args()
    before = last_in(options.history)
    verbs: dict[str, dict[str, float]] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "places.csv").write_text(PLACES)
        for seed, run in enumerate(("run", "other")):
            chosen = ("--seed", str(seed), "--output", run)
            measured(["run", "pouring", "--quiet", *chosen], folder)
        print(f"{'verb':<10} {'processor':>9} {'clock':>7}" + ("    before" if before else ""))
        for verb in options.verbs:
            found = verbs[verb] = least(verb, folder, options.repeats)
            line = f"{verb:<10} {found['processor_s']:>7.2f} s {found['clock_s']:>5.2f} s"
            if verb in before:
                line += f" {before[verb]['processor_s']:>7.2f} s"
            print(line, flush=True)
    if options.history is not None:
        entry = {
            "when": now(),
            "processors": len(os.sched_getaffinity(0)),
            "versions": versions(),
            "verbs": verbs,
        }
        with options.history.open("a", encoding="utf-8") as file:
            file.write(json.dumps(entry) + "\n")


if __name__ == "__main__":
    main()
