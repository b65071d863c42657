"""Manipulation plans from few demonstrations: screw geometry and bandits on Drake.

The rooms, from the bottom up: `screws`, `robot`, `demonstrations` and `tasks`, `planning` and
`bandits`, `acquisition` and `visualization`, `scenario`. What most programs begin with is here.
"""

from __future__ import annotations

from typing import Any

from drake_screw.errors import DrakeScrewError

__all__ = ["DrakeScrewError", "Setup", "load_scenario", "new_run", "open_run"]

_PLACES = {
    "Setup": "drake_screw.assembly.setup",
    "load_scenario": "drake_screw.scenario.loader",
    "new_run": "drake_screw.runs.run",
    "open_run": "drake_screw.runs.run",
}


def __getattr__(name: str) -> Any:
    """Import the rest of `__all__` when it is first asked for: Drake takes a second to load."""
    if name in _PLACES:
        from importlib import import_module

        return getattr(import_module(_PLACES[name]), name)
    raise AttributeError(f"module 'drake_screw' has no attribute '{name}'")
