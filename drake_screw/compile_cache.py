"""Numba's compiled code in files that are checked before they are trusted.

Numba takes machine code from its cache as it lies there: a file that was cut off ends the program
at every start. Here each file begins with the SHA-256 of what follows; a file that does not have it
is removed, its code is compiled anew, and that is told in a line.
"""

from __future__ import annotations

import hashlib
import logging
import os
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from numba import njit
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.runtime import rtsys
from numba.core.serialize import dumps

from drake_screw.cache_folder import discard
from drake_screw.said_once import warn_once

_log = logging.getLogger(__name__)


def cached_njit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """``numba.njit`` with a cache on disk whose files are checked.

    Where there is no folder that code can be kept in, it is compiled in every process.

    Args:
        options: of njit.
    """

    def decorate(function: Callable[..., Any]) -> Any:
        compiled = njit(**options)(function)
        try:
            compiled._cache = _CheckedCache(function)
        except RuntimeError as error:
            _log.debug("%s", error)
            warn_once(
                _log, "no folder was found that compiled code can be kept in; set XDG_CACHE_HOME"
            )
        return compiled

    return decorate


class _CheckedCache(FunctionCache):
    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self._cache_file = _CheckedFiles(
            cache_path=self._cache_path,
            filename_base=self._impl.filename_base,
            source_stamp=self._impl.locator.get_source_stamp(),
        )

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Without all that numba can compile, which loading needs nothing of."""
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            super().save_overload(sig, data)
        except OSError as error:
            why = error.strerror or error
            line = f"{self.cache_path}: compiled code cannot be kept: {why}; it will be made again"
            warn_once(_log, line)


class _CheckedFiles(IndexDataCacheFile):
    """An index of what was compiled, by signature and processor, and a file for each."""

    def __init__(self, **where: Any) -> None:
        super().__init__(**where)
        base = where["filename_base"]
        self._index_path = os.path.join(self._cache_path, f"{base}.index")
        self._data_name_pattern = f"{base}.{{number:d}}.code"

    def _load_index(self) -> dict[Any, str]:
        known = _read(self._index_path)
        if known is None or known[:2] != (numba.__version__, self._source_stamp):
            return {}
        names: dict[Any, str] = known[2]
        return names

    def _save_index(self, overloads: dict[Any, str]) -> None:
        self._write(self._index_path, (numba.__version__, self._source_stamp, overloads))

    def _load_data(self, name: str) -> Any:
        return _read(self._data_path(name))

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), data)

    def _write(self, path: str, content: Any) -> None:
        data = dumps(content)
        if os.path.isdir(path):
            _remove(path)
        with self._open_for_write(path) as file:
            file.write(hashlib.sha256(data).digest() + data)


def _read(path: str) -> Any:
    """What was written to a file; None where there is none, or it is not whole any more."""
    try:
        with open(path, "rb") as file:
            digest, data = file.read(32), file.read()
        if hashlib.sha256(data).digest() == digest:
            return pickle.loads(data)
        why = "it is damaged"
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, pickle.UnpicklingError, AttributeError, ImportError) as error:
        why = getattr(error, "strerror", None) or str(error)
    warn_once(_log, f"{path}: {why}; the code is compiled again")
    _remove(path)
    return None


def _remove(path: str) -> None:
    try:
        discard(Path(path))
    except OSError as error:
        _log.debug("%s cannot be removed: %s", path, error)
