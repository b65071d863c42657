"""Many executions in parallel processes, each with a station of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from drake_screw.errors import ModelError
from drake_screw.execution.allowed import Allowed, said
from drake_screw.execution.simulate import Execution, simulate
from drake_screw.execution.station import Station, build_station
from drake_screw.execution.timing import TimedPlan, TimeLimits, time_plan
from drake_screw.planning import Plan
from drake_screw.robot import ObjectConfig, ObstacleConfig, RobotConfig, TableConfig
from drake_screw.sharing import Workers, share_out
from drake_screw.typing import Array

KEPT = 8  # of that many samples of a log, one comes back from another process


@dataclass(frozen=True, eq=False)
class Job:
    """Something to execute.

    Attributes:
        plan: one that succeeded.
        X_WO: (k, 4, 4) where the objects are.
        joint_offset: (n,) rad or m, how far the arm's joints are beyond what its encoders say; None
            for not at all.
        wanted: (g, 4, 4) where guiding poses ought to be, given where the objects are; the plan's
            own if None.
    """

    plan: Plan
    X_WO: Array
    joint_offset: Array | None = None
    wanted: Array | None = None


@dataclass(frozen=True)
class StationConfig:
    """What a process needs to build its station; unlike a plant, it can be sent.

    Attributes:
        robot, table, objects, obstacles: of the workcell.
        limits: how fast plans are executed.
        free_objects: whether objects can be pushed.
        allowed: what an execution may do and be flawless.
        model: hash of the robot's model that plans were made with; None where it does not matter.
    """

    robot: RobotConfig
    table: TableConfig | None = None
    objects: tuple[ObjectConfig, ...] = ()
    obstacles: tuple[ObstacleConfig, ...] = ()
    limits: TimeLimits = field(default_factory=TimeLimits)
    free_objects: bool = False
    allowed: Allowed = field(default_factory=Allowed)
    model: str | None = None

    def build(self) -> Station:
        """The station."""
        return build_station(
            self.robot,
            table=self.table,
            objects=self.objects,
            obstacles=self.obstacles,
            free_objects=self.free_objects,
        )


@dataclass(frozen=True)
class Bench:
    """What a process executes plans with."""

    config: StationConfig
    station: Station

    @classmethod
    def of(cls, config: StationConfig) -> Bench:
        """Built for this process.

        Raises:
            ModelError: the model cannot be read here, or is another one than plans were made with.
        """
        station = config.build()
        if config.model not in (None, station.model):
            raise ModelError(
                "the robot's model is not the one that plans were made with",
                file=config.robot.model,
            )
        return cls(config, station)


def execute_all(
    config: StationConfig,
    jobs: Sequence[Job],
    *,
    workers: Workers = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Execution, ...]:
    """Time and simulate plans.

    Args:
        config: the station that each process builds once.
        jobs: what to do.
        workers: number of processes, as many as processors if None, none but this one if 1; or a
            cluster.
        progress: called with how many are done and how many there are, at first with none.

    Returns:
        The execution of each job, in order, thinned out.

    Raises:
        SharingError: processes were killed, or a cluster is lost.
    """
    tell = progress or (lambda done, total: None)
    tell(0, len(jobs))
    executed: dict[int, Execution] = {}
    for place, done in share_out(carry_out, jobs, build=partial(Bench.of, config), workers=workers):
        executed[place] = done
        tell(len(executed), len(jobs))
    return tuple(executed[place] for place in range(len(jobs)))


def carry_out(bench: Bench, job: Job) -> Execution:
    """Time and simulate one plan; its logs are thinned out."""
    done, _ = _simulated(bench, job)
    return done.thinned(KEPT)


@dataclass(frozen=True)
class Judged:
    """What an execution came to, in few numbers.

    Attributes:
        flaw: what explains most of what went wrong, a `Flaw` by its text; "" where nothing did.
        words: all that went wrong.
        segment: the screw segment in which that was first seen, from 0; the last one if nothing.
        fraction: how much of that segment was done, 0 to 1.
        position, rotation: m and rad, greatest distance of the end effector from where it ought to
            be at that time.
        displacement, turn: m and rad, that an object was moved at most.
        force: N, greatest with which the robot touched something.
    """

    flaw: str
    words: str
    segment: int
    fraction: float
    position: float
    rotation: float
    displacement: float
    turn: float
    force: float


def judge(bench: Bench, job: Job) -> Judged:
    """Time and simulate one plan, and say how it went."""
    done, timed = _simulated(bench, job)
    report = done.report
    flaw = report.flaws[0] if report.flaws else None
    end = timed.duration if flaw is None or flaw.time is None else flaw.time
    at = timed.at(end)
    return Judged(
        flaw="" if flaw is None else flaw.kind.value,
        words=said(report.flaws),
        segment=at.segment,
        fraction=min(max(at.s, 0.0), 1.0),
        position=report.tracking.position,
        rotation=report.tracking.rotation,
        displacement=max((o.position for o in report.moved), default=0.0),
        turn=max((o.rotation for o in report.moved), default=0.0),
        force=report.force,
    )


def _simulated(bench: Bench, job: Job) -> tuple[Execution, TimedPlan]:
    station, plan, limits = bench.station, job.plan, bench.config.limits
    start = station.arm.pose(plan.q[:1])
    timed = time_plan(plan, np.concatenate([start, plan.guides]), station.arm, limits)
    wanted = None if job.wanted is None else timed.moved(np.concatenate([start, job.wanted]))
    done = simulate(
        station, timed, job.X_WO,
        joint_offset=job.joint_offset, wanted=wanted, allowed=bench.config.allowed,
    )  # fmt: skip
    return done, timed
