"""Recordings from a file, or from a folder of files, of any format that is plugged in."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from shlex import quote

import numpy as np

from drake_screw.demonstrations.library import OBJECTS, is_recording
from drake_screw.errors import RecordingError
from drake_screw.plugins import choices, find, is_known
from drake_screw.recordings.mapping import FILE, Mapping, read_mapping
from drake_screw.recordings.raw import Raw
from drake_screw.recordings.text_formats import is_rostopic
from drake_screw.recordings.understanding import episodes_of, understand
from drake_screw.recordings.understood import Robot, Understood
from drake_screw.recordings.which_arm import moving_arm, said_of_choice
from drake_screw.tables.text import Progress
from drake_screw.typing import PathLike

SUFFIXES = {
    ".csv": "table",
    ".tsv": "table",
    ".txt": "table",
    ".dat": "table",
    ".log": "table",
    ".bag": "bag",
    ".db3": "bag",
    ".mcap": "bag",
    ".h5": "hdf5",
    ".hdf5": "hdf5",
}
"""Formats by the suffixes of files."""


NAMED = {".yaml": "trajectory", ".yml": "trajectory"}
"""Formats of files that are given themselves: among others in a folder they may be anything."""


FOLDERS = ("lerobot",)
"""Formats of folders."""


def read_recordings(
    source: PathLike,
    robot: Robot | Sequence[Robot],
    mapping: Mapping | None = None,
    *,
    objects_needed: bool = True,
    progress: Callable[[Path], Progress] | None = None,
) -> tuple[Understood, ...]:
    """All recordings of a source, each with how it was understood.

    Of several arms that may have been led, each file, or part of one that stands for itself, is of
    the one whose joints it has, and that moves most.

    Args:
        source: a file, or a folder of files that each hold one or more.
        robot: that they were made on; or one for each arm that may have been led.
        mapping: what is said of them, before what recording.yaml beside each says.
        objects_needed: whether it is an error if it is not said where an object was.
        progress: makes what is told how much of a file has been read.

    Raises:
        RecordingError: there is none, one cannot be told or cannot be true.
        PluginError: no such format.
    """
    source, mapping = Path(source), mapping or Mapping()
    robots = (robot,) if isinstance(robot, Robot) else tuple(robot)
    found: list[Understood] = []
    for file in _files(source, whole=mapping.format in FOLDERS):
        said = _beside(file, mapping)
        format = said.format or _format(file)
        if not is_known("sources", format):
            raise RecordingError(f"no format '{format}'", remedy=choices("sources", format))
        with np.errstate(over="ignore", invalid="ignore"):  # numbers beyond sense are refused later
            raws = list(find("sources", format)(file, said, progress(file) if progress else None))
            while raws:  # one at a time, so that a long one is let go of when it is understood
                found += _understood(raws.pop(0), said, robots, format, objects_needed)
    for name, count in Counter(each.name for each in found).items():
        if count > 1:
            raise RecordingError(
                f"{count} recordings are called '{name}'",
                remedy="Rename the files: a recording is called like its file.",
                file=source,
            )
    return tuple(found)


def _understood(
    raw: Raw, said: Mapping, robots: Sequence[Robot], format: str, objects_needed: bool
) -> list[Understood]:
    """The recordings in some columns, of the arm that they are of."""
    if len(robots) == 1:
        return _by_one(raw, said, robots[0], format, objects_needed)
    tried: list[list[Understood] | RecordingError] = []
    for robot in robots:
        try:
            tried.append(_by_one(raw, said, robot, format, objects_needed))
        except RecordingError as error:
            tried.append(error)
    travels = [
        one if isinstance(one, RecordingError) else max((u.travel for u in one), default=0.0)
        for one in tried
    ]
    names = [robot.name for robot in robots]
    found, note = tried[moving_arm(travels, names)], said_of_choice(travels, names)
    assert not isinstance(found, RecordingError)
    return found if note is None else [each.noting(note) for each in found]


def _by_one(
    raw: Raw, said: Mapping, robot: Robot, format: str, objects_needed: bool
) -> list[Understood]:
    """The recordings in some columns of one arm."""
    parts, found = list(episodes_of(raw, said, robot)), []
    del raw
    while parts:
        part = parts.pop(0)
        found.append(understand(part, said, robot, format=format, objects_needed=objects_needed))
    return found


def holds_files(source: Path) -> bool:
    """Whether a source is files from elsewhere, not a library: a file, or a folder of some."""
    if source.is_file():
        return True
    if not source.is_dir() or is_recording(source):
        return False
    items = list(source.iterdir())
    if any(item.is_dir() and is_recording(item) for item in items):
        return False
    return any(item.is_file() and item.suffix.lower() in SUFFIXES for item in items)


def _folder_format(source: Path) -> str | None:
    """The format of a folder that is one source."""
    if (source / "metadata.yaml").is_file():
        return "bag"
    return "lerobot" if (source / "meta" / "info.json").is_file() else None


def _files(source: Path, *, whole: bool = False) -> list[Path]:
    """Files of a source, or the folder itself if that is one source, or is to be taken `whole`."""
    if source.is_file():
        return [source]
    if not source.exists():
        raise RecordingError(
            "no such file or folder", remedy="Give a recording, or a folder of them.", file=source
        )
    if _folder_format(source) or whole:
        return [source]
    files = sorted(
        item
        for item in source.iterdir()
        if item.suffix.lower() in SUFFIXES and item.name[0] not in "._" and item.is_file()
        and item.name != OBJECTS
    )  # fmt: skip
    if not files and any(is_recording(item) for item in source.iterdir()):
        raise RecordingError(
            "these are recordings already; there is nothing to bring in",
            remedy=f"Look at them: drake-screw look {quote(str(source))}",
            file=source,
        )
    if not files:
        raise RecordingError(
            "no recordings here",
            remedy=f"Files of recordings end in {', '.join(SUFFIXES)}; give another one by its "
            "own name, with --format.",
            file=source,
        )
    return files


def _beside(file: Path, mapping: Mapping) -> Mapping:
    """What is said, and what the file beside the data says where nothing is."""
    beside = (file if file.is_dir() else file.parent) / FILE
    if not beside.is_file():
        return mapping
    other = read_mapping(beside)
    objects = {**other.objects, **mapping.objects}
    given = {name: getattr(mapping, name) for name in type(mapping).model_fields}
    return other.with_(**{**given, "objects": objects})


def _format(file: Path) -> str:
    known = {**SUFFIXES, **NAMED}
    format = _folder_format(file) if file.is_dir() else known.get(file.suffix.lower())
    if format is None:
        raise RecordingError(
            f"the format cannot be told by '{file.suffix}'",
            remedy="Say it with --format: table for text. Known by their suffix: "
            + ", ".join(known),
            file=file,
        )
    return "rostopic" if format == "table" and is_rostopic(file) else format
