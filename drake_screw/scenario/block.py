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


LARGEST = {"m": 1e3, "rad": 1e3, "kg": 1e6}
"""By unit: what is larger is in another one, and more than geometry and dynamics can be done with.
Of the shapes of a robot's model see `robot.model_text.LARGEST`."""


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

    def _too_large(self) -> Iterator[Problem]:
        for name, about in type(self).model_fields.items():
            extra, value = about.json_schema_extra, getattr(self, name)
            unit = str(extra.get("unit")) if isinstance(extra, dict) else ""
            ends = getattr(value, "ends", value)
            numbers = [x for x in (ends if isinstance(ends, tuple) else (ends,)) if _is_number(x)]
            largest = max(numbers, key=abs, default=0.0)
            if unit in LARGEST and abs(largest) > LARGEST[unit]:
                message = f"{largest:g} {unit} is beyond {LARGEST[unit]:,.0f} {unit}"
                yield Problem((name,), message, f"Numbers here are in {unit}.")

    @model_validator(mode="before")
    @classmethod
    def _nothing_is_empty(cls, data: Any) -> Any:
        return {} if data is None else data

    @model_validator(mode="after")
    def _keeps_its_rules(self) -> Self:
        errors = [
            InitErrorDetails(type=refusal(p.message, p.remedy), loc=p.keys, input=None)
            for p in (*self._too_large(), *self.broken_rules())
        ]
        if errors:
            raise ValidationError.from_exception_data(type(self).__name__, errors)
        return self


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
