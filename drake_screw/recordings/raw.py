"""What a reader makes of one recording, before it is understood: columns, and what the format says.

A reader is a function ``(source, mapping, progress)`` to a tuple of `Raw`, found by the name of its
format in `drake_screw.plugins`, group ``sources``.
"""

from __future__ import annotations

from collections.abc import Mapping as Dict
from dataclasses import dataclass, field
from typing import Any

from drake_screw.recordings.frames import Frames
from drake_screw.tables import Table
from drake_screw.typing import Array


@dataclass(frozen=True, eq=False)
class Labels:
    """What was said over time beside the motion: `values` (m,), each from its time `t` (m,) on.

    Times are in s on the clock of the recording's table.
    """

    t: Array
    values: tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class Raw:
    """One recording as its file has it.

    Attributes:
        name: of the recording, fit for a folder's.
        table: its columns.
        told: keys of a `Mapping` that the format itself states; the user's own go before them.
        X_WO: poses (4, 4) of objects that the format holds, by their names there.
        notes: what was left out, in words.
        frames: poses over time that the format holds.
        labels: what `Mapping.episodes` may name beside columns.
        hand_frame: what the table's hand poses are seen from, where the format says so.
        begin: s, the time of the table's first row on the clock of frames and labels.
    """

    name: str
    table: Table
    told: Dict[str, Any] = field(default_factory=dict)
    X_WO: Dict[str, Array] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    frames: Frames = field(default_factory=Frames)
    labels: Dict[str, Labels] = field(default_factory=dict)
    hand_frame: str = ""
    begin: float = 0.0
