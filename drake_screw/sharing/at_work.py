"""What a process does that jobs are sent to: it builds what they need once, and keeps it."""

from __future__ import annotations

import hashlib
import pickle
import time
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from threading import Lock, local
from typing import Any, Self

KEPT = 2
"""Things built that a thread keeps: of so many works it can do jobs in turn."""


@dataclass(frozen=True)
class Need:
    """How to build what jobs need, as it is sent along with them.

    Attributes:
        key: tells it from others.
        pickled: a function without arguments.
    """

    key: str
    pickled: bytes

    @classmethod
    def of(cls, build: Callable[[], Any]) -> Self:
        """That function, pickled."""
        pickled = pickle.dumps(build)
        return cls(hashlib.sha256(pickled).hexdigest(), pickled)


class _Kept(local):
    """Of each thread its own: plants and planners are used by one thread at a time."""

    def __init__(self) -> None:
        self.tools: OrderedDict[str, Any] = OrderedDict()


_kept = _Kept()
_building = Lock()


def carry_out(
    need: Need, work: Callable[[Any, Any], Any], jobs: Sequence[Any]
) -> tuple[list[Any], float]:
    """Do some jobs one after another.

    Returns:
        Their answers, and the seconds they took, what had to be built for them left out.
    """
    tool = built(need)
    began = time.perf_counter()
    return [work(tool, job) for job in jobs], time.perf_counter() - began


def built(need: Need) -> Any:
    """What is needed, as this thread has it or makes it now."""
    tools = _kept.tools
    if need.key not in tools:
        while len(tools) >= KEPT:
            tools.popitem(last=False)
        with _building:
            tools[need.key] = pickle.loads(need.pickled)()
    tools.move_to_end(need.key)
    return tools[need.key]
