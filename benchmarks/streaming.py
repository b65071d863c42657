"""What `evaluate` needs for tables of more and more instances: memory, time, and temporary files.

    python benchmarks/streaming.py [--instances N ...] [--kinds KIND ...] [--set KEY=VALUE ...]

For each size and kind of file a table of instances is drawn in the work area of scenario pouring
and planned with one simulated demonstration, in a process of its own. Printed are the greatest
resident memory of that process (VmHWM), the time by the clock, that of planning and of everything
else (starting, reading, writing) for each instance, and the sizes of both tables. By default only
the joint limits are looked at (planner.collision=false) and the bowl is not turned: planning is
then so fast that reading and writing tell. What 10^7 instances take is worked out from the last two
sizes.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drake_screw import load_scenario
from drake_screw.acquisition import Suggestion
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import write_recording
from drake_screw.runs.instance_files import ROWS
from drake_screw.runs.outcome_files import Column, outcome_file
from drake_screw.tasks import column_name

FAST = ("planner.collision=false", "objects.0.symmetry=null")
WANTED = 10_000_000
CALL = """
import atexit, sys
def tell():
    with open("/proc/self/status") as status:
        print(next(line.split()[1] for line in status if line.startswith("VmHWM")), file=sys.stderr)
atexit.register(tell)
from drake_screw.cli import main
main()
"""


@dataclass(frozen=True)
class Measured:
    """Of one call: resident memory in MB, times in s, and bytes of both tables."""

    instances: int
    memory: float
    clock: float
    planning: float
    read: int
    written: int


def draw(setup: Setup, file: Path, count: int) -> None:
    """Write a table of instances, uniform in the work area."""
    area, rng = setup.area, np.random.default_rng(0)
    with outcome_file(file) as table:
        for first in range(0, count, ROWS):
            unit = rng.uniform(size=(min(ROWS, count - first), *area.lower.shape))
            places = area.curved(
                area.flat(area.lower) + unit * (area.flat(area.upper) - area.flat(area.lower))
            )
            table.add(
                [
                    Column(column_name(area, i, area.axes[j]), places[:, i, j], ".6f")
                    for i, j in np.argwhere(area.free)
                ]
            )


def measured(folder: Path, kind: str, count: int, changes: Sequence[str]) -> Measured:
    """One call of the command, in a process of its own."""
    there, out, result = folder / f"in.{kind}", folder / f"out.{kind}", folder / "result.json"
    began = time.perf_counter()
    arguments = [
        *("evaluate", "pouring", "--demonstrations", str(folder / "recordings")),
        *("--instances", str(there), "--output", str(out), "--json", str(result)),
        *(word for change in changes for word in ("--set", change)),
    ]
    done = subprocess.run(
        [sys.executable, "-c", CALL, *arguments], stdout=subprocess.DEVNULL, check=True,
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    clock = time.perf_counter() - began
    memory = float(done.stderr.split()[-1]) / 1024.0
    planning = float(json.loads(result.read_text())["seconds"])
    read, written = there.stat().st_size, out.stat().st_size
    return Measured(count, memory, clock, planning, read, written)


def main() -> None:
    """Measure, and print a line for each size."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--instances", nargs="+", type=int, default=[10**4, 10**5, 10**6])
    parser.add_argument("--kinds", nargs="+", default=["csv", "parquet"])
    parser.add_argument("--set", nargs="*", default=list(FAST), help="keys of the scenario")
    options = parser.parse_args()
    setup = Setup(load_scenario("pouring", options.set))
    place = np.array([[0.9, 0.3, 0.0]])
    lesson = setup.teacher.demonstrate(
        Suggestion(int(setup.regions.index(place)), place),
        number=0, used=(), rng=np.random.default_rng(0),
    )  # fmt: skip
    assert lesson.recording is not None, lesson.remark
    for kind in options.kinds:
        print(f"{kind}: {'instances':>11} {'memory':>8} {'clock':>8} {'planning':>10} {'else':>10}")
        found: list[Measured] = []
        for count in options.instances:
            with tempfile.TemporaryDirectory() as name:
                folder = Path(name)
                write_recording(lesson.recording, folder / "recordings" / "demo")
                draw(setup, folder / f"in.{kind}", count)
                m = measured(folder, kind, count, options.set)
            found.append(m)
            each, other = 1e6 * m.planning / count, 1e6 * (m.clock - m.planning) / count
            sizes = f"{m.read / 1e6:.1f} MB in, {m.written / 1e6:.1f} MB out"
            print(
                f"{count:>{len(kind) + 13},} {m.memory:>5.0f} MB {m.clock:>6.1f} s {each:>7.1f} us "
                f"{other:>7.1f} us   {sizes}",
                flush=True,
            )
        if len(found) > 1:
            a, b = found[-2:]
            more = (b.clock - a.clock) / (b.instances - a.instances)
            whole = b.clock + more * (WANTED - b.instances)
            print(f"worked out: {WANTED:,} instances in {whole / 60.0:.1f} min")


if __name__ == "__main__":
    main()
