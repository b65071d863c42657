"""A folder into which people drop recordings while a program waits for them."""

from __future__ import annotations

import time
from contextlib import ExitStack, suppress
from pathlib import Path

from drake_screw.demonstrations.library import JOINTS, OBJECTS
from drake_screw.errors import RecordingError
from drake_screw.holding import holding

PERIOD = 1.0
"""s. Between looks into the folder; a recording that changed since then is still growing."""
PATIENCE = 5.0
"""s. For so long a recording that lacks a file is waited for."""

_Files = tuple[tuple[str, int, int], ...]
"""Name, size in bytes and time of change in ns of each file of a recording."""


class Inbox:
    """Finds recordings that are dropped into a folder.

    What lies there already is not taken, unless it changes.

    Args:
        folder: watched.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._taken = dict(self._recordings())
        self._changed: dict[Path, tuple[_Files, float]] = {}
        self._looked = 0.0
        self._held = ExitStack()

    def open(self) -> None:
        """Make the folder, if there is none, and keep other processes from watching it, too.

        Raises:
            RecordingError: it cannot be made.
            RunDirectoryError: another process watches it.
        """
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise RecordingError(
                f"cannot be watched: {error.strerror}",
                remedy="Give another teacher.folder, one that can be made.",
                file=self.folder,
            ) from error
        self._held.enter_context(holding(self.folder, "watched folder"))

    def close(self) -> None:
        """Let other processes watch the folder."""
        self._held.close()

    def take(self) -> Path | None:
        """The folder of a recording that was dropped and has stopped growing; None if none has.

        It is given once, and again if it changes.
        """
        now = time.monotonic()
        if now - self._looked <= PERIOD:
            return None
        self._looked = now
        for folder, files in self._recordings():
            if self._changed.get(folder, ((), 0.0))[0] != files:
                self._changed[folder] = files, now
            patience = PERIOD if len(files) == 2 else PATIENCE
            if self._taken.get(folder) != files and now - self._changed[folder][1] > patience:
                self._taken[folder] = files
                return folder
        return None

    def _recordings(self) -> list[tuple[Path, _Files]]:
        """Recordings in the folder, and which files they have."""
        if not self.folder.is_dir():
            return []
        found = []
        for folder in sorted(self.folder.iterdir()):
            files = []
            for name in (JOINTS, OBJECTS):
                with suppress(OSError):
                    there = (folder / name).stat()
                    files.append((name, there.st_size, there.st_mtime_ns))
            if files:
                found.append((folder, tuple(files)))
        return found
