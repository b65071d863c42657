"""What the program makes of broken inputs: a hundred thousand of them, or as many as asked for.

    python benchmarks/soak.py --work FOLDER [--count N] [--seed N] [--kinds KIND ...] [--workers N]

Scenarios, overrides, recordings, object poses, libraries, logs, lists of instances, run and study
directories, models and command lines that are right are broken: their bytes, lines, values, cells,
elements or places. The command is called with each, in processes of which a crash or a hang costs
one. Right is exit code 2 with one message that names what was given, no traceback, and no file
left. What is still right though it was broken ends as it should (`accepted`, or `ended`: with exit
code 1).

An input depends on (seed, kind, index) alone. Verdicts are kept in FOLDER/verdicts_SEED.jsonl as
they come, with what was printed where there is a fault; called again, the program goes on from
there, and calls those with faults again. `--show KIND:INDEX` breaks and calls one, and prints what
comes of it.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import shutil
import signal
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from soak_inputs import KINDS
from soak_originals import make_originals
from soak_worker import ACCEPTED, ENDED, FAULTS, REFUSED, serve

Input = tuple[str, int]
"""Kind and index."""

PATIENCE = 240.0
"""s that a call may take; the longest compiles a planner for an arm of its own."""

TURNS = 3000
"""Inputs after which a process makes way for a new one: what libraries keep grows."""


class Worker:
    """A process, and what it is at."""

    def __init__(self, seed: int, originals: Path) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_begin, args=(theirs, seed, originals), daemon=True)
        self.process.start()
        theirs.close()
        self.at: Input | None = None
        self.since, self.turns = 0.0, 0

    def give(self, case: Input) -> None:
        self.at, self.since, self.turns = case, time.monotonic(), self.turns + 1
        self.pipe.send(case)

    def end(self) -> None:
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid or 0, signal.SIGKILL)
        self.process.join()
        self.pipe.close()


def _begin(pipe: Connection, seed: int, originals: Path) -> None:
    os.setsid()
    serve(pipe, seed, originals)


def verdicts(cases: Iterator[Input], seed: int, originals: Path, workers: int) -> Iterator[Any]:
    """A verdict of each input, as they come."""
    crew: list[Worker] = []
    waiting = next(cases, None)
    while crew or waiting is not None:
        while len(crew) < workers and waiting is not None:
            crew.append(Worker(seed, originals))
            crew[-1].give(waiting)
            waiting = next(cases, None)
        ready = wait([one.pipe for one in crew], timeout=1.0)
        for one in list(crew):
            fault = None
            if one.pipe in ready:
                try:
                    yield one.pipe.recv()
                except (EOFError, ConnectionResetError):
                    one.process.join(5.0)
                    fault = f"crash: ended with {one.process.exitcode}"
            elif time.monotonic() - one.since > PATIENCE:
                fault = "hang"
            else:
                continue
            if fault and one.at is not None:
                kind, index = one.at
                verdict = fault.split(":")[0]
                yield {"kind": kind, "index": index, "verdict": verdict, "why": fault}
            if fault or one.turns >= TURNS or waiting is None:
                one.end()
                crew.remove(one)
            else:
                one.give(waiting)
                waiting = next(cases, None)


def shared_out(count: int, kinds: Sequence[str]) -> Iterator[Input]:
    """So many inputs of each kind, by their shares, the kinds taking turns."""
    total = sum(KINDS[kind][0] for kind in kinds)
    numbers = {kind: max(round(count * KINDS[kind][0] / total), 1) for kind in kinds}
    most = max(numbers, key=lambda kind: numbers[kind])
    numbers[most] = max(numbers[most] + count - sum(numbers.values()), 1)
    turns = sorted((i / n, kind, i) for kind, n in numbers.items() for i in range(n))
    return ((kind, index) for _, kind, index in turns)


def table(counts: Counter[tuple[str, str]]) -> str:
    """Counts of verdicts for each kind, as lines of a Markdown table."""
    columns = (REFUSED, ACCEPTED, ENDED, *FAULTS)
    rows = [("kind", "inputs", *columns)]
    for kind in (*KINDS, "all"):
        found = [
            sum(n for (k, v), n in counts.items() if v == verdict and kind in (k, "all"))
            for verdict in columns
        ]
        if sum(found):
            rows.append((kind, *(f"{n:,}" for n in (sum(found), *found))))
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join([lines[0], "|---" * len(rows[0]) + "|", *lines[1:]])


def main() -> None:
    """Break, call, count."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument(
        "--work", type=Path, required=True, help="folder for originals and verdicts"
    )
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kinds", nargs="+", choices=list(KINDS), default=list(KINDS))
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--show", metavar="KIND:INDEX", help="one input, and all that is printed")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the counts, too")
    options = parser.parse_args()
    work = options.work.resolve()
    originals = work / "originals"
    if not (originals / "made").exists():
        shutil.rmtree(originals, ignore_errors=True)
        originals.mkdir(parents=True)
        make_originals(originals)
        (originals / "made").touch()
    if options.show:
        kind, index = options.show.rsplit(":", 1)
        for verdict in verdicts(iter([(kind, int(index))]), options.seed, originals, 1):
            for key, value in verdict.items():
                print(f"{key}: {value}")
        return
    file = work / f"verdicts_{options.seed}.jsonl"
    lines = file.read_text().splitlines() if file.exists() else []
    known = [one for one in map(json.loads, lines) if one["verdict"] not in FAULTS]
    file.write_text("".join(json.dumps(one) + "\n" for one in known))
    done = {(one["kind"], one["index"]) for one in known}
    wanted = set(shared_out(options.count, options.kinds))
    left = (case for case in shared_out(options.count, options.kinds) if case not in done)
    counts = Counter((v["kind"], v["verdict"]) for v in known if (v["kind"], v["index"]) in wanted)
    with file.open("a") as log:
        for verdict in verdicts(left, options.seed, originals, options.workers):
            counts[verdict["kind"], verdict["verdict"]] += 1
            log.write(json.dumps(verdict) + "\n")
            log.flush()
            if verdict["verdict"] in FAULTS:
                print(f"{verdict['kind']}:{verdict['index']} {verdict['verdict']}", file=sys.stderr)
    print(table(counts))
    if options.json:
        found = [{"kind": k, "verdict": v, "count": n} for (k, v), n in sorted(counts.items())]
        options.json.write_text(
            json.dumps({"seed": options.seed, "counts": found}, indent=2) + "\n"
        )


if __name__ == "__main__":
    main()
