"""How often a command looks for garbage."""

from __future__ import annotations

import atexit
import gc

NEW = 50_000
"""Objects that are made before the youngest are looked through: importing Drake makes as many."""


def collect_seldom() -> None:
    """Leave most of a command's start, and all of its end, without Python's garbage collector.

    What is imported stays, and what is left at the end goes with the process; to look through it
    for garbage takes a tenth of a short command's time.
    """
    gc.set_threshold(NEW, 10, 10)
    atexit.register(gc.freeze)
