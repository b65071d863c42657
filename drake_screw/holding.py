"""Folders that one process at a time works in."""

from __future__ import annotations

import json
import logging
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from drake_screw.errors import RunDirectoryError
from drake_screw.file_locks import lock
from drake_screw.files import now, writing
from drake_screw.json_values import decode_json

LOCK = ".lock"

_log = logging.getLogger(__name__)


@contextmanager
def holding(folder: Path, what: str) -> Iterator[None]:
    """A context in which no other process holds a folder.

    It is the operating system that knows who does (flock), so that a process that is killed holds
    nothing any more. Who holds a folder stands in its file ``.lock`` meanwhile.

    Args:
        folder: an existing one.
        what: it is, a word such as "run".

    Raises:
        RunDirectoryError: another process holds it; it says which. Or the folder cannot be written.
    """
    file = folder / LOCK
    with writing(folder, f"Make the folder of this {what} writable."):
        descriptor = _locked(file, what)
    try:
        yield
    finally:
        with suppress(OSError):
            file.unlink(missing_ok=True)
        os.close(descriptor)


def _locked(file: Path, what: str) -> int:
    """A descriptor of the file, locked."""
    try:
        descriptor, is_locked = lock(file)
    except BlockingIOError:
        raise RunDirectoryError(
            f"another process is at work on this {what}: {_holder(file)}",
            remedy="Wait until it has ended, or end it.",
            file=file.parent,
        ) from None
    if is_locked:
        os.truncate(descriptor, 0)
        os.write(descriptor, json.dumps(_this_process()).encode())
    else:
        _log.warning(
            "%s: this file system has no locks; take care that no other process is at work on "
            "this %s",
            file.parent,
            what,
        )
    return descriptor


def _this_process() -> dict[str, str | int]:
    return {"process": os.getpid(), "host": socket.gethostname(), "since": now()}


def _holder(file: Path) -> str:
    try:
        known = decode_json(file.read_text())
        return f"process {known['process']} on {known['host']}, since {known['since']}"
    except (OSError, ValueError, KeyError, TypeError):
        return "it does not say which"
