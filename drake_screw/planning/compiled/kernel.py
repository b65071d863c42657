"""The batch planner's kernel: plans for many instances at once on the compiled code of an arm."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from drake_screw.planning.compiled import arm_module
from drake_screw.planning.compiled.lanes import Answers, Places, Problem
from drake_screw.planning.compiled.link_frames import link_frames
from drake_screw.planning.compiled.rows import LANES, Rows
from drake_screw.planning.compiled.step_code import Settings
from drake_screw.planning.outcomes import Cause

Array = NDArray[np.float64]

CHUNK = 256
"""Instances that a thread takes at a time."""


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
        text, self._count = arm_module.source(
            frames, list(map(float, lower)), list(map(float, upper)), settings
        )
        self._module = arm_module.load(text)
        rows = Rows(len(screws))
        self._rows = Places(rows.q, rows.q_stage, rows.kept, self._count)
        self._X_BW = np.linalg.inv(frames.X_WB)
        self._limits = np.array([lower, upper])
        self._rate_max2 = settings.rate_max**2

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
        order: NDArray[np.int64] | None = None,
        *,
        stop_at_success: bool = False,
        threads: int | None = None,
    ) -> Answers:
        """Plans for N instances with D demonstrations.

        Args:
            X_OE: guiding poses (g, 4, 4) of each demonstration in the frame of their object.
            objects: (g,) index of that object, for each demonstration.
            X_WO: (N, k, 4, 4) object poses.
            q_start: (n,) or (N, n) start configurations, inside the limits.
            order: (D,) or (N, D) order in which the demonstrations are tried.
            stop_at_success: leave out the demonstrations after the first that succeeds.
            threads: to use; all processors if None.
        """
        N, D = len(X_WO), len(X_OE)
        answers = Answers(
            np.full((N, D), Cause.NOT_TRIED, dtype=np.uint8),
            np.full((N, D), -1, dtype=np.int16),
            np.full((N, D), -1, dtype=np.int8),
            np.zeros((N, D), dtype=np.float32),
            np.zeros((N, D), dtype=np.int32),
        )
        if N == 0 or D == 0:
            return answers
        X_BO = np.ascontiguousarray(self._X_BW @ X_WO)
        order = np.atleast_2d(np.arange(D) if order is None else order).astype(np.int64, order="C")
        starts = np.atleast_2d(q_start).astype(float, order="C")
        first = np.cumsum([0, *map(len, X_OE)], dtype=np.int64)
        guides = np.concatenate(X_OE).astype(float, order="C")
        owners = np.concatenate(objects).astype(np.int64, order="C")
        size = D if stop_at_success else 1

        def work(begin: int) -> None:
            part = slice(begin, min(begin + CHUNK, N))
            own = Problem(
                X_BO[part],
                guides,
                owners,
                first,
                order if len(order) == 1 else order[part],
                self._starts(starts if len(starts) == 1 else starts[part]),
                self._limits,
                self._rate_max2,
            )
            queue = np.array([0, (part.stop - begin) * D // size, size])
            b, lanes = np.zeros(self._count * LANES), np.zeros((LANES, 7), dtype=np.int64)
            self._module.run(b, lanes, queue, self._rows, own, answers.part(part))

        chunks = range(0, N, CHUNK)
        if threads == 1:
            for begin in chunks:
                work(begin)
        else:
            with ThreadPoolExecutor(threads or os.cpu_count()) as pool:
                list(pool.map(work, chunks))
        arm_module.mark_compiled(self._module)
        return answers

    def _starts(self, q_start: Array) -> Array:
        n = q_start.shape[1]
        start = np.empty((len(q_start), n + 12 + self._count - self._rows.kept))
        b = np.zeros(self._count * LANES)
        self._module.prepare(b, self._rows, np.ascontiguousarray(q_start), start)
        return start
