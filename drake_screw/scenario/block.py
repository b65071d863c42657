"""What the blocks of a scenario file have in common."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple, Self

from pydantic import BaseModel, ConfigDict, ValidationError, model_validator
from pydantic_core import InitErrorDetails, PydanticCustomError

Keys = tuple[str | int, ...]
"""The way to a value: names of keys, and places in lists, counted from 0."""


class Problem(NamedTuple):
    """What is wrong with the value at `keys`, and what the user can do about it."""

    keys: Keys
    message: str
    remedy: str | None = None

    @property
    def path(self) -> str:
        """For example ``objects.0.radius``."""
        return ".".join(str(k) for k in self.keys)


def refusal(message: str, remedy: str | None = None) -> PydanticCustomError:
    """An error for a validator to raise, with the words that the user is to read."""
    return PydanticCustomError("rule", "{message}", {"message": message, "remedy": remedy})


class Block(BaseModel):
    """A block of a scenario file. The fields are its keys.

    The docstring of each is its meaning; its type has its limits, and perhaps its unit. Loading,
    the reference page and the JSON Schema are driven by them. Types are strict: a truth value is no
    number, and a number no text. Nothing at all stands for an empty mapping.
    """

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
    )

    def broken_rules(self) -> Iterator[Problem]:
        """Rules about several keys that are broken, by keys seen from this block.

        Asked only where every key is right by itself.
        """
        yield from ()

    @model_validator(mode="before")
    @classmethod
    def _nothing_is_empty(cls, data: Any) -> Any:
        return {} if data is None else data

    @model_validator(mode="after")
    def _keeps_its_rules(self) -> Self:
        errors = [
            InitErrorDetails(type=refusal(p.message, p.remedy), loc=p.keys, input=None)
            for p in self.broken_rules()
        ]
        if errors:
            raise ValidationError.from_exception_data(type(self).__name__, errors)
        return self
