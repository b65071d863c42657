"""Files that one process at a time has; it is the operating system that knows which (flock)."""

from __future__ import annotations

import errno
import fcntl
import os
from pathlib import Path

_NO_LOCKS = (errno.ENOLCK, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS)


def lock(file: Path) -> tuple[int, bool]:
    """A descriptor of a file, which is made if need be, and whether it is locked.

    Not locked: the file system has no locks. A lock ends when the descriptor is closed, or with
    the process, however that ends.

    Raises:
        BlockingIOError: another has it.
        OSError: it cannot be opened.
    """
    while True:
        descriptor = os.open(file, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno in _NO_LOCKS:
                return descriptor, False
            os.close(descriptor)
            raise
        if _is_at(descriptor, file):
            return descriptor, True
        os.close(descriptor)  # whoever had it last has removed it meanwhile


def _is_at(descriptor: int, file: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), file.stat())
    except FileNotFoundError:
        return False
