"""Names of types that all packages use."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

PathLike = str | os.PathLike[str]
"""Whatever names a file or a folder."""

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[Any]
    """An array; its shape and units are stated where it is used."""
else:

    def __getattr__(name: str) -> Any:
        """Load numpy for `Array` alone: errors and file names do without."""
        if name == "Array":
            from numpy.typing import NDArray

            return NDArray[Any]
        raise AttributeError(f"module 'drake_screw.typing' has no attribute '{name}'")
