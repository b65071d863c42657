"""How far long work is, told as it goes on by what does it to whoever shows it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Step:
    """How far a step is: what is done, and `done` of `total`, where that is known.

    Attributes:
        words: what is done: "drawing pictures".
        done: how many, or what part.
        total: of how many; 1.0 where `done` is a part; None where it is not known.
    """

    words: str
    done: float = 0
    total: float | None = None


Tell = Callable[[Step], object]
"""Is told of each step as it begins, and of how far it is."""


def to_nobody(step: Step) -> None:
    """Tells nobody."""
