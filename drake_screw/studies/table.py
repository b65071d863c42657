"""The table of a study's runs: one line of CSV for each, appended as it is finished."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path

from drake_screw.errors import RunDirectoryError
from drake_screw.files import csv_text
from drake_screw.studies.experiment import StudyRun
from drake_screw.studies.figures import Distribution

HEADER = tuple(field.name for field in fields(StudyRun))


def row(run: StudyRun) -> tuple[object, ...]:
    """A run as a row below `HEADER`."""
    return (*(getattr(run, name) for name in HEADER[:-1]), ";".join(run.names))


def read_runs(file: Path) -> tuple[StudyRun, ...]:
    """The runs in a table, without a last line that was not written to its end.

    Raises:
        RunDirectoryError: it is not a table of runs.
    """
    try:
        whole, newline, _ = file.read_text().rpartition("\n")
        header, *rows = csv.reader(io.StringIO(whole + newline))
        if tuple(header) != HEADER:
            raise ValueError("unknown columns")
        return tuple(_parsed(cells) for cells in rows)
    except (OSError, ValueError, csv.Error) as error:
        raise RunDirectoryError(
            f"damaged: {error}", remedy="Restore it, or begin the study again.", file=file
        ) from error


def summary_csv(summary: Mapping[int, Distribution]) -> str:
    """How many demonstrations runs needed: a row for each K and number of demonstrations."""
    rows: list[tuple[object, ...]] = [
        ("K", "demonstrations", "runs", "probability", "mean", "max", "not_certified")
    ]
    for K, found in summary.items():
        ends = f"{found.mean:.6g}", found.most, found.without
        rows += [
            (K, number, count, f"{count / found.runs:.6g}", *ends)
            for number, count in found.counts.items()
        ]
    return csv_text(rows)


def _parsed(cells: list[str]) -> StudyRun:
    K, run, seed, status, demonstrations, rounds, samples, names = cells
    return StudyRun(
        int(K),
        int(run),
        int(seed),
        status,
        int(demonstrations),
        int(rounds),
        int(samples),
        tuple(names.split(";")) if names else (),
    )
