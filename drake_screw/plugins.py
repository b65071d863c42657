"""Parts that are named in text: built in, installed with another package, or anybody's own.

A name in a scenario or on the command line is one of

- the name of a built-in part, such as ``eprocess``;
- the name of an entry point that an installed package declares in ``drake_screw.<group>``;
- a reference ``package.module:Object`` to any object that Python can import.

Nothing is imported before `find` asks for it. What is somebody else's and raises anything but a
`DrakeScrewError` when it is called becomes a `PluginError`, which says so.
"""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable, Mapping
from functools import wraps
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any, Literal

from drake_screw.errors import DrakeScrewError, PluginError, nearest, suggestion

Group = Literal[
    "strategies",
    "asking_rules",
    "motions",
    "teachers",
    "recording_formats",
    "sources",
    "exporters",
]

BUILT_IN: Mapping[Group, Mapping[str, str]] = {
    "strategies": {
        "eprocess": "drake_screw.bandits.eprocess:EProcess",
        "naive_pac": "drake_screw.bandits.naive_pac:NaivePac",
        "clopper_pearson": "drake_screw.bandits.clopper_pearson:ClopperPearson",
        "successive_elimination": (
            "drake_screw.bandits.successive_elimination:SuccessiveElimination"
        ),
        "lucb": "drake_screw.bandits.lucb:Lucb",
        "ucb": "drake_screw.bandits.ucb:Ucb",
        "median_elimination": "drake_screw.bandits.median_elimination:MedianElimination",
    },
    "asking_rules": {
        "earliest": "drake_screw.acquisition.asking:earliest",
        "densest": "drake_screw.acquisition.asking:densest",
        "densest_anywhere": "drake_screw.acquisition.asking:densest_anywhere",
    },
    "motions": {
        "pouring": "drake_screw.acquisition.simulated.motions:pouring",
        "scooping": "drake_screw.acquisition.simulated.motions:scooping",
        "fetching": "drake_screw.acquisition.simulated.motions:fetching",
    },
    "teachers": {
        "simulated": "drake_screw.assembly.teachers:simulated",
        "recorded": "drake_screw.assembly.teachers:recorded",
        "interactive": "drake_screw.assembly.teachers:interactive",
    },
    "recording_formats": {"folder": "drake_screw.demonstrations.library:read_recording"},
    "sources": {
        "table": "drake_screw.recordings.text_formats:read_text",
        "rostopic": "drake_screw.recordings.text_formats:read_rostopic",
        "bag": "drake_screw.recordings.ros_bags:read_bag",
        "lerobot": "drake_screw.recordings.lerobot:read_lerobot",
        "hdf5": "drake_screw.recordings.robosuite_hdf5:read_hdf5",
        "trajectory": "drake_screw.recordings.ros_trajectory:read_trajectory",
    },
    "exporters": {
        "baxter-csv": "drake_screw.execution.trajectory_formats:baxter_csv",
        "ros-trajectory": "drake_screw.execution.trajectory_formats:ros_trajectory",
        "moveit-trajectory": "drake_screw.execution.trajectory_formats:moveit_trajectory",
        "npz": "drake_screw.execution.trajectory_formats:npz",
        "ros2-bag": "drake_screw.execution.ros_bag_writer:ros2_bag",
        "lerobot": "drake_screw.execution.lerobot_writer:lerobot",
    },
}
"""Where the parts of each group are defined; the first strategy is the default one."""

REFERENCE = r"^[A-Za-z_]\w*(\.[A-Za-z_]\w*)*:[A-Za-z_]\w*(\.[A-Za-z_]\w*)*$"
"""Pattern of ``package.module:Object``."""

_SINGULAR: Mapping[Group, str] = {
    "strategies": "strategy",
    "asking_rules": "asking rule",
    "motions": "motion",
    "teachers": "teacher",
    "recording_formats": "recording format",
    "sources": "format of recordings to import",
    "exporters": "export format",
}


def names(group: Group) -> tuple[str, ...]:
    """Names of a group: the built-in ones, then those of installed packages, sorted."""
    return (*BUILT_IN[group], *sorted(_installed(group)))


def is_known(group: Group, name: str) -> bool:
    """Whether `name` is one of the group's, or has the form of a reference."""
    return name in BUILT_IN[group] or is_plugged_in(group, name)


def is_plugged_in(group: Group, name: str) -> bool:
    """Whether `name` means a part that is not built in."""
    if name in BUILT_IN[group]:
        return False
    return re.match(REFERENCE, name) is not None or name in _installed(group)


def find(group: Group, name: str) -> Callable[..., Any]:
    """The class or function that a name of a group means.

    Raises:
        PluginError: no such name, its module cannot be imported, or the module has no such class
            or function.

    >>> find("strategies", "eprocess").__name__
    'EProcess'
    >>> find("motions", "math:hypot")(3.0, 4.0)
    5.0
    """
    kind = _SINGULAR[group]
    reference = BUILT_IN[group].get(name) or _installed(group).get(name) or name
    if not re.match(REFERENCE, reference):
        raise PluginError(f"no {kind} '{name}'", remedy=choices(group, name))
    module_name, _, path = reference.partition(":")
    try:
        found: Any = import_module(module_name)
    except Exception as error:  # whatever the module of somebody else raises
        raise PluginError(
            f"{kind} '{name}': the module {module_name} cannot be imported: "
            f"{type(error).__name__}: {error}",
            remedy="Install its package, or put the folder it lies in on PYTHONPATH.",
        ) from error
    for part in path.split("."):
        if not hasattr(found, part):
            guess = nearest(part, vars(found) if hasattr(found, "__dict__") else ())
            raise PluginError(
                f"{kind} '{name}': there is no '{part}' in {module_name}",
                remedy=f"Did you mean '{guess}'?" if guess else None,
            )
        found = getattr(found, part)
    if not callable(found):
        raise PluginError(
            f"{kind} '{name}': expected a class or a function, found {type(found).__name__}"
        )
    called: Callable[..., Any] = found
    return _guarded(called, f"{kind} '{name}'") if is_plugged_in(group, name) else called


def _guarded(part: Callable[..., Any], what: str) -> Callable[..., Any]:
    """The same part; what is raised when it is called is told in the name of who wrote it."""

    @wraps(part)
    def call(*args: Any, **options: Any) -> Any:
        try:
            return part(*args, **options)
        except DrakeScrewError:
            raise
        except Exception as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            where = f"In {place.filename}:{place.lineno}. " if place.filename != __file__ else ""
            raise PluginError(
                f"{what} raised {type(error).__name__}: {error}",
                remedy=f"{where}--verbose shows the way there.",
            ) from error

    return call


def choices(group: Group, name: str) -> str:
    """What can be written in place of a name that is not known."""
    listed = suggestion(name, names(group), "Choices")
    return f"{listed}; or package.module:Object for one of your own"


def _installed(group: Group) -> dict[str, str]:
    """References of the entry points that installed packages declare, by name."""
    return {
        entry.name: f"{entry.module}:{entry.attr}"
        for entry in entry_points(group=f"drake_screw.{group}")
        if entry.name not in BUILT_IN[group]
    }
