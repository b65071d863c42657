"""Recordings brought into a library, in the project's own format."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Recording, write_recording
from drake_screw.errors import RecordingError
from drake_screw.files import WRITABLE_OUTPUT, write_folder, writing
from drake_screw.recordings import Mapping, Understood
from drake_screw.recordings import read_recordings as read
from drake_screw.steps import Step, Tell, to_nobody
from drake_screw.tables.text import Progress
from drake_screw.typing import PathLike

IMPORTED = "imported.yaml"
"""In the folder of a recording: how the file that it comes from was read."""


def read_recordings(
    source: PathLike,
    setup: Setup,
    mapping: Mapping | None = None,
    *,
    objects_needed: bool = True,
    progress: Callable[[Path], Progress] | None = None,
) -> tuple[Understood, ...]:
    """Recordings of a source, as a scenario understands them; see `recordings.read_recordings`."""
    return read(
        source,
        setup.recorder.understood_with,
        mapping,
        objects_needed=objects_needed,
        progress=progress,
    )


def write_library(
    found: Sequence[Understood], library: PathLike, tell: Tell = to_nobody
) -> tuple[Path, ...]:
    """Write recordings into a library, each a folder, with the mapping that it was read by.

    Args:
        found: recordings, all with objects.
        library: made if missing; recordings that it has stay.
        tell: told how far it is.

    Returns:
        Their folders.

    Raises:
        RecordingError: one of that name is there, or it cannot be written.
    """
    library = Path(library)
    folders = tuple(library / each.name for each in found)
    for folder in folders:
        if folder.exists():
            raise RecordingError(
                "exists already; nothing is overwritten",
                remedy="Give another --output, or rename the file: a recording is called like it.",
                file=folder,
            )
    with writing(library, WRITABLE_OUTPUT, RecordingError):
        library.mkdir(parents=True, exist_ok=True)
        for number, (each, folder) in enumerate(zip(found, folders, strict=True)):
            tell(Step("writing recordings", number, len(found)))
            recording = each.recording
            assert recording is not None
            write_folder(folder, partial(_fill, recording, each.mapping.text()))
    return folders


def _fill(recording: Recording, text: str, folder: Path) -> None:
    write_recording(recording, folder)
    said = f"# {recording.source} was read as\n{text}"
    (folder / IMPORTED).write_text(said, encoding="utf-8")
