"""A run's folder, and what is put into it as the run goes on."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self, TextIO

from drake_screw.acquisition import RoundFinished
from drake_screw.demonstrations import Fidelity, Recording, write_recording
from drake_screw.demonstrations.library import is_recording
from drake_screw.errors import RunDirectoryError
from drake_screw.files import fresh_folder, make_folder, now, write_folder, write_text, writing
from drake_screw.runs.codec import json_text, read_run_record, save_evaluation
from drake_screw.runs.records import (
    DemonstrationRecord,
    RoundRecord,
    RunRecord,
    SuggestionRecord,
)
from drake_screw.runs.region_table import regions_csv

RUN, SCENARIO, LOG = "run.json", "scenario.yaml", "run.log"
INSTANCES, DEMONSTRATIONS = "instances.npz", "demonstrations"
PICTURE = "rounds.png"
"""The course of the whole run."""
UNWRITABLE_RUN = "Free some space or make the run's folder writable, then carry on with --resume."


@dataclass
class RunDirectory:
    """One run's folder. Files appear whole or not at all: written aside, then renamed.

    Whatever writes raises `RunDirectoryError` where the operating system refuses.

    Attributes:
        path: of the folder.
        record: contents of run.json.
    """

    path: Path
    record: RunRecord

    @classmethod
    def create(cls, path: Path | None, scenario_text: str, record: RunRecord) -> Self:
        """Make a new run directory.

        Args:
            path: where; ``runs/<scenario>/<time>`` if None. It must not exist, or be empty.
            scenario_text: the resolved scenario.
            record: what run.json is to hold.

        Raises:
            RunDirectoryError: the place is taken or cannot be written.
        """
        runs = Path("runs") / record.scenario
        with writing(path or runs, remedy="Choose a folder you may write to with --output."):
            path = fresh_folder(runs) if path is None else path
            make_folder(path, "run", {SCENARIO: scenario_text, RUN: json_text(record)})
        return cls(path, record)

    @classmethod
    def open(cls, path: Path) -> Self:
        """Open an existing run directory.

        Raises:
            RunDirectoryError: it is not one, is damaged, or is of another version.
        """
        if not (path / RUN).is_file():
            raise RunDirectoryError(
                f"not a run directory: it has no {RUN}",
                remedy="Give the folder that a run printed at its end. One that ended before it "
                "had begun can be given to --output again.",
                file=path,
            )
        return cls(path, read_run_record(path / RUN))

    def refresh(self) -> None:
        """Read run.json again.

        Raises:
            RunDirectoryError: as `open`.
        """
        self.record = self.open(self.path).record

    def save(self, **changes: Any) -> None:
        """Write run.json, with some entries changed."""
        self.record = replace(self.record, **changes)
        with writing(self.path / RUN, UNWRITABLE_RUN):
            write_text(self.path / RUN, json_text(self.record))

    def log(self, text: str) -> None:
        """Append lines to the log, each with the time."""
        stamp = now()
        file = self.path / LOG
        with writing(file, UNWRITABLE_RUN), _appending(file) as log:
            log.writelines(f"{stamp} {line}\n" for line in text.splitlines())

    def add_demonstration(
        self,
        number: int,
        recording: Recording,
        remark: str,
        held: Mapping[str, float],
        fidelity: Sequence[Fidelity] = (),
    ) -> Path:
        """Store a demonstration's recording, and how faithfully it is kept; returns its folder."""
        folder = self.path / DEMONSTRATIONS / f"{number + 1:02d}_{recording.name}"

        def fill(temporary: Path) -> None:
            source = None if recording.cut else recording.source
            if source is not None and is_recording(source):
                shutil.copytree(source, temporary, dirs_exist_ok=True)
            else:
                write_recording(recording, temporary, held)

        with writing(folder, UNWRITABLE_RUN):
            write_folder(folder, fill)
        entry = DemonstrationRecord.of(
            recording, str(folder.relative_to(self.path)), remark, fidelity
        )
        self.save(demonstrations=(*self.record.demonstrations, entry))
        return folder

    def add_round(self, event: RoundFinished, draw: Callable[[RoundFinished, Path], None]) -> None:
        """Store a round: its table of regions, its instances, its pictures, the suggestion."""

        def fill(folder: Path) -> None:
            table = regions_csv(event.verdict, event.regions)
            (folder / "regions.csv").write_text(table, encoding="utf-8")
            save_evaluation(folder / INSTANCES, event.evaluation)
            if event.suggestion is not None:
                wanted = SuggestionRecord.of(event.suggestion, event.regions)
                file = folder / "next_demonstration.json"
                file.write_text(json_text(wanted), encoding="utf-8")
            draw(event, folder / "heat_map")

        folder = self.round_folder(event.round)
        with writing(folder, UNWRITABLE_RUN):
            write_folder(folder, fill)
        self.save(rounds=(*self.record.rounds, RoundRecord.of(event)))

    def round_folder(self, round: int) -> Path:
        """Folder of a round; the first is round_01."""
        return self.path / f"round_{round + 1:02d}"


def _appending(file: Path) -> TextIO:
    return file.open("a", encoding="utf-8", errors="backslashreplace")
