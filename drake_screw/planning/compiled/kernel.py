"""The batch planner's kernel: plans for many instances at once on the compiled code of an arm."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from drake_screw.planning.compiled import arm_module
from drake_screw.planning.compiled.check import Check
from drake_screw.planning.compiled.lanes import Answers, Bounds, Places, Problem
from drake_screw.planning.compiled.link_frames import link_frames
from drake_screw.planning.compiled.rows import LANES, Rows
from drake_screw.planning.compiled.step_code import Settings
from drake_screw.planning.compiled.trace import ALL, SUCCESSES, Trace, new_trace
from drake_screw.planning.outcomes import Cause
from drake_screw.planning.roll import free_frame

_LOG = logging.getLogger(__name__)

Array = NDArray[np.float64]
T = TypeVar("T")

CHUNK = 2048
"""Plans, about, that a thread takes at a time."""

LIKELY = 4
"""Plans, about, in a run of several before one succeeds."""

TRACED = 256
"""Plans that a thread takes at a time where their steps are written down."""

ROOM = 64
"""Steps of a plan that room is kept for, at first."""

Order = Callable[[Array], NDArray[np.int64]]
"""From object poses (N, k, 4, 4) to the order (N, D) in which demonstrations are tried."""

Place = Callable[[Array], Array]
"""From object poses (N, k, 4, 4) to the frames (N, m, 4, 4) that guiding poses belong to."""


def _as_they_are(X_WO: Array) -> Array:
    return X_WO


class Kernel:
    """Compiled planner of one arm.

    Args:
        screws: (n, 6) screws [w; v] of the joints at q = 0 in W about its origin.
        home: (4, 4) X_WE at q = 0.
        lower, upper: (n,) joint limits, rad or m.
        settings: of the integrator.
        free_axis: (3,) in E, about which the end effector's roll is free; None where none is.
    """

    def __init__(
        self,
        screws: Array,
        home: Array,
        lower: Array,
        upper: Array,
        settings: Settings | None = None,
        free_axis: Array | None = None,
    ) -> None:
        settings = settings or Settings()
        self._X_EF = None if free_axis is None else free_frame(free_axis)
        if self._X_EF is not None:
            settings, home = replace(settings, roll_free=True), home @ self._X_EF
        frames = link_frames(screws, home)
        programs, self._count = arm_module.programs(frames, lower, upper, settings)
        self._module = arm_module.load(programs)
        self._n = len(screws)
        rows = Rows(self._n, settings.directions)
        self._rows = Places(rows.q, rows.q_stage, rows.kept, self._count)
        self._X_BW = np.linalg.inv(frames.X_WB)
        self._bounds = Bounds(
            np.array([lower, upper], dtype=float),
            settings.rate_max**2,
            settings.residual_max**2,
            settings.step_min,
        )

    @property
    def compiled(self) -> bool:
        """Whether the arm's machine code is in the cache; if not, the first plan waits for it."""
        return arm_module.is_compiled(self._module)

    def tell_of_compiling(self) -> None:
        """Log that the first plan has to wait, if it has."""
        if not self.compiled:
            _LOG.info("compiling the planner for this arm, once; this takes a few seconds")

    def plan(
        self,
        X_OE: Sequence[Array],
        objects: Sequence[NDArray[np.int64]],
        X_WO: Array,
        q_start: Array,
        order: Order | None = None,
        *,
        run: int = 1,
        begins: NDArray[np.int64] | None = None,
        place: Place = _as_they_are,
        check: Check | None = None,
        threads: int | None = None,
    ) -> list[Answers]:
        """Plans for N instances with D demonstrations.

        Args:
            X_OE: guiding poses (g, 4, 4) of each demonstration in the frame of their object, g > 0.
            objects: (g,) index of that object, for each demonstration.
            X_WO: (N, k, 4, 4) object poses.
            q_start: (n,) start configuration, inside the limits; or several, (S, n).
            order: in which to try the demonstrations; as given if None.
            run: leave out the demonstrations after the first that succeeds, in each run of so many
                in that order; D is a multiple of it.
            begins: (D,) which start configuration each demonstration begins at; the only one if
                None.
            place: takes X_WO (m, k, 4, 4) to the frames that `objects` are indices of.
            check: says which successes touch something: those are COLLISION, and the run goes on.
                It is called from several threads at once.
            threads: to use; all processors if None.

        Returns:
            Answers (m, D) for successive instances.
        """
        N, D, nothing = len(X_WO), len(X_OE), new_trace(self._n)
        if N == 0 or D == 0:
            return [_unanswered(N, D, nothing)]
        problem = self._problem(X_OE, objects, q_start, begins)
        as_given = np.arange(D)[None]

        def work(part: slice) -> Answers:
            own = X_WO[part]
            answers = _unanswered(len(own), D, nothing)
            tried = as_given if order is None else np.ascontiguousarray(order(own))
            ends = np.arange(run, len(own) * D + 1, run)
            units, frames = np.column_stack([ends - run, ends]), place(own)
            if check is None:
                self._run(problem, frames, tried, units, answers)
                return answers
            while len(units) > 0:
                trace = self._traced(SUCCESSES, problem, frames, tried, units, answers)
                found = check(own, trace)
                i, d = trace.plan[found.touches].T
                answers.cause[i, d] = Cause.COLLISION
                answers.segment[i, d] = found.segment[found.touches]
                answers.fraction[i, d] = found.fraction[found.touches]
                answers.pair[i, d] = found.pair[found.touches]
                rank = (np.broadcast_to(tried, (len(own), D))[i] == d[:, None]).argmax(axis=1)
                following = i * D + rank + 1
                units = np.column_stack([following, -(-following // run) * run])
                units = units[following % run > 0]
            return answers

        likely = D if run == 1 else D // run * LIKELY
        found = _share(work, _parts(N, max(LANES, CHUNK // likely)), threads)
        arm_module.mark_compiled(self._module)
        return found

    def trace(
        self,
        X_OE: Sequence[Array],
        objects: Sequence[NDArray[np.int64]],
        X_WO: Array,
        q_start: Array,
        which: NDArray[np.int64],
        *,
        begins: NDArray[np.int64] | None = None,
        place: Place = _as_they_are,
        threads: int | None = None,
    ) -> list[Answers]:
        """Plans for N instances, each with one demonstration, and the steps that were taken.

        A lane's arithmetic does not depend on its neighbours: they are also those of `plan`.

        Args:
            X_OE, objects, X_WO, q_start, begins, place, threads: as for `plan`.
            which: (N,) the demonstration of each instance.

        Returns:
            Answers (m, 1) with the trace of their steps, for successive instances.
        """
        problem = self._problem(X_OE, objects, q_start, begins)
        tried = np.ascontiguousarray(which, dtype=np.int64)[:, None]

        def work(part: slice) -> Answers:
            own = tried[part]
            N, D = len(own), len(X_OE)
            answers = _unanswered(N, D, new_trace(self._n))
            units = np.arange(N)[:, None] + np.array([0, 1])
            trace = self._traced(ALL, problem, place(X_WO[part]), own, units, answers)
            trace = trace.of(np.argsort(trace.plan[:, 0]))
            return answers.part((np.arange(N)[:, None], own))._replace(trace=trace)

        traced = _share(work, _parts(len(X_WO), TRACED), threads)
        arm_module.mark_compiled(self._module)
        return traced

    def _problem(
        self,
        X_OE: Sequence[Array],
        objects: Sequence[NDArray[np.int64]],
        q_start: Array,
        begins: NDArray[np.int64] | None,
    ) -> Problem:
        """The part of a problem that all instances have in common; X_BO and order are empty."""
        guides = np.concatenate(X_OE).astype(float, order="C")
        return Problem(
            np.empty((0, 0, 4, 4)),
            guides if self._X_EF is None else np.ascontiguousarray(guides @ self._X_EF),
            np.concatenate(objects).astype(np.int64, order="C"),
            np.cumsum([0, *map(len, X_OE)], dtype=np.int64),
            np.empty((0, 0), dtype=np.int64),
            np.stack([self._start(q) for q in np.atleast_2d(q_start)]),
            np.zeros(len(X_OE), dtype=np.int64) if begins is None else begins,
            self._bounds,
            self._X_EF is not None,
        )

    def _traced(
        self,
        keep: int,
        problem: Problem,
        frames: Array,
        order: NDArray[np.int64],
        units: NDArray[np.int64],
        answers: Answers,
    ) -> Trace:
        """As `_run`; the plans whose steps are to be kept, in the order in which they ended."""
        most, per_plan = ROOM, 1
        while True:
            trace = new_trace(self._n, keep, plans=len(units), most=most, times=per_plan)
            self._run(problem, frames, order, units, answers._replace(trace=trace))
            if trace.used[2] == 0:
                return trace.done()
            most, per_plan = 4 * most, 4 * per_plan

    def _run(
        self,
        problem: Problem,
        frames: Array,
        order: NDArray[np.int64],
        units: NDArray[np.int64],
        answers: Answers,
    ) -> None:
        """Fill in answers.

        Args:
            problem: what all instances have in common.
            frames: (N, k, 4, 4) that guiding poses belong to.
            order: (N or 1, D) of demonstrations.
            units: (U, 2) items of work that end with the first success: the first of each, and the
                one after its last. An item is an instance's number times D, plus a rank.
            answers: to fill in.
        """
        problem = problem._replace(X_BO=np.ascontiguousarray(self._X_BW @ frames), order=order)
        b, lanes = np.zeros(self._count * LANES), np.zeros((LANES, 8), dtype=np.int64)
        queue = np.zeros(1, dtype=np.int64)
        self._module.run(b, lanes, queue, units, self._rows, problem, answers)

    def _start(self, q_start: Array) -> Array:
        """What lanes load to start a plan: see `lanes.load_start`."""
        start = np.empty(len(q_start) + 12 + self._count - self._rows.kept)
        b = np.zeros(self._count * LANES)
        self._module.prepare(b, self._rows, np.array(q_start, dtype=float), start)
        return start


def _unanswered(N: int, D: int, trace: Trace) -> Answers:
    """Answers of which none is given yet."""
    return Answers(
        np.full((N, D), Cause.NOT_TRIED, dtype=np.uint8),
        np.full((N, D), -1, dtype=np.int16),
        np.full((N, D), -1, dtype=np.int8),
        np.zeros((N, D), dtype=np.float32),
        np.full((N, D), -1, dtype=np.int16),
        np.zeros((N, D), dtype=np.int32),
        trace,
    )


def _parts(N: int, size: int) -> list[slice]:
    return [slice(begin, min(begin + size, N)) for begin in range(0, N, size)]


def _share(work: Callable[[slice], T], parts: Sequence[slice], threads: int | None) -> list[T]:
    """Work on parts, shared out among threads; what comes of each, in order."""
    if threads == 1 or len(parts) == 1:
        return [work(part) for part in parts]
    with ThreadPoolExecutor(threads or os.cpu_count()) as pool:
        return list(pool.map(work, parts))
