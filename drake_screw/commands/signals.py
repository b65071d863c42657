"""What ends the program from outside: Ctrl-C, SIGTERM, and a terminal that goes away (SIGHUP)."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

import typer
from typer.core import TyperGroup

INTERRUPTED = 130
"""Exit code."""

_ENDINGS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Verbs(TyperGroup):
    """Verbs that say in a line that they were interrupted, where they have nothing better to say.

    A question at which Ctrl-C or Ctrl-D is pressed is interrupted, too.
    """

    def invoke(self, ctx: Any) -> Any:
        """Invokes the verb that the command line names."""
        try:
            return super().invoke(ctx)
        except (KeyboardInterrupt, typer.Abort):
            pass
        except typer.Exit:
            raise  # by a verb that had something to say
        except Exception:
            if not any(signal.getsignal(each) is _end for each in _ENDINGS):
                raise  # else it is what native code made of the interruption: an ImportError, say
        print("interrupted", file=sys.stderr)
        raise typer.Exit(INTERRUPTED)


@contextmanager
def interruptible() -> Iterator[None]:
    """A context in which each of the signals interrupts what goes on, as Ctrl-C does.

    So a run says that it was interrupted. Once more, and the program ends at once; whatever it
    writes appears whole or not at all even so. Signals that are ignored, as by nohup, stay so.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    handled = [each for each in _ENDINGS if signal.getsignal(each) is not signal.SIG_IGN]
    before = {each: signal.signal(each, _interrupt) for each in handled}
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)


def _interrupt(_: int, __: FrameType | None) -> None:
    for each in _ENDINGS:
        if signal.getsignal(each) is _interrupt:
            signal.signal(each, _end)
    raise KeyboardInterrupt


def _end(_: int, __: FrameType | None) -> None:
    os._exit(INTERRUPTED)
