"""What a reader makes of one recording, before it is understood: columns, and what the format says.

A reader is a function ``(source, mapping, progress)`` to a tuple of `Raw`, found by the name of its
format in `drake_screw.plugins`, group ``sources``.
"""

from __future__ import annotations

from collections.abc import Mapping as Dict
from dataclasses import dataclass, field
from typing import Any

from drake_screw.tables import Table
from drake_screw.typing import Array


@dataclass(frozen=True, eq=False)
class Raw:
    """One recording as its file has it.

    Attributes:
        name: of the recording, fit for a folder's.
        table: its columns.
        told: keys of a `Mapping` that the format itself states; the user's own go before them.
        X_WO: poses (4, 4) of objects that the format holds, by their names there.
        notes: what was left out, in words.
        frames: that these poses are seen from, where the format says so.
    """

    name: str
    table: Table
    told: Dict[str, Any] = field(default_factory=dict)
    X_WO: Dict[str, Array] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    frames: Dict[str, str] = field(default_factory=dict)
