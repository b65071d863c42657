"""Files in the cache folder that are made once, and looked through before they are used again.

A file that was cut off, or that somebody changed, would end in a model that cannot be read, at
every start. It is removed instead, made anew, and that is told in a line.
"""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Callable
from pathlib import Path

from drake_screw.cache_folder import cache_folder, discard
from drake_screw.files import write_text
from drake_screw.said_once import warn_once

_SEAL = "# sha256 "

_log = logging.getLogger(__name__)


def kept_folder(*names: str) -> Path:
    """A folder in the cache folder, made if it is not there; a file in its place is removed.

    Raises:
        OSError: it cannot be made.
    """
    folder = cache_folder()
    for name in names:
        folder = folder / name
        if not folder.is_dir():
            discard(folder)
            folder.mkdir(exist_ok=True)
    return folder


def holds(file: Path, text: str) -> bool:
    """Whether a file that was kept holds this text; one that holds another is removed."""
    return _is(file, lambda data: data == text.encode())


def keep(file: Path, text: str) -> None:
    """Write a file to be kept, where other processes may be doing the same.

    Raises:
        OSError: it cannot be written.
    """
    write_text(file, text, shared=True)


def keep_sealed(file: Path, text: str) -> None:
    """As `keep`, of lines in which # begins a remark: the last one says what the others hold.

    Raises:
        OSError: it cannot be written.
    """
    keep(file, f"{text}{_SEAL}{hashlib.sha256(text.encode()).hexdigest()}\n")


def is_whole(file: Path) -> bool:
    """Whether a file is there as `keep_sealed` wrote it; one that is not whole is removed."""
    return _is(file, _sealed)


def _sealed(data: bytes) -> bool:
    text, _, seal = data.rpartition(_SEAL.encode())
    return hashlib.sha256(text).hexdigest().encode() + b"\n" == seal


def _is(file: Path, right: Callable[[bytes], bool]) -> bool:
    try:
        if right(file.read_bytes()):
            return True
    except FileNotFoundError:
        return False
    except IsADirectoryError:
        pass
    warn_once(_log, f"{file}: it is damaged, and made again")
    discard(file)
    return False
