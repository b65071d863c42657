"""The runs of a study, shared out among processes that may be on other machines."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from drake_screw.acquisition import RecordedTeacher
from drake_screw.assembly.setup import Setup
from drake_screw.errors import RunDirectoryError
from drake_screw.runs.begun_with import RECORDED_ON, changed_model, model_hashes
from drake_screw.scenario.schema import Scenario
from drake_screw.sharing import SharingError, Workers, share_out
from drake_screw.studies.experiment import Experiment, StudyRun

_RECORDINGS = "teacher.folder"


def shared_runs(
    experiment: Experiment, missing: Sequence[tuple[int, int]], workers: Workers, study: Path
) -> Iterator[StudyRun]:
    """Runs (K, number) as they are finished, in any order.

    On this machine the arm's code is compiled here, and only once.

    Args:
        experiment: as this process would carry them out.
        missing: the runs.
        workers: see `share_out`.
        study: its folder, for messages.

    Raises:
        RunDirectoryError: the workers were lost, or cannot do their part.
    """
    setup = experiment.setup
    here = workers is None or isinstance(workers, int)
    first = int(here and not all(one.batch_planner.compiled for one in setup.arms))
    for K, run in missing[:first]:
        yield experiment.run(K, run)
    read = hashes(setup) | _recordings(setup)
    build = partial(_experiment, setup.scenario, read) if workers != 1 else lambda: experiment
    shared = share_out(_carry_out, missing[first:], build=build, workers=workers)
    try:
        for _, finished in shared:
            yield finished
    except SharingError as error:
        again = f"Then carry the study on: drake-screw study --resume {study}"
        raise RunDirectoryError(
            f"{error.message}; this study is not finished",
            remedy=f"{error.remedy}\n  {again}" if error.remedy else again,
            file=study,
        ) from error


def hashes(setup: Setup) -> dict[str, str]:
    """Of what was read of the robot's model, and of the meshes around it."""
    return {name: h for name, h in model_hashes(setup).items() if name != RECORDED_ON}


def check_unchanged(setup: Setup, known: Mapping[str, str], study: Path | None) -> None:
    """Check that the robot is the one that a study began with.

    Args:
        known: hashes then.
        study: its folder, for the message.

    Raises:
        RunDirectoryError: a model or mesh is another one.
    """
    changed = changed_model(setup, hashes(setup), known)
    if changed is not None:
        raise RunDirectoryError(
            f"{changed} has changed since this study began",
            remedy="Put the file back as it was, or begin the study again.",
            file=study,
        )


def _recordings(setup: Setup) -> dict[str, str]:
    """The hash of the recordings that a teacher gives, if it gives recordings."""
    teacher = setup.teacher
    if not isinstance(teacher, RecordedTeacher):
        return {}
    digest = hashlib.sha256()
    for recording in teacher.recordings:
        digest.update(repr((recording.name, recording.joint_names)).encode())
        for numbers in (recording.t, recording.q, recording.X_WO, recording.X_WE):
            if numbers is not None:
                digest.update(np.ascontiguousarray(numbers).tobytes())
    return {_RECORDINGS: digest.hexdigest()}


def _experiment(scenario: Scenario, read: Mapping[str, str]) -> Experiment:
    """The runs as another process carries them out, with what was read there."""
    experiment = Experiment(scenario)
    setup = experiment.setup
    check_unchanged(setup, read, None)
    if _recordings(setup).get(_RECORDINGS) != read.get(_RECORDINGS):
        raise RunDirectoryError(
            "the recordings in this folder are not those that the study was begun with",
            file=setup.scenario.teacher.folder,
        )
    return experiment


def _carry_out(experiment: Experiment, job: tuple[int, int]) -> StudyRun:
    return experiment.run(*job)
