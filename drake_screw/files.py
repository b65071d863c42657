"""Files and folders that appear whole or not at all."""

from __future__ import annotations

import csv
import errno
import hashlib
import io
import os
import shutil
from collections.abc import Callable, Iterable, Sequence
from datetime import datetime
from pathlib import Path


def write_text(file: Path, text: str) -> None:
    """Write a file, UTF-8, so that it is there whole or not at all.

    Raises:
        OSError: it cannot be written.
    """
    write_bytes(file, text.encode())


def write_bytes(file: Path, content: bytes) -> None:
    """Write a file so that it is there whole or not at all.

    Raises:
        OSError: it cannot be written.
    """
    if file.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(file))
    temporary = file.with_name(f".{file.name}.part")
    try:
        temporary.write_bytes(content)
        os.replace(temporary, file)
    except OSError:
        temporary.unlink(missing_ok=True)
        raise


def write_folder(folder: Path, fill: Callable[[Path], None]) -> None:
    """Write a folder so that it is there whole or not at all; a stale one is replaced.

    Args:
        folder: to appear.
        fill: writes its contents into the folder that it is given.

    Raises:
        OSError: it cannot be written.
    """
    temporary = folder.with_name(f".{folder.name}.part")
    shutil.rmtree(temporary, ignore_errors=True)
    temporary.mkdir(parents=True)
    fill(temporary)
    shutil.rmtree(folder, ignore_errors=True)
    os.replace(temporary, folder)


def fresh_folder(parent: Path) -> Path:
    """The path of a folder that does not exist yet, named after the time: ``parent/<time>``."""
    stamp = datetime.now().strftime("%Y-%m-%d_%H-%M-%S")
    path, count = parent / stamp, 1
    while path.exists():
        count += 1
        path = parent / f"{stamp}_{count}"
    return path


def file_hash(file: Path) -> str:
    """SHA-256 of a file's contents."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def csv_text(rows: Iterable[Sequence[object]]) -> str:
    """Rows as lines of CSV; what holds a comma or a quotation mark is quoted.

    >>> print(csv_text([("x", "demo, second try"), (0.5, "0:0")]), end="")
    x,"demo, second try"
    0.5,0:0
    """
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()
