"""Recordings of a robot with several arms: each is of the arm whose joints it names."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from drake_screw.assembly.recorder import FOLDER, Learning, Recorder
from drake_screw.demonstrations import Demonstration, Look, Recording
from drake_screw.demonstrations.library import is_recording
from drake_screw.errors import RecordingError
from drake_screw.recordings import Robot, read_recordings
from drake_screw.recordings.reading import holds_files
from drake_screw.recordings.which_arm import moving_arm, said_of_choice, travel
from drake_screw.tasks import WorkArea
from drake_screw.typing import Array


@dataclass(frozen=True)
class ArmsRecorder:
    """Reads the recordings of any of several arms, and learns from them, as `Recorder` does.

    Guiding poses belong to the objects, so that any arm can follow what another has shown, if their
    end effectors hold the tool alike. A recording that names the joints of several arms is of the
    one that moves most; its notes say so.

    Attributes:
        each: the recorders of the arms.
        robot, model, model_file: None, as of a `Recorder` of the arm that is planned for.
    """

    each: tuple[Recorder, ...]
    robot: None = None
    model: None = None
    model_file: None = None

    @property
    def area(self) -> WorkArea:
        """Where the objects may stand."""
        return self.each[0].area

    @property
    def understood_with(self) -> tuple[Robot, ...]:
        """What recordings in files from elsewhere are understood with, for each arm."""
        return tuple(recorder.understood_with for recorder in self.each)

    def of(self, recording: Recording) -> Recorder:
        """That of the arm whose joints a recording has; the first where it has none."""
        own = [r for r in self.each if r.arm.joint_names == recording.joint_names]
        return own[0] if own else self.each[0]

    def read(self, path: Path, format: str = FOLDER) -> Recording:
        """One recording; see `Recorder.read`."""
        found: list[Recording | RecordingError] = []
        for recorder in self.each:
            try:
                found.append(recorder.read(path, format))
            except RecordingError as error:
                found.append(error)
        travels = [one if isinstance(one, RecordingError) else travel(one.q) for one in found]
        names = [recorder.name for recorder in self.each]
        chosen, note = found[moving_arm(travels, names)], said_of_choice(travels, names)
        assert isinstance(chosen, Recording)
        return chosen if note is None else replace(chosen, notes=(*chosen.notes, note))

    def library(self, folder: Path, format: str = FOLDER) -> tuple[Recording, ...]:
        """All recordings in a folder; see `Recorder.library`."""
        if format == FOLDER and holds_files(folder):
            found = read_recordings(folder, self.understood_with)
            return tuple(each.recording for each in found if each.recording is not None)
        paths = []
        if folder.is_dir() and not (format == FOLDER and is_recording(folder)):
            items = sorted(folder.iterdir())
            usual = format == FOLDER
            paths = [p for p in items if (is_recording(p) if usual else p.name[0] != ".")]
        if not paths:
            return self.each[0].library(folder, format)
        return tuple(self.read(path, format) for path in paths)

    def seen(self, recording: Recording) -> Array:
        """Where the objects of a recording were; see `Recorder.seen`."""
        return self.of(recording).seen(recording)

    def learn(self, recording: Recording, learning: Learning) -> Demonstration:
        """The recording's demonstration; see `Recorder.learn`."""
        return self.of(recording).learn(recording, learning)

    def look(self, recording: Recording, learning: Learning) -> Look:
        """What the recording holds; see `Recorder.look`."""
        return self.of(recording).look(recording, learning)


AnyRecorder = Recorder | ArmsRecorder
"""Of the only arm, or of several."""
