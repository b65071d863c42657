"""What a run was begun with, and has to find again when it is carried on."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from drake_screw.assembly.setup import Setup
from drake_screw.errors import RunDirectoryError
from drake_screw.files import file_hash
from drake_screw.runs.directory import RunDirectory

RECORDED_ON = "recorded_on"
"""Names the model of the robot that recordings were made on, where that is another one."""


def model_files(setup: Setup) -> dict[str, Path]:
    """The models and meshes that a run depends on."""
    other = setup.recorder.model_file
    models = {"model": setup.workcell.model_file}
    return models | ({} if other is None else {RECORDED_ON: other}) | setup.srdf | setup.meshes


def model_hashes(setup: Setup) -> dict[str, str]:
    """Of what was read of each of `model_files`: of a model in xacro, what it stands for."""
    other = setup.recorder.model
    found = {"model": setup.workcell.model.hash}
    found |= {} if other is None else {RECORDED_ON: other.hash}
    others = setup.srdf | setup.meshes
    return found | {name: file_hash(file) for name, file in others.items()}


def check_models(setup: Setup, directory: RunDirectory) -> None:
    """Refuse models and meshes that are not what they were.

    Raises:
        RunDirectoryError: one has changed.
    """
    changed = changed_model(setup, model_hashes(setup), directory.record.hashes)
    if changed is not None:
        raise RunDirectoryError(
            f"{changed} has changed since this run",
            remedy="Put the file back as it was, or run the scenario again.",
            file=directory.path,
        )


def changed_model(
    setup: Setup, found: Mapping[str, str], known: Mapping[str, str | None]
) -> str | None:
    """The first of models and meshes that is not what it was, in words; None if all are.

    Args:
        found: hashes of those that count, as `model_hashes` has them.
        known: hashes as they were.
    """
    files = model_files(setup)
    for name, now in found.items():
        if now != known.get(name):
            what = "mesh" if name in setup.meshes else "robot model"
            what = "SRDF" if name in setup.srdf else what
            return f"the {what} {files[name]}"
    return None


def check_parts(setup: Setup, directory: RunDirectory) -> None:
    """Refuse to go on without the parts that were passed in.

    Raises:
        RunDirectoryError: one is missing.
    """
    missing = set(directory.record.passed_in) - set(setup.passed_in)
    if missing:
        parts = ", ".join(f"{name}=..." for name in sorted(missing))
        raise RunDirectoryError(
            f"this run was begun in Python with its own {' and '.join(sorted(missing))}",
            remedy=f"Carry it on from there: open_run(path, {parts}). Parts that the scenario "
            "names are found again by themselves.",
            file=directory.path,
        )


def check_ways_around(setup: Setup, before: bool | None, what: str, path: Path) -> None:
    """Refuse to judge one part with ways around what is touched, and another without.

    Args:
        setup: as it is now.
        before: what `Setup.leads_around` was in the beginning; None where that is not known.
        what: that is carried on, a "run" or a "study".
        path: its directory.

    Raises:
        RunDirectoryError: OMPL was there and is not, or the other way round.
    """
    now = setup.leads_around
    if before is None or now is None or before == now:
        return
    again = "run the scenario again" if what == "run" else f"begin the {what} again"
    if before:
        raise RunDirectoryError(
            f"this {what} was begun with OMPL, which leads the arm around what a free approach "
            "touches; it is not installed now, and more plans would fail",
            remedy=f"Install it to carry the {what} on (pip install 'drake-screw[ompl]'), or "
            f"{again}.",
            file=path,
        )
    raise RunDirectoryError(
        f"this {what} was begun without OMPL, so that plans fail whose free approach touches "
        "something; it is installed now, and would lead the arm around",
        remedy=f"{again.capitalize()}, or carry this {what} on where OMPL is not installed.",
        file=path,
    )
