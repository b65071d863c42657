"""Many executions in parallel processes, each with a station of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from drake_screw.execution.simulate import Execution, simulate
from drake_screw.execution.station import Station, build_station
from drake_screw.execution.timing import TimeLimits, time_plan
from drake_screw.planning import Plan
from drake_screw.processes import share_out
from drake_screw.robot import ObjectConfig, ObstacleConfig, RobotConfig, TableConfig
from drake_screw.typing import Array

KEPT = 8  # of that many samples of a log, one comes back from another process


@dataclass(frozen=True, eq=False)
class Job:
    """Something to execute.

    Attributes:
        plan: one that succeeded.
        X_WO: (k, 4, 4) where the objects are.
    """

    plan: Plan
    X_WO: Array


@dataclass(frozen=True)
class StationConfig:
    """What a process needs to build its station; unlike a plant, it can be sent.

    Attributes:
        robot, table, objects, obstacles: of the workcell.
        limits: how fast plans are executed.
    """

    robot: RobotConfig
    table: TableConfig | None = None
    objects: tuple[ObjectConfig, ...] = ()
    obstacles: tuple[ObstacleConfig, ...] = ()
    limits: TimeLimits = field(default_factory=TimeLimits)

    def build(self) -> Station:
        """The station."""
        return build_station(
            self.robot, table=self.table, objects=self.objects, obstacles=self.obstacles
        )


def execute_all(
    config: StationConfig, jobs: Sequence[Job], *, workers: int | None = None
) -> tuple[Execution, ...]:
    """Time and simulate plans.

    Args:
        config: the station that each process builds once.
        jobs: what to do.
        workers: number of processes; as many as processors if None, none but this one if 1.

    Returns:
        The execution of each job, in order, thinned out.

    Raises:
        WorkerLost: a process was killed.
    """
    shared = share_out(_execute, jobs, build=partial(_bench, config), workers=workers)
    done = dict(shared)
    return tuple(done[place] for place in range(len(jobs)))


def _bench(config: StationConfig) -> tuple[Station, TimeLimits]:
    return config.build(), config.limits


def _execute(bench: tuple[Station, TimeLimits], job: Job) -> Execution:
    station, limits = bench
    poses = np.concatenate([station.arm.pose(job.plan.q[:1]), job.plan.guides])
    timed = time_plan(job.plan, poses, station.arm, limits)
    done = simulate(station, timed, job.X_WO)
    kept = np.append(np.arange(0, len(done.t) - 1, KEPT), len(done.t) - 1)
    return replace(
        done, t=done.t[kept], q=done.q[kept], v=done.v[kept], q_desired=done.q_desired[kept]
    )
