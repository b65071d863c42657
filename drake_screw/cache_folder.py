"""Where what is worked out once is kept."""

from __future__ import annotations

import os
import shutil
import tempfile
from functools import lru_cache
from pathlib import Path

from drake_screw.errors import DrakeScrewError


def cache_folder() -> Path:
    """Where what is worked out once is kept: numba's cache folder if it has one, else the user's.

    Where neither can be written to, a temporary folder, which is a new one in every process.

    Raises:
        DrakeScrewError: not even that can be made.
    """
    user = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    for parent in (os.environ.get("NUMBA_CACHE_DIR") or user, user):
        if parent.startswith("~"):  # nobody's home is known
            continue
        folder = Path(parent) / "drake_screw"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                return folder
        except OSError:
            continue
    return _temporary()


def discard(path: Path) -> None:
    """Remove what is kept at a path, if anything is; a folder with all that is in it.

    Raises:
        OSError: it cannot be removed.
    """
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


@lru_cache
def _temporary() -> Path:
    try:
        return Path(tempfile.mkdtemp(prefix="drake_screw_"))
    except OSError as error:
        raise DrakeScrewError(
            f"there is no folder to keep anything in for a while: {error.strerror or error}",
            remedy="Set XDG_CACHE_HOME or TMPDIR to a folder that you may write to.",
        ) from error
