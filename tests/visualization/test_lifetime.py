from __future__ import annotations

import gc
import subprocess
import sys
import weakref

import pytest

from drake_screw.visualization.lifetime import scratch

LEFT_BEHIND = """
import gc, sys, threading
from pydrake.geometry import Meshcat, MeshcatParams
from drake_screw.visualization.lifetime import page_meshcat, scratch

def leave() -> None:
    if sys.argv[1] == "page":
        meshcat = page_meshcat("localhost")
    else:
        meshcat = Meshcat(MeshcatParams(host="localhost"))
    cycle = [meshcat]
    cycle.append(cycle)

if sys.argv[1] == "scratch":
    with scratch():
        leave()
else:
    leave()
other = threading.Thread(target=gc.collect)
other.start()
other.join()
print("alive", flush=True)
"""


@pytest.mark.parametrize("way", ["page", "scratch"])
def test_no_other_thread_ends_a_meshcat(way) -> None:
    done = subprocess.run(
        [sys.executable, "-c", LEFT_BEHIND, way], capture_output=True, text=True, timeout=120
    )
    assert (done.returncode, done.stdout) == (0, "alive\n"), done.stderr


class Node:
    def __init__(self) -> None:
        self.itself = self


def test_a_block_collects_what_it_leaves_behind() -> None:
    assert gc.isenabled()
    with scratch():
        assert not gc.isenabled()
        left = weakref.ref(Node())
        assert left() is not None
    assert left() is None
    assert gc.isenabled()
