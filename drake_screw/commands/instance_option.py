"""``--instance``: where the objects stand, in as many words as that takes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise, takewhile
from typing import Any

import typer
from typer.core import TyperCommand

from drake_screw.errors import ScenarioError

_NAME = "--instance"

Place = tuple[float, ...] | dict[str, float]


def instance_option(sentence: str) -> Any:
    """The option, for a verb whose command is an `InstanceCommand`; `parse_instance` reads it.

    Args:
        sentence: begins its help, and says what the instance is for.
    """
    return typer.Option(
        _NAME,
        metavar="OBJECT=X,Y[,YAW] ...",
        help=f"{sentence} In m and rad, as in bowl=0.9,0.1 cup=0.8,-0.2,0.5, and where others vary "
        "bowl=0.9,0.1,z=0.05,roll=0.3. What is fixed may be left out: a yaw, or a whole object. A "
        "single object needs no name: 0.9 0.1.",
        show_default=False,
    )


class InstanceCommand(TyperCommand):
    """A verb with an argument, and an option ``--instance`` that takes words up to the next option.

    The last of them is the argument if it is no place, and the argument is nowhere else.
    """

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """As click parses them, with each word of the option made an option of its own."""
        rest, words = _apart(args)
        if words == [] and not ctx.resilient_parsing:
            raise ScenarioError(f"{_NAME} is given no place", remedy=_remedy())
        words = words or []
        if len(words) > 1 and not _is_place(words[-1]) and not self._has_argument(rest):
            rest = [words.pop(), *rest]
        return super().parse_args(ctx, [*(f"{_NAME}={word}" for word in words), *rest])

    def _has_argument(self, args: Sequence[str]) -> bool:
        options = [p for p in self.params if p.param_type_name == "option"]
        take = {name for p in options if not getattr(p, "is_flag", False) for name in p.opts}
        return any(
            before == "--" or not (_is_option(word) or before in take)
            for before, word in pairwise(["", *args])
        )


def parse_instance(words: Sequence[str]) -> dict[str, Place] | tuple[float, ...]:
    """The words of the option as what `drake_screw.assembly.placing.placed` takes.

    >>> parse_instance(["bowl=0.9,0.1", "cup=0.8,-0.2,0.5"])
    {'bowl': (0.9, 0.1), 'cup': (0.8, -0.2, 0.5)}
    >>> parse_instance(["0.9", "-0.1"])
    (0.9, -0.1)
    >>> parse_instance(["bowl=0.9,0.1,z=0.05"])
    {'bowl': {'x': 0.9, 'y': 0.1, 'z': 0.05}}

    Raises:
        ScenarioError: a word is neither, an object or an axis is there twice, or numbers without a
            name are not those of a single object.
    """
    if not any("=" in word for word in words):
        numbers = tuple(_number(word, f"{_NAME} {' '.join(words)}") for word in words)
        if len(numbers) not in (2, 3):
            raise ScenarioError(
                f"{_NAME} {' '.join(words)}: expected x, y and perhaps yaw of a single object",
                remedy=_remedy(),
            )
        return numbers
    places: dict[str, Place] = {}
    for word in words:
        name, equals, numbers_of_it = word.partition("=")
        if not (name and equals):
            raise ScenarioError(
                f"{_NAME}: expected OBJECT=X,Y or OBJECT=X,Y,YAW, found '{word}'", remedy=_remedy()
            )
        if name in places:
            raise ScenarioError(
                f"{_NAME}: '{name}' is given twice", remedy="Give each object once."
            )
        places[name] = _place(numbers_of_it.split(","), word, name)
    return places


def _place(parts: Sequence[str], word: str, name: str) -> Place:
    """X,Y or X,Y,YAW, and behind them, or in their place, axes by their names."""
    leading = list(takewhile(lambda part: "=" not in part, parts))
    numbers = tuple(_number(part, word, name) for part in leading)
    if len(leading) == len(parts):
        return numbers
    place = dict(zip(("x", "y", "yaw"), numbers, strict=False))
    if len(numbers) > len(place):
        raise ScenarioError(
            f"{word}: {len(numbers)} numbers before the axes by name", remedy=_remedy(name)
        )
    for part in parts[len(leading) :]:
        axis, equals, number = part.partition("=")
        if not equals:
            raise ScenarioError(f"{word}: '{part}' has no axis", remedy=_remedy(name))
        if axis in place:
            raise ScenarioError(f"{word}: {axis} is given twice", remedy="Give each axis once.")
        place[axis] = _number(number, word, name)
    return place


def _number(text: str, within: str, name: str | None = None) -> float:
    try:
        return float(text)
    except ValueError as error:
        what = f"'{text}' is not a number" if text.strip() else "a number is missing"
        raise ScenarioError(f"{within}: {what}", remedy=_remedy(name)) from error


def _remedy(name: str | None = None) -> str:
    item = name or "OBJECT"
    form = f"Give {item}=X,Y or {item}=X,Y,YAW in m and rad, without a space in it"
    return f"{form}." if name else f"{form}, for each object; X Y will do for a single one."


def _apart(args: Sequence[str]) -> tuple[list[str], list[str] | None]:
    """The other arguments, and the words of all ``--instance``; None if there is none."""
    rest: list[str] = []
    words: list[str] | None = None
    left = list(args)
    while left and left[0] != "--":
        word = left.pop(0)
        name, equals, first = word.partition("=")
        if name != _NAME:
            rest.append(word)
            continue
        more = list(takewhile(lambda w: not _is_option(w), left))
        del left[: len(more)]
        words = [*(words or []), *([first] if equals else []), *more]
    return rest + left, words


def _is_option(word: str) -> bool:
    return re.match(r"-[^\d.]", word) is not None


def _is_place(word: str) -> bool:
    return re.match(r"[\w-]+=|[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$", word) is not None
