"""Files that other libraries read: whatever they raise over a damaged one becomes a message."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from drake_screw.errors import DrakeScrewError, RecordingError


@contextmanager
def read_by_others(source: Path, what: str, remedy: str | None = None) -> Iterator[None]:
    """A context in which another library reads a file.

    Args:
        source: the file or folder.
        what: it should be, as in "a bag".
        remedy: what is said beside.

    Raises:
        RecordingError: the library raised anything, of which there is no list: of a damaged file
            it may find a length of 10^18 (MemoryError), a name that is no text, a missing key.
    """
    try:
        yield
    except DrakeScrewError:
        raise
    except Exception as error:
        why = str(error) or "it is damaged, or larger than this machine's memory"
        raise RecordingError(
            f"cannot be read as {what}: {why}", remedy=remedy, file=source
        ) from error
