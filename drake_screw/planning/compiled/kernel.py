"""The batch planner's kernel: plans for many instances at once on the compiled code of an arm."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from drake_screw.planning.compiled import arm_module
from drake_screw.planning.compiled.lanes import Answers, Bounds, Places, Problem
from drake_screw.planning.compiled.link_frames import link_frames
from drake_screw.planning.compiled.rows import LANES, Rows
from drake_screw.planning.compiled.step_code import Settings
from drake_screw.planning.outcomes import Cause

Array = NDArray[np.float64]

CHUNK = 2048
"""Plans, about, that a thread takes at a time."""

Order = Callable[[Array], NDArray[np.int64]]
"""From object poses (N, k, 4, 4) to the order (N, D) in which demonstrations are tried."""


class Kernel:
    """Compiled planner of one arm.

    Args:
        screws: (n, 6) screws [w; v] of the joints at q = 0 in W about its origin.
        home: (4, 4) X_WE at q = 0.
        lower, upper: (n,) joint limits, rad or m.
        settings: of the integrator.
    """

    def __init__(
        self,
        screws: Array,
        home: Array,
        lower: Array,
        upper: Array,
        settings: Settings | None = None,
    ) -> None:
        settings = settings or Settings()
        frames = link_frames(screws, home)
        programs, self._count = arm_module.programs(frames, lower, upper, settings)
        self._module = arm_module.load(programs)
        rows = Rows(len(screws))
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

    def plan(
        self,
        X_OE: Sequence[Array],
        objects: Sequence[NDArray[np.int64]],
        X_WO: Array,
        q_start: Array,
        order: Order | None = None,
        *,
        stop_at_success: bool = False,
        keep_ends: bool = False,
        threads: int | None = None,
    ) -> Answers:
        """Plans for N instances with D demonstrations.

        Args:
            X_OE: guiding poses (g, 4, 4) of each demonstration in the frame of their object, g > 0.
            objects: (g,) index of that object, for each demonstration.
            X_WO: (N, k, 4, 4) object poses.
            q_start: (n,) start configuration, inside the limits.
            order: in which to try the demonstrations; as given if None.
            stop_at_success: leave out the demonstrations after the first that succeeds.
            keep_ends: fill in the answers' `end`.
            threads: to use; all processors if None.
        """
        N, D = len(X_WO), len(X_OE)
        answers = Answers(
            np.full((N, D), Cause.NOT_TRIED, dtype=np.uint8),
            np.full((N, D), -1, dtype=np.int16),
            np.full((N, D), -1, dtype=np.int8),
            np.zeros((N, D), dtype=np.float32),
            np.zeros((N, D), dtype=np.int32),
            np.full((N if keep_ends else 0, D, len(q_start)), np.nan),
        )
        if N == 0 or D == 0:
            return answers
        first = np.cumsum([0, *map(len, X_OE)], dtype=np.int64)
        guides = np.concatenate(X_OE).astype(float, order="C")
        owners = np.concatenate(objects).astype(np.int64, order="C")
        start = self._start(q_start)
        as_given = np.arange(D)[None]
        size = D if stop_at_success else 1
        chunk = max(LANES, CHUNK // D)

        def work(begin: int) -> None:
            part = slice(begin, min(begin + chunk, N))
            X_BO = np.ascontiguousarray(self._X_BW @ X_WO[part])
            tried = as_given if order is None else np.ascontiguousarray(order(X_WO[part]))
            problem = Problem(X_BO, guides, owners, first, tried, start, self._bounds)
            queue = np.array([0, (part.stop - begin) * D // size, size])
            b, lanes = (np.zeros(self._count * LANES), np.zeros((LANES, 7), dtype=np.int64))
            self._module.run(b, lanes, queue, self._rows, problem, answers.part(part))

        chunks = range(0, N, chunk)
        if threads == 1 or len(chunks) == 1:
            for begin in chunks:
                work(begin)
        else:
            with ThreadPoolExecutor(threads or os.cpu_count()) as pool:
                list(pool.map(work, chunks))
        arm_module.mark_compiled(self._module)
        return answers

    def _start(self, q_start: Array) -> Array:
        """What lanes load to start a plan: see `lanes.load_start`."""
        start = np.empty(len(q_start) + 12 + self._count - self._rows.kept)
        b = np.zeros(self._count * LANES)
        self._module.prepare(b, self._rows, np.array(q_start, dtype=float), start)
        return start
