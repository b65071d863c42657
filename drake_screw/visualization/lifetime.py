"""How long a Meshcat lives: it must end in the thread that made it, or it ends the program.

Python's garbage collector runs in whichever thread happens to set it off, those that answer a
page's requests among them. A Meshcat is often part of a cycle (plants and diagrams keep one another
alive), so it is the collector that ends it.
"""

from __future__ import annotations

import gc
import socket
from collections.abc import Iterator
from contextlib import contextmanager

from pydrake.geometry import Meshcat, MeshcatParams

_KEPT: list[Meshcat] = []


def page_meshcat(host: str) -> Meshcat:
    """A Meshcat behind a page. It lives as long as the program; there are few of them.

    It takes any free port, and not the first after 7000 as Meshcat would by itself: that may be the
    one that is wanted for the page. To be called in the main thread, where it will end.
    """
    with socket.create_server((host, 0)) as free:
        port = free.getsockname()[1]
    _KEPT.append(Meshcat(MeshcatParams(host=host, port=port, show_stats_plot=False)))
    return _KEPT[-1]


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
