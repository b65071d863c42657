"""Types of the values in a scenario file."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, GetCoreSchemaHandler, WithJsonSchema
from pydantic_core import CoreSchema, core_schema

from drake_screw.errors import suggestion
from drake_screw.plugins import BUILT_IN, REFERENCE, Group, choices, is_known
from drake_screw.resources import MODEL_SUFFIXES, looks_like_path
from drake_screw.scenario.block import refusal
from drake_screw.scenario.yaml_marks import Text

METRES = Field(json_schema_extra={"unit": "m"})
RADIANS = Field(json_schema_extra={"unit": "rad"})

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

NAME_PATTERN = "^[A-Za-z0-9_-]+$"

NamedState = Annotated[str, Field(min_length=1, title="a state's name")]


@dataclass(frozen=True)
class Interval:
    """A range of numbers, written ``[lower, upper]``, or one number where both are the same."""

    lower: float
    upper: float

    @property
    def ends(self) -> tuple[float, float]:
        return self.lower, self.upper

    @property
    def fixed(self) -> bool:
        return self.lower == self.upper

    def written(self) -> float | tuple[float, float]:
        """As in a file."""
        return self.lower if self.fixed else (self.lower, self.upper)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        ends = handler.generate_schema(tuple[float, float])
        return core_schema.no_info_before_validator_function(
            cls._ends,
            core_schema.no_info_after_validator_function(cls._between, ends),
            serialization=core_schema.plain_serializer_function_ser_schema(cls.written),
        )

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: Any) -> dict[str, Any]:
        number = {"type": "number"}
        ends = {"type": "array", "items": number, "minItems": 2, "maxItems": 2}
        return {"title": "a number or [lower, upper]", "anyOf": [number, ends]}

    @staticmethod
    def _ends(value: Any) -> Any:
        if isinstance(value, Interval):
            return value.lower, value.upper
        return value if isinstance(value, tuple) else (value, value)

    @classmethod
    def _between(cls, ends: tuple[float, float]) -> Interval:
        lower, upper = ends
        if lower > upper:
            raise refusal(
                f"lower limit {lower} lies above upper limit {upper}",
                "Write [lower, upper], or a single number for a fixed value.",
            )
        return cls(lower, upper)


@dataclass(frozen=True)
class PartOf:
    """Marks a text as the name of a part: built in, installed, or ``package.module:Object``."""

    group: Group

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_after_validator_function(self._known, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: Any) -> dict[str, Any]:
        known = {"enum": list(BUILT_IN[self.group])}
        return {"type": "string", "anyOf": [known, {"pattern": REFERENCE}]}

    def _known(self, name: str) -> str:
        if not is_known(self.group, name):
            raise refusal(f"there is no '{name}'", choices(self.group, name))
        return name


@dataclass(frozen=True)
class OneOf:
    """Marks a text as one of a few."""

    names: tuple[str, ...]

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        text = core_schema.str_schema(strict=True)
        return core_schema.no_info_after_validator_function(self._known, text)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: Any) -> dict[str, Any]:
        return {"type": "string", "enum": list(self.names)}

    def _known(self, name: str) -> str:
        if name not in self.names:
            raise refusal(f"there is no '{name}'", suggestion(name, self.names, "Choices"))
        return name


def _absolute(text: str) -> str:
    folder = text.folder if isinstance(text, Text) else Path.cwd()
    return os.path.abspath(folder / os.path.expanduser(text))


def _path(value: Any) -> Any:
    return Path(_absolute(value)) if isinstance(value, str) and value else value


def _model(value: Any) -> Any:
    is_path = isinstance(value, str) and looks_like_path(value, MODEL_SUFFIXES)
    return _absolute(value) if is_path and "://" not in value else value


def _address(value: Any) -> Any:
    return _absolute(value) if isinstance(value, str) and value and "://" not in value else value


def _axis(value: Any) -> Any:
    if isinstance(value, str):
        if value not in AXES:
            raise refusal(
                f"expected x, y, z or a vector [x, y, z], found '{value}'",
                "An axis of the end effector's frame, by name or as a vector in that frame.",
            )
        return AXES[str(value)]
    numbers = isinstance(value, tuple) and all(isinstance(v, int | float) for v in value)
    if numbers and not any(value):
        raise refusal("a vector of no length has no direction", "Write x, y, z or [x, y, z].")
    return value


def _nothing_is_empty(value: Any) -> Any:
    return {} if value is None else value


ModelName = Annotated[
    str,
    BeforeValidator(_model),
    Field(min_length=1),
    WithJsonSchema({"type": "string", "minLength": 1, "title": "a model's name or path"}),
]
"""The name of a shipped model, or the path of one, or its address in a package; a relative path
becomes absolute."""

Address = Annotated[
    str,
    BeforeValidator(_address),
    Field(min_length=1),
    WithJsonSchema({"type": "string", "minLength": 1, "title": "a path or address"}),
]
"""The path of a file, absolute likewise, or its address in a package."""

Folder = Annotated[Path, BeforeValidator(_path)]
"""A path, absolute: a relative one is seen from the file, or the place, it is written in."""

MeshFile = Annotated[Path, BeforeValidator(_path)]
"""The path of a mesh, absolute likewise."""

Name = Annotated[str, Field(pattern=NAME_PATTERN)]
Positive = Annotated[float, Field(gt=0)]
Probability = Annotated[float, Field(ge=1e-12, lt=1)]
Option = bool | int | float | str
Options = Annotated[dict[str, Option], BeforeValidator(_nothing_is_empty)]
Pairs = Annotated[
    tuple[tuple[str, str], ...],
    WithJsonSchema(
        {
            "type": "array",
            "title": "a list of pairs of names",
            "items": {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2},
        }
    ),
]
Limits = Annotated[dict[str, Positive], BeforeValidator(_nothing_is_empty)]
Packages = Annotated[dict[str, Folder], BeforeValidator(_nothing_is_empty)]
"""Folders by the names of packages."""
Axis = Annotated[
    tuple[float, float, float],
    BeforeValidator(_axis),
    WithJsonSchema(
        {
            "title": "x, y, z or [x, y, z]",
            "anyOf": [
                {"type": "string", "enum": list(AXES)},
                {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
            ],
        }
    ),
]
"""A direction: one of a frame's axes, or any vector but 0."""
Angles = Annotated[dict[str, float], BeforeValidator(_nothing_is_empty)]
