"""``recording.yaml``: what the columns of a file mean, in a few lines beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import yaml
from pydantic import Field, ValidationError

from drake_screw.errors import RecordingError, ScenarioError, suggestion
from drake_screw.scenario.block import Block
from drake_screw.scenario.meanings import meanings
from drake_screw.scenario.yaml_marks import Dumper, Place, locate, parse, plain

FILE = "recording.yaml"
"""Its usual name."""

Number = Annotated[float, Field(strict=False)]
Place_ = str | tuple[Number, ...] | tuple[tuple[Number, ...], ...]


class Mapping(Block):
    """What the columns of a file mean. What is left out is told from the file, if it can be."""

    format: str | None = None
    """of the file: table, rostopic or another that is plugged in"""
    topic: str | None = None
    """of a bag, with the joint states or the hand's poses"""
    separator: Annotated[str, Field(min_length=1, max_length=1)] | None = None
    """between cells"""
    decimal: Literal[".", ","] | None = None
    """decimal point or comma"""
    time: str | tuple[str, str] | None = None
    """the column of time, or those of whole seconds and of nanoseconds"""
    time_unit: Literal["s", "ms", "us", "ns", "frames", "iso"] | None = None
    """of that column"""
    rate: Annotated[float, Field(gt=0, strict=False)] | None = None
    """Hz, of samples without a time, or of frames"""
    joints: tuple[str, ...] | dict[str, str] | None = None
    """columns in the order of the arm's joints, or a column for each joint's name"""
    angles: Literal["rad", "deg", "percent"] | None = None
    """unit of joint angles; percent of each joint's range, -100 to 100"""
    ends: dict[str, tuple[Number, Number]] = Field(default={})
    """rad or m, where a joint is at -100 and at 100 per cent: at its limits if left out"""
    hand: tuple[str, ...] | None = None
    """columns of the end effector's pose, if there are no joints: x, y, z and a quaternion"""
    quaternion: Literal["xyzw", "wxyz"] | None = None
    """order of the quaternion's columns"""
    lengths: Literal["m", "cm", "mm"] | None = None
    """unit of hand positions and of joints that slide"""
    episodes: Annotated[str, Field(min_length=1)] | None = None
    """what cuts a file into recordings: pauses, a bag's topic, or a column"""
    pause: Annotated[float, Field(gt=0, strict=False)] | None = None
    """s, the least length of a pause that cuts; 2 if it is not said"""
    still: Annotated[float, Field(gt=0, strict=False)] | None = None
    """rad or m, by which the arm may move in a pause; 0.01 if it is not said"""
    base_frame: str | None = None
    """what a bag calls the frame of the robot's base"""
    objects: dict[str, Place_] = Field(default={})
    """where each object was: [x, y], [x, y, yaw], a 4 x 4 matrix, or a text as --object takes"""

    def with_told(self, told: dict[str, Any]) -> Mapping:
        """With what a format states itself, where this says nothing."""
        return self.model_copy(
            update={name: value for name, value in told.items() if getattr(self, name) is None}
        )

    def with_(self, **changes: Any) -> Mapping:
        """With other values; None changes nothing."""
        return self.model_copy(update={k: v for k, v in changes.items() if v is not None})

    def text(self) -> str:
        """As YAML, what is said only."""
        data = self.model_dump(mode="json", exclude_none=True, exclude_defaults=True)
        return yaml.dump(
            data, Dumper=Dumper, default_flow_style=None, sort_keys=False, allow_unicode=True
        )


def read_mapping(file: Path) -> Mapping:
    """A mapping from its file.

    Raises:
        RecordingError: it is missing, not YAML, or has keys or values that mean nothing.
    """
    try:
        text = file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(f"cannot be read: {error}", file=file) from error
    try:
        tree = parse(text, Place(file))
    except ScenarioError as error:
        raise RecordingError(
            error.message, remedy=error.remedy, file=error.file, line=error.line
        ) from error
    if tree is None:
        return Mapping()
    try:
        return Mapping.model_validate(plain(tree))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        keys = tuple(first["loc"])
        place = locate(tree, keys)
        name = str(keys[0]) if keys else ""
        if first["type"] == "extra_forbidden":
            message = f"{name}: unknown key"
            remedy: str | None = suggestion(name, list(Mapping.model_fields), "Keys")
        else:
            meaning = meanings(Mapping).get(name)
            message = f"{name or 'the file'}: {first['msg'].lower()}"
            remedy = None if meaning is None else f"Meaning: {meaning}."
        raise RecordingError(message, remedy=remedy, file=file, line=place.line) from None
