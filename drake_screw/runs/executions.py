"""Execute plans of a run in simulation: fresh instances, or one place of the user's own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydrake.geometry import Meshcat

from drake_screw.assembly.placing import InstanceLike, placed
from drake_screw.assembly.plan_chooser import PlanChooser
from drake_screw.assembly.setup import Setup
from drake_screw.assembly.why_not import why_not
from drake_screw.demonstrations import Demonstration
from drake_screw.errors import ModelError
from drake_screw.execution import (
    ScrewPlanner,
    Station,
    TimeLimits,
    build_station,
    recording_html,
)
from drake_screw.execution.motors import assumed_motors, immovable
from drake_screw.execution.parallel import Job, StationConfig, execute_all
from drake_screw.execution.trials import Trial, TrialSummary, summarize, trials_csv
from drake_screw.files import fresh_folder, write_folder, writing
from drake_screw.planning import Outcomes, concatenate
from drake_screw.runs.run import open_run
from drake_screw.tasks import draw_in_all
from drake_screw.typing import Array, PathLike
from drake_screw.visualization.lifetime import scratch

ROUND = 1_000_000
"""The round whose instances are executed. No run gets that far, so they are fresh."""

TRIES = 20  # times as many instances are drawn in a region at most as are wanted
SHOWN = 4  # executions in the recording


@dataclass(frozen=True)
class Executions:
    """Executions of a run; as text they are what ``drake-screw execute`` prints.

    Attributes:
        folder: with table, summary and recording.
        assumed: what is taken for what the robot's model does not state, a line each.
        summary: what they show.
    """

    folder: Path
    assumed: tuple[str, ...]
    summary: TrialSummary

    def __str__(self) -> str:
        notes = "".join(f"note: {line}\n" for line in self.assumed)
        return f"{notes}{self.summary}\nwritten to {self.folder}"


def execute(
    run: PathLike,
    *,
    per_region: int = 2,
    instance: InstanceLike | None = None,
    workers: int | None = None,
) -> Executions:
    """Plan, simulate and report executions of a run.

    Of every instance the best plan with the run's demonstrations is simulated: that with the
    largest margin to the joint limits which touches nothing. A table, a summary and
    a recording that plays go into a new folder ``executions/<time>`` of the run.

    Args:
        run: its directory.
        per_region: executions in every region; instances without a plan are drawn again, and
            reported.
        instance: execute this one instead: {object: (x, y[, yaw])}, or the numbers of all objects
            in their order, as `placed` takes them.
        workers: processes; as many as processors if None.

    Raises:
        DrakeScrewError: the run cannot be read or has no demonstrations, the instance is not one,
            the model lacks inertia, or the folder cannot be written.
    """
    opened = open_run(run)
    setup, demonstrations = opened.setup, opened.demonstrations
    check_masses(setup)
    planner = setup.careful_planner

    def plan(x_y_yaw: Array) -> Outcomes:
        X_WO = setup.area.X_WO(x_y_yaw)
        return planner.any_success(demonstrations, X_WO, setup.workcell.start)

    if instance is None:
        x_y_yaw, outcomes = _fresh_instances(setup, plan, per_region)
    else:
        x_y_yaw = placed(setup.area, instance)[None]
        outcomes = plan(x_y_yaw)
    X_WO = setup.area.X_WO(x_y_yaw)
    solved = np.flatnonzero(outcomes.any_success).tolist()
    best = {i: setup.plan(demonstrations, x_y_yaw[i], most=1) for i in solved}
    jobs = [Job(best[i].plan, X_WO[i]) for i in solved]
    config = StationConfig(setup.robot, setup.table, setup.objects, setup.obstacles)
    done = dict(zip(solved, execute_all(config, jobs, workers=workers), strict=True))
    trials = []
    for i, place in enumerate(x_y_yaw):
        region = int(setup.regions.index(place))
        if i in done:
            name, turned = best[i].demonstration.name, best[i].turned
            angles = tuple((turn.body, turn.angle) for turn in turned)
            trials.append(Trial(region, place, name, "", done[i], angles))
        else:
            why = why_not(outcomes[i], demonstrations, X_WO[i], setup.workcell.start, planner)
            trials.append(Trial(region, place, "", why, None))
    found = summarize(trials)

    def fill(folder: Path) -> None:
        (folder / "executions.csv").write_text(trials_csv(trials, setup.area))
        (folder / "summary.txt").write_text(f"{found}\n")
        shown = [
            (trial.execution, setup.area.X_WO(trial.x_y_yaw))
            for trial in _chosen(trials)
            if trial.execution is not None
        ]
        if shown:
            with scratch():
                page = recording_html(
                    shown,
                    setup.robot,
                    table=setup.table,
                    objects=setup.objects,
                    obstacles=setup.obstacles,
                )
            (folder / "executions.html").write_text(page)

    folder = fresh_folder(opened.directory.path / "executions")
    remedy = "Executions are written beside the run; make its folder writable."
    with writing(folder, remedy):
        write_folder(folder, fill)
    return Executions(folder, _assumed(setup), found)


def station_graphviz(run: PathLike, *, planning: bool = False) -> str:
    """The simulated diagram of a run as GraphViz text.

    Args:
        run: its directory.
        planning: with a planner in it, as `planning_station` has it.

    Raises:
        DrakeScrewError: the run cannot be read, or there is nothing to plan with.
    """
    opened = open_run(run)
    setup = opened.setup
    if planning:
        return planning_station(setup, opened.demonstrations).graphviz
    return build_station(
        setup.robot, table=setup.table, objects=setup.objects, obstacles=setup.obstacles
    ).graphviz


def planning_station(
    setup: Setup,
    demonstrations: Sequence[Demonstration],
    *,
    limits: TimeLimits | None = None,
    meshcat: Meshcat | None = None,
) -> Station:
    """A station that plans for itself: plant, planner and executor in one diagram.

    Args:
        setup: of the scenario.
        demonstrations: to plan with.
        limits: how fast plans are executed.
        meshcat: to draw the simulation in.

    Raises:
        DrakeScrewError: the model lacks inertia.
    """
    check_masses(setup)
    planner = ScrewPlanner(PlanChooser(setup, demonstrations), limits=limits)
    return build_station(
        setup.robot,
        table=setup.table,
        objects=setup.objects,
        obstacles=setup.obstacles,
        planner=planner,
        meshcat=meshcat,
    )


def check_masses(setup: Setup) -> None:
    """Make sure that the robot can be simulated.

    Raises:
        ModelError: a joint moves nothing that has inertia.
    """
    workcell = setup.workcell
    positions = workcell.arm.full_positions(workcell.start)
    found = immovable(workcell.plant, workcell.robot, positions)
    if found is not None:
        joint, links = found
        named = (
            f"its links {', '.join(links)} have no mass" if links else "none has any about its axis"
        )
        raise ModelError(
            f"joint '{joint}' cannot be driven: what it moves has no inertia; {named}",
            remedy="Give the links an <inertial> with mass and inertia; planning does without.",
            file=workcell.model_file,
        )


def _assumed(setup: Setup) -> tuple[str, ...]:
    arm, workcell = setup.workcell.arm, setup.workcell
    motors = assumed_motors(workcell.plant, workcell.robot, arm.joint_names)
    return (*arm.assumptions, *motors)


def _fresh_instances(
    setup: Setup, plan: Callable[[Array], Outcomes], per_region: int
) -> tuple[Array, Outcomes]:
    """Instances (N, k, 3) drawn region by region until so many are solved, and all outcomes.

    Those without a plan stay among them; a region gives up after TRIES times as many draws.
    """
    regions = setup.regions
    drawn, missing = np.zeros(regions.K, dtype=int), np.full(regions.K, per_region)
    places, outcomes = [], []
    while missing.any():
        x_y_yaw, region = draw_in_all(
            regions, missing, seed=setup.scenario.seed, round=ROUND, starts=drawn
        )
        planned = plan(x_y_yaw)
        places.append(x_y_yaw)
        outcomes.append(planned)
        drawn += missing
        missing -= np.bincount(region[planned.any_success], minlength=regions.K)
        missing[drawn >= TRIES * per_region] = 0
    x_y_yaw = np.concatenate(places)
    order = np.argsort(regions.index(x_y_yaw), kind="stable")
    return x_y_yaw[order], concatenate(outcomes)[order]


def _chosen(trials: Sequence[Trial]) -> list[Trial]:
    """What is worth looking at: what went wrong, the worst tracked, then some from all over."""
    executed = [trial for trial in trials if trial.report is not None]

    def badness(trial: Trial) -> tuple[bool, float]:
        assert trial.report is not None
        return not trial.report.flawless, trial.report.tracking.position

    worst = sorted(executed, key=badness, reverse=True)[: SHOWN // 2]
    rest = [trial for trial in executed if trial not in worst]
    return worst + rest[:: max(1, -(-len(rest) // (SHOWN - len(worst))))]
