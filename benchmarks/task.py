"""Shipped scenarios with demonstrations, to measure on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drake_screw.acquisition import Suggestion
from drake_screw.assembly.setup import Setup
from drake_screw.assembly.swap_model import swap_model
from drake_screw.demonstrations import Demonstration, Recording, read_library
from drake_screw.robot import Arm
from drake_screw.scenario.loader import load_scenario
from drake_screw.tasks import GridRegions
from drake_screw.typing import Array

TASKS = ("pouring", "scooping")


@dataclass(frozen=True)
class Task:
    """A scenario with demonstrations.

    Attributes:
        name: of the scenario.
        arm: on Drake's plant.
        q_start: (n,) rad.
        regions: of the work area.
        demonstrations: D of them.
    """

    name: str
    arm: Arm
    q_start: Array
    regions: GridRegions
    demonstrations: tuple[Demonstration, ...]

    def instances(self, count: int, rng: np.random.Generator) -> Array:
        """Uniform object poses X_WO (count, k, 4, 4)."""
        area = self.regions.area
        return area.X_WO(rng.uniform(area.lower, area.upper, (count, *area.lower.shape)))


def in_folder(template: str, name: str) -> str:
    """A path in which {task} stands for a scenario's task: both pouring and pouring_paper pour."""
    return template.format(task=name.removesuffix("_paper"))


def load_task(
    name: str, folder: str | None = None, model: Path | None = None, limit: int | None = None
) -> Task:
    """A shipped scenario with recorded demonstrations, or one simulated in each region."""
    scenario = load_scenario(name)
    setup = Setup(scenario if model is None else swap_model(scenario, model))
    arm = setup.workcell.arm
    recordings: tuple[Recording, ...]
    if folder is not None:
        recordings = read_library(in_folder(folder, name), arm.joint_names, arm.lower, arm.upper)[
            :limit
        ]
    else:
        regions = range(setup.regions.K)[:limit]
        lessons = [_lesson(setup, region) for region in regions]
        recordings = tuple(recording for recording in lessons if recording is not None)
    demonstrations = tuple(setup.learn(recording) for recording in recordings)
    return Task(name, arm, setup.workcell.start, setup.regions, demonstrations)


def _lesson(setup: Setup, region: int) -> Recording | None:
    lower, upper = setup.regions.bounds(region)
    return setup.teacher.demonstrate(
        Suggestion(region, (lower + upper) / 2.0, None),
        number=region,
        used=(),
        rng=np.random.default_rng(region),
    ).recording
