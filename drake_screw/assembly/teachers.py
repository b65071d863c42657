"""The teachers that a scenario can name without more ado; each is made from the setup."""

from __future__ import annotations

from drake_screw.acquisition import RecordedTeacher, Teacher
from drake_screw.acquisition.nearest_arm import NearestArm
from drake_screw.acquisition.simulated import SimulatedTeacher
from drake_screw.assembly.setup import Setup
from drake_screw.assembly.tried_recordings import TriedRecordings
from drake_screw.errors import ScenarioError


def simulated(setup: Setup) -> Teacher:
    """A teacher who leads the arm as people do, and shows the scenario's motion.

    Of several arms that is the one nearest to the object, or else the next nearest.
    """
    free_axis, arms = setup.scenario.planner.roll_axis, setup.arms
    each = [SimulatedTeacher(one.workcell, setup.area, setup.motion, free_axis) for one in arms]
    if len(each) == 1:
        return each[0]
    return NearestArm(tuple(one.name for one in arms), each, setup.shoulders, setup.area)


def recorded(setup: Setup) -> Teacher:
    """A teacher who answers from the scenario's folder of recordings.

    Raises:
        RecordingError: the folder cannot be used.
    """
    block, recorder = setup.scenario.teacher, setup.recorder
    assert block.folder is not None
    tried = TriedRecordings(recorder, setup.learning, setup.planner, setup.start)
    return RecordedTeacher(
        recorder.library(block.folder, block.format),
        setup.regions,
        foreign=None if recorder.robot is None else tried,
        covering=tried if block.choose == "covers_most" else None,
    )


def interactive(setup: Setup) -> Teacher:
    """No teacher: a person is asked on a page, which a setup knows nothing of.

    Raises:
        ScenarioError: always.
    """
    raise ScenarioError(
        "teacher.kind: an interactive teacher has to be passed in: it asks on a page",
        remedy="Run it from the command line, or pass "
        "teacher=drake_screw.web.teaching_page.interactive_teacher.",
        file=setup.scenario.source,
    )
