"""Folders that one process at a time works in."""

from __future__ import annotations

import errno
import fcntl
import json
import logging
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from drake_screw.errors import RunDirectoryError
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
        lock = _locked(file, what)
    try:
        yield
    finally:
        with suppress(OSError):
            file.unlink(missing_ok=True)
        os.close(lock)


def _locked(file: Path, what: str) -> int:
    """A descriptor of the file, locked; whoever had it last may have removed it meanwhile."""
    while True:
        lock = os.open(file, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_at(lock, file):
                os.truncate(lock, 0)
                os.write(lock, json.dumps(_this_process()).encode())
                return lock
        except BlockingIOError:
            os.close(lock)
            raise RunDirectoryError(
                f"another process is at work on this {what}: {_holder(file)}",
                remedy="Wait until it has ended, or end it.",
                file=file.parent,
            ) from None
        except OSError as error:
            if error.errno not in _NO_LOCKS:
                os.close(lock)
                raise
            _log.warning(
                "%s: this file system has no locks; take care that no other process is at work on "
                "this %s",
                file.parent,
                what,
            )
            return lock
        os.close(lock)


_NO_LOCKS = (errno.ENOLCK, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS)


def _is_at(lock: int, file: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(lock), file.stat())
    except FileNotFoundError:
        return False


def _this_process() -> dict[str, str | int]:
    return {"process": os.getpid(), "host": socket.gethostname(), "since": now()}


def _holder(file: Path) -> str:
    try:
        known = decode_json(file.read_text())
        return f"process {known['process']} on {known['host']}, since {known['since']}"
    except (OSError, ValueError, KeyError, TypeError):
        return "it does not say which"
