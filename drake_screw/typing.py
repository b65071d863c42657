"""Names of types that all packages use."""

from __future__ import annotations

import os
from typing import Any

from numpy.typing import NDArray

Array = NDArray[Any]
"""An array; its shape and units are told where it is used."""

PathLike = str | os.PathLike[str]
"""Whatever names a file or a folder."""
