"""JSON that others wrote: whatever it holds, no more than a ValueError comes of it."""

from __future__ import annotations

import json
from typing import Any


def decode_json(text: str | bytes) -> Any:
    """What a text of JSON holds.

    Raises:
        ValueError: it is none, or brackets in it are nested more deeply than Python follows.
    """
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def within(value: Any, *keys: str) -> Any:
    """What stands in mappings within mappings at these keys; None where there is none."""
    for key in keys:
        value = value.get(key) if isinstance(value, dict) else None
    return value
