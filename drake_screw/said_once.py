"""Warnings that a process gives once, however often there is reason to."""

from __future__ import annotations

import logging
from functools import lru_cache


@lru_cache
def warn_once(log: logging.Logger, line: str) -> None:
    """Warn, unless the same was said before."""
    log.warning("%s", line)
