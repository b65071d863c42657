"""Executions of the round in progress, kept on disk so that an interrupted run carries on there."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

from drake_screw.assembly.executing import Place
from drake_screw.errors import RunDirectoryError
from drake_screw.execution.parallel import Judged
from drake_screw.files import writing
from drake_screw.json_values import decode_json
from drake_screw.runs.directory import UNWRITABLE_RUN

FILE = "executed.jsonl"


class KeptExecutions:
    """A line of JSON for each execution, appended as soon as it is known.

    Instances of a round depend on their place in it alone, so a round that is begun again finds
    those that were executed before by where their objects are.

    Args:
        run: the run's folder; the file is gone once its round is finished.
    """

    def __init__(self, run: Path) -> None:
        self._file = run / FILE

    def known(self, round: int) -> dict[Place, Judged]:
        """Executions of a round, from 0, by their places.

        Raises:
            RunDirectoryError: the file is damaged; a last line that was cut off is dropped.
        """
        if not self._file.exists():
            return {}
        found: dict[Place, Judged] = {}
        text = self._file.read_bytes()
        whole, ended, cut_off = text.rpartition(b"\n")
        if cut_off:
            with writing(self._file, UNWRITABLE_RUN):
                self._file.write_bytes(whole + ended)
        for number, line in enumerate(whole.splitlines(), start=1):
            try:
                entry = decode_json(line)
                judged = Judged(**entry["judged"])
                if entry["round"] == round + 1:
                    found[tuple(entry["place"])] = judged
            except (ValueError, TypeError, KeyError) as error:
                raise RunDirectoryError(
                    "damaged: this line is no execution",
                    remedy="Delete the file to do the round's executions again.",
                    file=self._file,
                    line=number,
                ) from error
        return found

    def keep(self, round: int, place: Place, judged: Judged) -> None:
        """Append an execution of a round, from 0.

        Raises:
            RunDirectoryError: the file cannot be written.
        """
        entry = {"round": round + 1, "place": place, "judged": asdict(judged)}
        with writing(self._file, UNWRITABLE_RUN), self._file.open("a", encoding="utf-8") as file:
            file.write(json.dumps(entry) + "\n")

    def forget(self) -> None:
        """Delete the file: its round is finished."""
        with writing(self._file, UNWRITABLE_RUN):
            self._file.unlink(missing_ok=True)
