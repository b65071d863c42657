"""Files that users name for results, looked at before the work is done."""

from __future__ import annotations

import os
from pathlib import Path

from drake_screw.errors import DrakeScrewError
from drake_screw.files import NO_FILE

_RECORDS = {
    "run.json": ("run.json", "scenario.yaml"),
    "study.json": ("study.json", "scenario.yaml", "runs.csv"),
}
"""What a run or a study is known by, and the files in its folder that cannot be made again."""


def writable(option: str) -> str:
    """What to do about a file that an option names and that cannot be written."""
    return f"Give {option} a file in a folder that exists and that you may write to."


def check_writable(file: Path, remedy: str, kind: type[DrakeScrewError] = DrakeScrewError) -> None:
    """Refuse a file for a result that cannot be written, before the work is done.

    Args:
        file: that a user has named.
        remedy: what the user can do about it.
        kind: of the error.

    Raises:
        DrakeScrewError: there cannot be such a file, or a run or a study could not do without
            what is there.
    """
    real = Path(os.path.realpath(file))
    needed = {
        name for mark, names in _RECORDS.items() if (real.parent / mark).exists() for name in names
    }
    if real.is_dir():
        why = "it is a folder"
    elif real.exists() and not real.is_file():
        why = NO_FILE
    elif real.name in needed and real.exists():
        why = "a run or a study keeps there what it is"
    elif not real.parent.is_dir():
        lacking = real.parent if file.parent.is_dir() else file.parent
        why = f"there is no folder '{lacking}'"
    elif not os.access(real.parent, os.W_OK):
        why = "its folder is read-only"
    else:
        return
    raise kind(f"cannot be written: {why}", remedy=remedy, file=file)
