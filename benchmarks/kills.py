"""Killed at any moment, over and over: what a run, a study or executions come to in the end.

    python benchmarks/kills.py [--kinds run study execute] [--kills 200] [--seed N] [--json FILE]

Every kind is carried out once and left alone. Then it is begun again and killed (SIGKILL, of the
main process alone: the processes that share its work end by themselves) at a moment drawn uniformly
from the tenth to the whole of the time it took, carried on, killed again, until it ends by itself;
what is kept must be what was kept by the one left alone. That is repeated in fresh folders until
there were so many kills, shared out evenly among the kinds.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

DRAKE_SCREW = (sys.executable, "-m", "drake_screw")
QUICK = (
    *("--set", "objects.0.symmetry=null", "--set", "coverage.epsilon=0.15"),
    *("--set", "coverage.beta=0.7", "--set", "demonstrations.first=random"),
    *("--set", "coverage.strategy=naive_pac"),
)
"""Changes of scenario pouring with which a run has several rounds and soon ends."""

MOST = 12
"""Kills after which it is let end: where all is begun anew each time, it may never by itself."""

SAME_OF_RUN = ("status", "reason", "certificate", "demonstrations", "rounds")
SAME_OF_STUDY = ("status", "regions", "runs")
ENDED = b"has ended"


class Differs(Exception):
    """What was killed did not end as what was left alone."""


@dataclass(frozen=True)
class Kind:
    """Something to be killed, in a folder of its own.

    Attributes:
        prepare: makes what the commands need, once, in a folder; its path is given to `begin`.
        begin, carry_on: arguments of drake-screw, from what was prepared and the folder.
        begun: whether there is something to carry on in the folder.
        kept: what must be the same in the end, from what was prepared and the folder.
    """

    prepare: Callable[[Path], Path]
    begin: Callable[[Path, Path], Sequence[str]]
    carry_on: Callable[[Path, Path], Sequence[str]]
    begun: Callable[[Path], bool]
    kept: Callable[[Path], dict[str, Any]]


@dataclass(frozen=True)
class Trial:
    """One that was killed until it ended.

    Attributes:
        kills: how often.
        early: how many of them left nothing that could be carried on.
    """

    kills: int
    early: int


def run_kept(folder: Path) -> dict[str, Any]:
    """Record of a run and the instances of its rounds."""
    record = json.loads((folder / "run.json").read_text())
    kept = {name: record[name] for name in SAME_OF_RUN}
    for file in sorted(folder.glob("round_*/instances.npz")):
        arrays = np.load(file)
        kept[file.parent.name] = {name: arrays[name].tolist() for name in arrays.files}
    return kept


def study_kept(folder: Path) -> dict[str, Any]:
    """Record of a study and its tables."""
    record = json.loads((folder / "study.json").read_text())
    tables = {name: (folder / name).read_text() for name in ("runs.csv", "summary.csv")}
    return {name: record[name] for name in SAME_OF_STUDY} | tables


def executions_kept(folder: Path) -> dict[str, Any]:
    """The tables of executions, of which there is one and no half, and the run, as it was."""
    tables = {file.read_text() for file in folder.glob("executions/*/executions.csv")}
    return run_kept(folder) | {"executions.csv": sorted(tables)}


def prepared_run(folder: Path) -> Path:
    drake_screw("run", "pouring", *QUICK, "--output", str(folder / "run"), "--quiet")
    return folder / "run"


def study(folder: Path) -> tuple[str, ...]:
    changes = QUICK[:6]
    output = ("--output", str(folder))
    return ("study", "pouring", "--regions", "1,2", "--runs", "3", *changes, *output)


KINDS = {
    "run": Kind(
        prepare=lambda folder: folder,
        begin=lambda _, folder: ("run", "pouring", *QUICK, "--output", str(folder), "--quiet"),
        carry_on=lambda _, folder: ("run", "--resume", str(folder), "--quiet"),
        begun=lambda folder: (folder / "run.json").exists(),
        kept=run_kept,
    ),
    "study": Kind(
        prepare=lambda folder: folder,
        begin=lambda _, folder: study(folder),
        carry_on=lambda _, folder: ("study", "--resume", str(folder)),
        begun=lambda folder: (folder / "study.json").exists(),
        kept=study_kept,
    ),
    "execute": Kind(
        prepare=prepared_run,
        begin=lambda _, folder: ("execute", str(folder), "--per-region", "1"),
        carry_on=lambda _, folder: ("execute", str(folder), "--per-region", "1"),
        begun=lambda _: True,
        kept=executions_kept,
    ),
}


def drake_screw(*arguments: str) -> None:
    subprocess.run([*DRAKE_SCREW, *arguments], check=True, capture_output=True)


def trial(
    kind: Kind, prepared: Path, folder: Path, alone: dict[str, Any], seconds: Callable[[], float]
) -> Trial:
    """Kill one until it ends by itself.

    Args:
        prepared: what the kind prepared.
        folder: a fresh one; a copy of what was prepared if that is a run.
        alone: what was kept by the one left alone.
        seconds: when to kill the next time.

    Raises:
        Differs: with what it came to.
    """
    kills = early = 0
    while True:
        begun = kind.begun(folder)
        early += kills > 0 and not begun
        arguments = (kind.carry_on if begun else kind.begin)(prepared, folder)
        command = [*DRAKE_SCREW, *arguments]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as going:
            try:
                output, _ = going.communicate(timeout=seconds() if kills < MOST else None)
            except subprocess.TimeoutExpired:
                going.kill()
                kills += 1
                continue
        if going.returncode and ENDED not in output:  # killed when all had been written
            raise Differs(f"{' '.join(arguments)}: exit code {going.returncode}\n{output.decode()}")
        if (kept := kind.kept(folder)) != alone:
            names = [name for name in alone if kept.get(name) != alone[name]]
            raise Differs(f"{folder} after {kills} kills: {', '.join(names)} differ")
        return Trial(kills, early)


def kill_often(
    name: str, kills: int, folder: Path, rng: np.random.Generator, say: Callable[[str], None]
) -> list[Trial]:
    """Trials of a kind, in fresh folders under `folder`, until there were so many kills.

    Raises:
        Differs: from the first that did not end as the one that was left alone.
    """
    kind = KINDS[name]
    prepared = kind.prepare(folder)

    def fresh(path: Path) -> Path:
        if prepared != folder:
            shutil.copytree(prepared, path)
        return path

    warm = fresh(folder / "warm")
    drake_screw(*kind.begin(prepared, warm))  # compiles what is not in the cache
    alone = fresh(folder / "alone")
    began = time.monotonic()
    drake_screw(*kind.begin(prepared, alone))
    whole = time.monotonic() - began
    expected = kind.kept(alone)
    trials: list[Trial] = []
    while (so_far := sum(one.kills for one in trials)) < kills:
        killed = fresh(folder / f"killed_{len(trials)}")
        trials.append(
            trial(kind, prepared, killed, expected, lambda: rng.uniform(0.1, 1.0) * whole)
        )
        shutil.rmtree(killed)
        say(f"{name}: {so_far + trials[-1].kills} of {kills} kills, {len(trials)} ended the same")
    return trials


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    rng, result = np.random.default_rng(given.seed), {}
    with tempfile.TemporaryDirectory() as scratch:
        for name in given.kinds:
            folder = Path(scratch) / name
            folder.mkdir()
            each = -(-given.kills // len(given.kinds))
            trials = kill_often(name, each, folder, rng, lambda words: print(words, flush=True))
            result[name] = {
                "kills": sum(one.kills for one in trials),
                "before_anything_was_kept": sum(one.early for one in trials),
                "ended_the_same": len(trials),
            }
    for name, found in result.items():
        print(
            name, *(f"{key.replace('_', ' ')}: {value}" for key, value in found.items()), sep="\n  "
        )
    if given.json:
        given.json.write_text(json.dumps(result, indent=2) + "\n")


if __name__ == "__main__":
    main()
