"""What a kernel is told of plans that touch something."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drake_screw.planning.compiled.trace import Trace

Array = NDArray[np.float64]


class Touches(NamedTuple):
    """The first touches of P plans: arrays (P,).

    Attributes:
        touches: whether a plan does; nothing is said of the others.
        segment: in which it does, from 0.
        fraction: how much of that is done by then.
        pair: of bodies that touch.
    """

    touches: NDArray[np.bool_]
    segment: NDArray[np.int64]
    fraction: Array
    pair: NDArray[np.int64]


Check = Callable[[Array, Trace], Touches]
"""From object poses (N, k, 4, 4) and plans among them to which of the plans touch something."""
