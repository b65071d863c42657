"""Text tables: any, and those of ``rostopic echo -p``."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import numpy as np

from drake_screw.demonstrations.library import JOINTS
from drake_screw.errors import RecordingError, counted
from drake_screw.recordings.mapping import Mapping
from drake_screw.recordings.raw import Raw
from drake_screw.tables import Table, read_table
from drake_screw.tables.text import Progress

_ROSTOPIC = "%time"


def read_text(source: Path, mapping: Mapping, progress: Progress | None = None) -> tuple[Raw, ...]:
    """One recording from a text table of any kind.

    Raises:
        RecordingError: it is not one.
    """
    return (Raw(_name(source), _read(source, mapping, progress)),)


def read_rostopic(
    source: Path, mapping: Mapping, progress: Progress | None = None
) -> tuple[Raw, ...]:
    """One recording from what ``rostopic echo -p /joint_states`` printed.

    Names stand in cells there, beside the positions; they become the names of the columns. Rows
    with the names of another robot's joints, or of a gripper, are left out.

    Raises:
        RecordingError: it is no such table.
    """
    table = _read(source, mapping, progress)
    if _ROSTOPIC not in table.names:
        raise RecordingError(
            f"not from rostopic echo -p: there is no column '{_ROSTOPIC}'",
            remedy="Leave --format out, or say table.",
            file=source,
            line=table.header,
        )
    told = {"time": _ROSTOPIC, "time_unit": "ns"}
    found = re.compile(r"(?:field\.)?(.*?)name\[?(\d+)\]?$")
    cells = [(m, name) for name in table.names if (m := found.match(name))]
    positions = {name: f"{name[: m.end(1)]}position{name[m.end(1) + 4 :]}" for m, name in cells}
    pairs = [(name, column) for name, column in positions.items() if column in table.names]
    if not pairs:
        return (Raw(_name(source), table, told),)
    words = list(zip(*(table.columns[name].astype(str) for name, _ in pairs), strict=True))
    kinds = Counter(words)
    usual, _ = kinds.most_common(1)[0]
    rows = np.array([row == usual for row in words])
    notes: tuple[str, ...] = ()
    if len(kinds) > 1:
        others = counted(int(np.count_nonzero(~rows)), "row")
        notes = (f"left out {others} with the names of other joints",)
    kept = table.rows(rows)
    columns = {_ROSTOPIC: kept.numbers(_ROSTOPIC)}
    for joint, (_, column) in zip(usual, pairs, strict=True):
        columns[joint.strip()] = kept.numbers(column)
    return (Raw(_name(source), kept.renamed(columns), told, notes=notes),)


def is_rostopic(file: Path) -> bool:
    """Whether a text file looks like one of ``rostopic echo -p``."""
    try:
        with file.open("rb") as stream:
            return stream.read(64).lstrip(b'\xef\xbb\xbf"').startswith(b"%time,")
    except OSError:
        return False


def _read(source: Path, mapping: Mapping, progress: Progress | None) -> Table:
    return read_table(
        source,
        separator=mapping.separator,
        decimal=mapping.decimal,
        remedy="Give the file of a recording.",
        progress=progress,
    )


def _name(source: Path) -> str:
    """Like the file; of one called as all are in a library, like its folder."""
    return source.resolve().parent.name if source.name == JOINTS else source.stem
