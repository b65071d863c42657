"""Outcomes of instances that are planned by the workers of a cluster."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial

from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import ModelError
from drake_screw.planning import Outcomes, concatenate
from drake_screw.scenario.schema import Scenario
from drake_screw.sharing import Crew, Executor
from drake_screw.typing import Array

JOB = 512
"""Instances in a job."""


class SharedOutcomes:
    """Plans instances on a cluster; outcomes do not depend on how they are shared out.

    Demonstrations travel with the work, so that workers need the robot's model and no recordings.

    Args:
        setup: of the scenario.
        demonstrations: D of them.
        cluster: whose workers plan, on one thread each.

    Attributes:
        seconds: that planning took.
    """

    def __init__(
        self, setup: Setup, demonstrations: Sequence[Demonstration], cluster: Executor
    ) -> None:
        model = setup.workcell.model.hash
        build = partial(_Planning, setup.scenario, tuple(demonstrations), model)
        self._crew: Crew[_Planning] = Crew(build, cluster)
        self.seconds = 0.0

    def plan(self, coordinates: Array, planned: Callable[[int], None]) -> Outcomes:
        """Outcomes (N, D) of instances (N, k, c).

        Args:
            coordinates: of the instances.
            planned: told how many more are planned.

        Raises:
            SharingError: the workers are lost, or cannot do their part.
        """
        began = time.perf_counter()
        jobs = [coordinates[i : i + JOB] for i in range(0, len(coordinates), JOB)]
        found: dict[int, Outcomes] = {}
        for place, outcomes in self._crew.share(_plan, jobs):
            found[place] = outcomes
            planned(len(outcomes.cause))
        self.seconds += time.perf_counter() - began
        return concatenate([found[place] for place in range(len(jobs))])


class _Planning:
    """What a worker plans with."""

    def __init__(
        self, scenario: Scenario, demonstrations: Sequence[Demonstration], model: str
    ) -> None:
        self.setup, self.demonstrations = Setup(scenario), demonstrations
        workcell = self.setup.workcell
        if workcell.model.hash != model:
            raise ModelError(
                "the robot's model is not the one that the table was begun with",
                file=workcell.model_file,
            )
        for one in self.setup.arms:
            one.batch_planner.threads = 1


def _plan(planning: _Planning, coordinates: Array) -> Outcomes:
    return planning.setup.evaluate(planning.demonstrations, coordinates)
