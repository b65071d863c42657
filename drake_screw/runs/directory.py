"""What a run leaves on disk, and how it is read again."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import shutil
import zlib
from collections.abc import Callable, Iterator, Mapping
from datetime import datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any, Self
from zipfile import BadZipFile

import numpy as np

from drake_screw.acquisition import Evaluation, RoundFinished, Status
from drake_screw.bandits import Verdict
from drake_screw.demonstrations import Recording, write_recording
from drake_screw.errors import RunDirectoryError
from drake_screw.runs.evaluation_file import load_evaluation, save_evaluation
from drake_screw.runs.round_record import (
    ARRAYS,
    regions_csv,
    round_record,
    suggestion_record,
)
from drake_screw.tasks import Regions

FORMAT = 1
RUN, SCENARIO, LOG = "run.json", "scenario.yaml", "run.log"
_KINDS: dict[str, type | tuple[type, ...]] = {
    "scenario": str,
    "status": str,
    "seed": int,
    "rounds": list,
    "demonstrations": list,
    "hashes": dict,
    "versions": dict,
    "certificate": (dict, type(None)),
}
_REMEDY = "Restore it, or run the scenario again."


class RunDirectory:
    """One run's folder. Files appear whole or not at all: written aside, then renamed.

    Attributes:
        path: of the folder.
        record: contents of run.json.
    """

    def __init__(self, path: Path, record: dict[str, Any]) -> None:
        self.path = path
        self.record = record

    @classmethod
    def create(
        cls, path: Path | None, name: str, scenario_text: str, facts: Mapping[str, Any]
    ) -> Self:
        """Make a new run directory.

        Args:
            path: where; ``runs/<name>/<time>`` if None. It must not exist, or be empty.
            name: of the scenario.
            scenario_text: the resolved scenario.
            facts: what else run.json records.

        Raises:
            RunDirectoryError: the place is taken or cannot be written.
        """
        path = path or _fresh(Path("runs") / name)
        record = {
            "format": FORMAT,
            "scenario": name,
            "status": Status.RUNNING.value,
            "reason": None,
            **facts,
            "versions": {
                "python": platform.python_version(),
                **{p: version(p) for p in ("drake-screw", "drake", "numpy", "scipy", "numba")},
            },
            "started": datetime.now().astimezone().isoformat(timespec="seconds"),
            "finished": None,
            "certificate": None,
            "demonstrations": [],
            "rounds": [],
        }
        directory = cls(path, record)
        try:
            if path.exists() and (not path.is_dir() or any(path.iterdir())):
                raise RunDirectoryError(
                    "exists already; a run never overwrites anything",
                    remedy="Give another --output, or continue a run with --resume.",
                    file=path,
                )
            path.mkdir(parents=True, exist_ok=True)
            write_text(path / SCENARIO, scenario_text)
            directory.save()
        except OSError as error:
            raise RunDirectoryError(
                f"cannot be written: {error.strerror}",
                remedy="Choose a folder you may write to with --output.",
                file=path,
            ) from error
        return directory

    @classmethod
    def open(cls, path: Path) -> Self:
        """Open an existing run directory.

        Raises:
            RunDirectoryError: it is not one, is damaged, or is of another version.
        """
        file = path / RUN
        if not file.is_file():
            raise RunDirectoryError(
                f"not a run directory: it has no {RUN}",
                remedy="Give the folder that a run printed at its end.",
                file=path,
            )
        try:
            record = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise RunDirectoryError(f"damaged: {error}", remedy=_REMEDY, file=file) from error
        if not isinstance(record, dict) or not isinstance(record.get("format"), int):
            raise RunDirectoryError(
                "not what a run writes: it has no number of its format", remedy=_REMEDY, file=file
            )
        if record["format"] != FORMAT:
            writer = record.get("versions")
            version = writer.get("drake-screw") if isinstance(writer, dict) else None
            which = "" if version is None else f", drake-screw {version}"
            raise RunDirectoryError(
                f"written in format {record['format']}; this version reads format {FORMAT}",
                remedy=f"Use the version that wrote it{which}.",
                file=file,
            )
        for message in _oddities(record):
            raise RunDirectoryError(f"damaged: {message}", remedy=_REMEDY, file=file)
        return cls(path, record)

    def save(self, **changes: Any) -> None:
        """Change run.json."""
        self.record.update(changes)
        write_text(self.path / RUN, json.dumps(self.record, indent=2) + "\n")

    def add_demonstration(
        self, number: int, recording: Recording, remark: str, held: Mapping[str, float]
    ) -> Path:
        """Store a demonstration's recording; returns its folder."""
        folder = self.path / "demonstrations" / f"{number + 1:02d}_{recording.name}"

        def fill(temporary: Path) -> None:
            if recording.source is not None:
                shutil.copytree(recording.source, temporary, dirs_exist_ok=True)
            else:
                write_recording(recording, temporary, held)

        write_folder(folder, fill)
        entry = {
            "name": recording.name,
            "folder": str(folder.relative_to(self.path)),
            "source": None if recording.source is None else str(recording.source),
            "robot": recording.robot,
            "remark": remark,
            "notes": list(recording.notes),
        }
        self.save(demonstrations=[*self.record["demonstrations"], entry])
        return folder

    def add_round(
        self,
        event: RoundFinished,
        regions: Regions,
        draw: Callable[[RoundFinished, Path], None],
    ) -> None:
        """Store a round: its table of regions, its instances, its pictures, the suggestion."""
        verdict = event.verdict

        def fill(folder: Path) -> None:
            (folder / "regions.csv").write_text(regions_csv(verdict, regions))
            save_evaluation(folder / "instances.npz", event.evaluation)
            if event.suggestion is not None:
                text = json.dumps(suggestion_record(event.suggestion, regions), indent=2)
                (folder / "next_demonstration.json").write_text(text + "\n")
            draw(event, folder / "heat_map")

        write_folder(self.round_folder(event.round), fill)
        self.save(rounds=[*self.record["rounds"], round_record(event, regions)])

    def round_folder(self, round: int) -> Path:
        """Folder of a round; the first is round_01."""
        return self.path / f"round_{round + 1:02d}"

    def remembered_round(self, round: int) -> tuple[Evaluation, Verdict] | None:
        """What a round found, if it is stored.

        Raises:
            RunDirectoryError: its instances are missing, cut off, or of another round.
        """
        if round >= len(self.record["rounds"]):
            return None
        entry, file = self.record["rounds"][round], self.round_folder(round) / "instances.npz"
        try:
            evaluation = load_evaluation(file)
            fields = dict(entry["verdict"])
            for name in ARRAYS:
                fields[name] = np.array(fields[name])
            verdict = Verdict(**fields)
            N, D = evaluation.outcomes.shape
            if len(evaluation.x_y_yaw) != N or len(evaluation.region) != N:
                raise ValueError("its columns are not equally long")
            if entry["demonstrations"] != D:
                raise ValueError(f"it has outcomes of {D} demonstrations, not as run.json says")
        except FileNotFoundError as error:
            raise RunDirectoryError(
                f"round {round + 1} is damaged: the file is missing", remedy=_REMEDY, file=file
            ) from error
        except (
            OSError,
            EOFError,
            ValueError,
            KeyError,
            TypeError,
            BadZipFile,
            zlib.error,
        ) as error:
            words = f"no {error}" if isinstance(error, KeyError) else str(error).split(". ")[0]
            raise RunDirectoryError(
                f"round {round + 1} is damaged: {words}", remedy=_REMEDY, file=file
            ) from error
        return evaluation, verdict


def _oddities(record: Mapping[str, Any]) -> Iterator[str]:
    """What is not as `RunDirectory.create` and its changes leave it."""
    for name, kind in _KINDS.items():
        if name not in record:
            yield f"no '{name}'"
        elif not isinstance(record[name], kind):
            yield f"'{name}' is {record[name]!r}"[:80]
    if record.get("status") not in list(Status):
        yield f"no run has the status '{record.get('status')}'"
    for number, entry in enumerate(record.get("rounds", ()), start=1):
        if not isinstance(entry, dict):
            yield f"what it says of round {number} is {entry!r}"[:80]
    wanted = {"name", "folder", "remark", "notes"}
    for number, entry in enumerate(record.get("demonstrations", ()), start=1):
        if not isinstance(entry, dict) or not wanted <= entry.keys():
            yield f"what it says of demonstration {number} is incomplete"


def write_text(file: Path, text: str) -> None:
    """Write a file so that it is there whole or not at all."""
    temporary = file.with_name(f".{file.name}.part")
    temporary.write_text(text)
    os.replace(temporary, file)


def write_folder(folder: Path, fill: Callable[[Path], None]) -> None:
    """Write a folder so that it is there whole or not at all; a stale one is replaced."""
    temporary = folder.with_name(f".{folder.name}.part")
    shutil.rmtree(temporary, ignore_errors=True)
    temporary.mkdir(parents=True)
    fill(temporary)
    shutil.rmtree(folder, ignore_errors=True)
    os.replace(temporary, folder)


def file_hash(file: Path) -> str:
    """SHA-256 of a file's contents."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _fresh(parent: Path) -> Path:
    stamp = datetime.now().strftime("%Y-%m-%d_%H-%M-%S")
    path, count = parent / stamp, 1
    while path.exists():
        count += 1
        path = parent / f"{stamp}_{count}"
    return path
