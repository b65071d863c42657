"""Manipulation plans from few demonstrations: screw geometry and bandits on Drake.

What is named in `__all__` is stable; ``docs/python.md`` shows how it is used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from drake_screw.errors import (
    DrakeScrewError,
    ModelError,
    RecordingError,
    RunDirectoryError,
    ScenarioError,
)
from drake_screw.lazily import lazily

if TYPE_CHECKING:
    from drake_screw import screws
    from drake_screw.assembly.plan_chooser import PlanChooser
    from drake_screw.assembly.setup import Setup
    from drake_screw.demonstrations import Demonstration
    from drake_screw.execution import ScrewPlanExecutor, ScrewPlanner
    from drake_screw.planning import Outcomes
    from drake_screw.runs.run import new_run, open_run
    from drake_screw.scenario.loader import load_scenario

    __version__: str

__all__ = [
    "Demonstration",
    "DrakeScrewError",
    "ModelError",
    "Outcomes",
    "PlanChooser",
    "RecordingError",
    "RunDirectoryError",
    "ScenarioError",
    "ScrewPlanExecutor",
    "ScrewPlanner",
    "Setup",
    "__version__",
    "load_scenario",
    "new_run",
    "open_run",
    "screws",
]

_of_modules = lazily(
    __name__,
    {
        "Demonstration": "drake_screw.demonstrations",
        "Outcomes": "drake_screw.planning",
        "PlanChooser": "drake_screw.assembly.plan_chooser",
        "ScrewPlanExecutor": "drake_screw.execution",
        "ScrewPlanner": "drake_screw.execution",
        "Setup": "drake_screw.assembly.setup",
        "load_scenario": "drake_screw.scenario.loader",
        "new_run": "drake_screw.runs.run",
        "open_run": "drake_screw.runs.run",
    },
)


def __getattr__(name: str) -> Any:
    """Import the rest of `__all__` when it is first asked for: Drake takes a second to load."""
    if name == "screws":
        return import_module("drake_screw.screws")
    if name == "__version__":
        return import_module("importlib.metadata").version("drake-screw")
    return _of_modules(name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
