"""Execute plans of a run in simulation: fresh instances, or one place of the user's own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from pydrake.geometry import Meshcat

from drake_screw.assembly.placing import InstanceLike, placed
from drake_screw.assembly.plan_chooser import PlanChooser
from drake_screw.assembly.ranked_plans import RankedPlan
from drake_screw.assembly.setup import Setup
from drake_screw.assembly.stations import check_masses, check_standing, station_config
from drake_screw.assembly.ways import why_failed
from drake_screw.demonstrations import Demonstration
from drake_screw.execution import (
    ScrewPlanner,
    Station,
    TimeLimits,
    build_station,
)
from drake_screw.execution.motors import assumed_motors
from drake_screw.execution.parallel import Job, execute_all
from drake_screw.execution.simulate import Execution
from drake_screw.execution.trials import Trial, TrialSummary, summarize, trials_csv
from drake_screw.files import fresh_folder, write_folder, writing
from drake_screw.planning import Outcomes, concatenate
from drake_screw.runs.executions_page import executions_page
from drake_screw.runs.run import Run, open_run
from drake_screw.sharing import Workers
from drake_screw.steps import Step, Tell, to_nobody
from drake_screw.tasks import draw_in_all
from drake_screw.typing import Array, PathLike
from drake_screw.visualization.object_looks import bowl_look

ROUND = 1_000_000
"""The round whose instances are executed. No run gets that far, so they are fresh."""

TRIES = 20  # times as many instances are drawn in a region at most as are wanted
_UNWRITABLE = "Executions are written beside the run; make its folder writable."


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
    workers: Workers = None,
    free_objects: bool = False,
    tell: Tell = to_nobody,
) -> Executions:
    """Plan, simulate and report executions of a run.

    Of every instance the best plan with the run's demonstrations is simulated: that with the
    largest margin to the joint limits which touches nothing, of several arms that of the best; the
    others hold their starts. A table, a summary and
    a recording that plays go into a new folder ``executions/<time>`` of the run.

    Args:
        run: its directory.
        per_region: executions in every region; instances without a plan are drawn again, and
            reported.
        instance: execute this one instead: {object: (x, y[, yaw])}, or as `placed` takes them.
        workers: processes, as many as processors if None; or a cluster.
        free_objects: objects can be pushed, and pushing one farther than the scenario's block
            `execution` allows is a flaw; else they are locked in place.
        tell: told how many are executed, and how many there are.

    Raises:
        DrakeScrewError: the run cannot be read or has no demonstrations, the instance is not one,
            the model lacks inertia, a free object has nothing to stand on, or the folder cannot be
            written.
    """
    opened = open_run(run)
    setup, demonstrations = opened.setup, opened.demonstrations
    for one in setup.arms:
        check_masses(one.workcell)
    place = None if instance is None else placed(setup.area, instance)
    if free_objects:
        check_standing(setup, station_config(setup, free_objects=True), place)
    planner = setup.planner_of_all(careful=True)

    def plan(coordinates: Array) -> Outcomes:
        X_WO = setup.area.X_WO(coordinates)
        return planner.any_success(demonstrations, X_WO, setup.start)

    if place is None:
        coordinates, outcomes = _fresh_instances(setup, plan, per_region)
    else:
        coordinates = place[None]
        outcomes = plan(coordinates)
    X_WO = setup.area.X_WO(coordinates)
    solved = np.flatnonzero(outcomes.any_success).tolist()
    best = {i: setup.plan(demonstrations, coordinates[i], most=1) for i in solved}
    parent = opened.directory.path / "executions"
    with writing(parent, _UNWRITABLE):  # before anything is simulated, which takes long
        folder = fresh_folder(parent)
    try:
        done = _executed(setup, best, X_WO, workers, tell, free_objects=free_objects)
        trials = _trials(opened, coordinates, outcomes, best, done)
        found = summarize(trials)
        with writing(folder, _UNWRITABLE):
            write_folder(folder, partial(_fill, setup, trials, found, free_objects=free_objects))
    except BaseException:
        with suppress(OSError):
            folder.rmdir()
            folder.parent.rmdir()
        raise
    return Executions(folder, _assumed(setup), found)


def _trials(
    opened: Run,
    coordinates: Array,
    outcomes: Outcomes,
    best: Mapping[int, RankedPlan],
    done: Mapping[int, Execution],
) -> list[Trial]:
    """What became of each instance."""
    setup, demonstrations = opened.setup, opened.demonstrations
    X_WO = setup.area.X_WO(coordinates)
    trials = []
    for i, place in enumerate(coordinates):
        region = int(setup.regions.index(place))
        if i in done:
            name, turned = best[i].demonstration.name, best[i].turned
            angles = tuple((turn.body, turn.angle) for turn in turned)
            of = best[i].arm_name or ""
            trials.append(Trial(region, place, name, "", done[i], angles, of))
        else:
            why = why_failed(setup.arms, outcomes[i], demonstrations, X_WO[i])
            trials.append(Trial(region, place, "", why, None))
    return trials


def _fill(
    setup: Setup, trials: Sequence[Trial], found: TrialSummary, folder: Path, *, free_objects: bool
) -> None:
    """Write the table, the summary and the page that plays them."""
    (folder / "executions.csv").write_text(trials_csv(trials, setup.area))
    (folder / "summary.txt").write_text(f"{found}\n")
    page = executions_page(setup, trials, free_objects=free_objects)
    if page is not None:
        (folder / "executions.html").write_text(page, encoding="utf-8")


def _executed(
    setup: Setup,
    best: Mapping[int, RankedPlan],
    X_WO: Array,
    workers: Workers,
    tell: Tell,
    *,
    free_objects: bool,
) -> dict[int, Execution]:
    """Executions of the best plans of instances, each in a station that moves the plan's arm."""
    done: dict[int, Execution] = {}

    def told(count: int, _: int, before: int) -> None:
        tell(Step("executed", before + count, len(best)))

    for one in setup.arms:
        own = [i for i, plan in best.items() if plan.arm is one.arm]
        if own:
            config = station_config(setup, one.robot, free_objects=free_objects)
            jobs = [Job(best[i].plan, X_WO[i]) for i in own]
            progress = partial(told, before=len(done))
            executed = execute_all(config, jobs, workers=workers, progress=progress)
            done |= dict(zip(own, executed, strict=True))
    return done


def station_graphviz(run: PathLike, *, free_objects: bool = False, planning: bool = False) -> str:
    """The simulated diagram of a run as GraphViz text.

    Args:
        run: its directory.
        planning: with a planner in it, as `planning_station` has it.

    Raises:
        DrakeScrewError: the run cannot be read, or there is nothing to plan with.
    """
    opened = open_run(run)
    if planning:
        return planning_station(opened.setup, opened.demonstrations).graphviz
    return station_config(opened.setup, free_objects=free_objects).build().graphviz


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
        DrakeScrewError: the model lacks inertia, or there are several arms.
    """
    check_masses(setup.workcell)
    planner = ScrewPlanner(PlanChooser(setup, demonstrations), limits=limits)
    return build_station(
        setup.robot,
        table=setup.table,
        objects=setup.objects,
        obstacles=setup.obstacles,
        planner=planner,
        meshcat=meshcat,
        looks=None if meshcat is None else [bowl_look(item) for item in setup.objects],
    )


def _assumed(setup: Setup) -> tuple[str, ...]:
    workcell = setup.workcell
    moved = [name for one in setup.arms for name in one.arm.joint_names]
    return (*setup.assumptions, *assumed_motors(workcell.plant, workcell.robot, moved))


def _fresh_instances(
    setup: Setup, plan: Callable[[Array], Outcomes], per_region: int
) -> tuple[Array, Outcomes]:
    """Instances (N, k, c) drawn region by region until so many are solved, and all outcomes.

    Those without a plan stay among them; a region gives up after TRIES times as many draws.
    """
    regions = setup.regions
    drawn, missing = np.zeros(regions.K, dtype=int), np.full(regions.K, per_region)
    places, outcomes = [], []
    while missing.any():
        coordinates, region = draw_in_all(
            regions, missing, seed=setup.scenario.seed, round=ROUND, starts=drawn
        )
        planned = plan(coordinates)
        places.append(coordinates)
        outcomes.append(planned)
        drawn += missing
        missing -= np.bincount(region[planned.any_success], minlength=regions.K)
        missing[drawn >= TRIES * per_region] = 0
    coordinates = np.concatenate(places)
    order = np.argsort(regions.index(coordinates), kind="stable")
    return coordinates[order], concatenate(outcomes)[order]
