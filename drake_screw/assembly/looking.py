"""Looking at a recording, or at a folder of them, as a scenario understands them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from shlex import quote

from drake_screw.assembly.recorder import FOLDER
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Look, Recording
from drake_screw.demonstrations.library import is_recording
from drake_screw.demonstrations.look_summary import LookSummary, summarized
from drake_screw.errors import RecordingError
from drake_screw.steps import Step, Tell, to_nobody
from drake_screw.typing import PathLike


@dataclass(frozen=True, eq=False)
class Looks:
    """What was looked at.

    Attributes:
        source: a recording, or a library.
        library: which of the two.
        setup: of the scenario.
        looks: one for each recording.
    """

    source: Path
    library: bool
    setup: Setup
    looks: tuple[Look, ...]

    @property
    def summary(self) -> LooksSummary:
        """The same in plain data."""
        scenario = self.setup.scenario
        return LooksSummary(
            str(self.source),
            self.library,
            scenario.name,
            scenario.segmentation.method,
            tuple(map(summarized, self.looks)),
        )


@dataclass(frozen=True)
class LooksSummary:
    """What was looked at in plain data: place, scenario, method of segmentation, recordings."""

    source: str
    library: bool
    scenario: str
    segmentation: str
    recordings: tuple[LookSummary, ...]


def look_at_path(setup: Setup, path: PathLike, tell: Tell = to_nobody) -> Looks:
    """Look at a recording, or at all in a folder.

    Of a format other than the usual one, a file is a recording and a folder a library.

    Args:
        setup: says how recordings are read, what objects there are, and how paths are cut.
        path: of the recording or library.
        tell: told how far it is.

    Raises:
        RecordingError: there is none, or one cannot be used.
    """
    path = Path(path)
    tell(Step(f"reading {path}"))
    recordings, library = _read(setup, path)
    looks = []
    for number, recording in enumerate(recordings):
        tell(Step("looking at recordings", number, len(recordings)))
        looks.append(setup.look(recording))
    return Looks(path, library, setup, tuple(looks))


def _read(setup: Setup, path: Path) -> tuple[tuple[Recording, ...], bool]:
    format = setup.scenario.teacher.format
    if not path.exists():
        raise RecordingError(
            "no such recording or library",
            remedy="Give the folder of a recording, or a folder of such folders.",
            file=path,
        )
    if format == FOLDER and path.is_file():
        raise RecordingError(
            "this is a file, and a recording is a folder",
            remedy=f"Give the folder it stands in: {path.resolve().parent}"
            if is_recording(path.parent)
            else f"Bring it in first: drake-screw import {quote(str(path))} --output recordings",
            file=path,
        )
    if path.is_file() or is_recording(path):
        return (setup.recorder.read(path, format),), False
    return setup.recordings(path), True
