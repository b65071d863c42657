"""Recordings, and the arm they were made on: the scenario's own, or that of another robot.

Guiding poses belong to the object, so the arm that shows and the arm that does it may differ. What
they must share is the end effector's frame: where on the tool it sits, and how it is turned.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Self, TypeVar

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_screw.assembly.other_columns import with_hint
from drake_screw.demonstrations import (
    Demonstration,
    FaithfulConfig,
    Look,
    Recording,
    SegmentationConfig,
    look_at,
    read_library,
)
from drake_screw.demonstrations.demonstration import demonstration_of
from drake_screw.demonstrations.hand_eye import check_objects
from drake_screw.demonstrations.library import OBJECTS
from drake_screw.demonstrations.shown import Shown, what_is_shown
from drake_screw.errors import ModelError, RecordingError
from drake_screw.plugins import find
from drake_screw.recordings import Robot, read_recordings
from drake_screw.recordings.reading import holds_files
from drake_screw.robot import Arm, RobotConfig
from drake_screw.robot.model_file import ModelFile
from drake_screw.robot.parts import add_robot
from drake_screw.scenario.robot_blocks import RecordedOnBlock
from drake_screw.tasks import WorkArea
from drake_screw.typing import Array

FOLDER = "folder"
"""The usual format of a recording."""

UNSTATED = 10.0
"""rad/s or m/s, faster than which no joint moves, where its model does not say."""

_T = TypeVar("_T")


@dataclass(frozen=True)
class Learning:
    """How recordings become demonstrations.

    Attributes:
        segmentation: how paths are cut into screws.
        task_objects: names of the objects that the end effector works on; found by distance where
            empty.
    """

    segmentation: SegmentationConfig | FaithfulConfig
    task_objects: tuple[str, ...] = ()


@dataclass(frozen=True)
class Recorder:
    """Reads the recordings of one arm, and learns from them.

    Attributes:
        arm: that was led.
        own: that is planned for; may be the same.
        area: where the objects may stand for it.
        robot: model of the robot that was led; None where `arm` is `own`.
        model: that was read of it; None likewise.
        base: name of the frame that object poses are seen from.
        name: of the arm, where several may be led.
    """

    arm: Arm
    own: Arm
    area: WorkArea
    robot: str | None = None
    model: ModelFile | None = None
    base: str = "robot.base"
    name: str = ""

    @property
    def model_file(self) -> Path | None:
        """That model's file."""
        return None if self.model is None else self.model.file

    @classmethod
    def of_another(cls, block: RecordedOnBlock, own: Arm, area: WorkArea) -> Self:
        """The recorder that a scenario describes under `recorded_on`.

        Raises:
            ModelError: its model cannot be read, or lacks a name.
        """
        config = RobotConfig(
            str(block.model),
            block.joints,
            block.end_effector,
            (0.0,) * len(block.joints),
            block.base,
            block.parked,
            end_effector_rotation=block.end_effector_rotation,
            packages=block.packages,
            xacro=block.xacro,
        )
        plant = MultibodyPlant(0.0)
        try:
            added = add_robot(Parser(plant), config)
            plant.Finalize()
            arm = added.arm()
        except ModelError as error:
            raise ModelError(
                f"recorded_on: {error.message}", remedy=error.remedy, file=error.file
            ) from error
        return cls(arm, own, area, str(block.model), added.model, str(block.base))

    def read(self, path: Path, format: str = FOLDER) -> Recording:
        """One recording, in a format that `plugins.find` knows.

        Raises:
            RecordingError: with file and line, whatever is wrong.
            PluginError: no such format.
        """
        reader = find("recording_formats", format)
        if format == FOLDER:
            reader = partial(reader, velocity_limits=self.velocity_limits)
        return self._sane(self._try(lambda *arm: reader(path, *arm, objects=self._k)))

    def library(self, folder: Path, format: str = FOLDER) -> tuple[Recording, ...]:
        """All recordings in a folder, sorted by name.

        Files from elsewhere are read as `drake-screw import` reads them, if recording.yaml beside
        them says what they do not. Of a format other than the usual one every file and folder in it
        is a recording, except those whose name begins with a dot.

        Raises:
            RecordingError: there is none in it, or one cannot be used.
            PluginError: no such format.
        """
        if format == FOLDER and holds_files(folder):
            return tuple(
                replace(each.recording, robot=self.robot)
                for each in read_recordings(folder, self.understood_with)
                if each.recording is not None
            )
        if format == FOLDER:
            found = self._try(
                lambda *arm: read_library(
                    folder, *arm, objects=self._k, velocity_limits=self.velocity_limits
                )
            )
            return tuple(self._sane(recording) for recording in found)
        paths = sorted(p for p in folder.glob("*") if not p.name.startswith("."))
        if not paths:
            raise RecordingError(
                "no recordings here", remedy="Give a folder of recordings.", file=folder
            )
        return tuple(self.read(path, format) for path in paths)

    def seen(self, recording: Recording) -> Array:
        """Where the objects of a recording were, for the arm that is planned for; X_WO (k, 4, 4).

        The worlds of two robots are taken to have the directions of their axes in common, and that
        objects stand on something.
        So a place is where it was *seen from the shoulder*, at the height that the first object has
        now, if that is fixed: from there an arm of like build is led to it in a like manner.
        """
        return recording.X_WO if self.robot is None else self._shift(recording) @ recording.X_WO

    def learn(self, recording: Recording, learning: Learning) -> Demonstration:
        """The recording's demonstration, its poses in the world as `seen`.

        Raises:
            NoMotionKept: of the recording, as `demonstration_from_recording` says.
            RecordingError: it names an object that there is not.
        """
        learned = demonstration_of(self._shown(recording, learning))
        return learned if self.robot is None else _moved(learned, self._shift(recording))

    def look(self, recording: Recording, learning: Learning) -> Look:
        """What the recording holds, its poses in the world as `seen`.

        Raises:
            RecordingError: it names an object that there is not.
        """
        look = look_at(self._shown(recording, learning), self.arm)
        if self.robot is None:
            return look
        X = self._shift(recording)
        found = None if look.demonstration is None else _moved(look.demonstration, X)
        return replace(look, X_WE=X @ look.X_WE, X_WO=X @ look.X_WO, demonstration=found)

    def _shown(self, recording: Recording, learning: Learning) -> Shown:
        return what_is_shown(
            recording,
            self.arm,
            learning.segmentation,
            names=[item.name for item in self.area.objects],
            task_objects=learning.task_objects,
        )

    @property
    def _k(self) -> int:
        return len(self.area.objects)

    def _shift(self, recording: Recording) -> Array:
        X, first = np.eye(4), self.area.objects[0]
        X[:3, 3] = self.own.screw_chain().shoulder - self.arm.screw_chain().shoulder
        if first.height is not None:
            X[2, 3] = first.height - recording.X_WO[0, 2, 3]
        return X

    @property
    def understood_with(self) -> Robot:
        """What recordings in files from elsewhere are understood with."""
        return Robot(self.arm, self.area, self.base, self.velocity_limits, self.name)

    @property
    def velocity_limits(self) -> Array:
        """(n,) rad/s or m/s, of the arm that was led; wide where its model states none."""
        assumed = np.isin(self.arm.joint_names, self.arm.assumed_velocities)
        return np.where(assumed, UNSTATED, self.arm.velocity_limits)

    def _sane(self, recording: Recording) -> Recording:
        """The recording with the robot it is of, and with a note on doubtful object poses.

        Raises:
            RecordingError: an object cannot have stood where it says.
        """
        file = recording.source
        if file is not None and (file / OBJECTS).is_file():
            file = file / OBJECTS
        names = [item.name for item in self.area.objects]
        notes = check_objects(recording, self.arm, names, self.base, file=file)
        return replace(recording, robot=self.robot, notes=(*recording.notes, *notes))

    def _try(self, read: Callable[..., _T]) -> _T:
        """Read; where another arm's columns are found, say what the scenario should say."""
        try:
            return read(self.arm.joint_names, self.arm.lower, self.arm.upper)
        except RecordingError as error:
            own, foreign = self.own.joint_names, self.robot is not None
            better = with_hint(error, self.arm.joint_names, own, foreign=foreign)
            if better is error:
                raise
            raise better from error


def _moved(learned: Demonstration, X: Array) -> Demonstration:
    """A demonstration seen from another place; X (4, 4)."""
    return replace(learned, X_WO=X @ learned.X_WO, path=X @ learned.path)
