"""How long a Meshcat lives: it must end in the thread that made it, or it ends the program.

Python's garbage collector runs in whichever thread happens to set it off, those that answer a
page's requests among them. A Meshcat is often part of a cycle (plants and diagrams keep one another
alive), so it is the collector that ends it.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

from pydrake.geometry import Meshcat

_KEPT: list[Meshcat] = []


def keep(meshcat: Meshcat) -> Meshcat:
    """Let a Meshcat that a page shows live as long as the program; there are few of them."""
    _KEPT.append(meshcat)
    return meshcat


@contextmanager
def scratch() -> Iterator[None]:
    """A block at whose end all Meshcats that were made in it and left behind are gone."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.collect()
        if enabled:
            gc.enable()
