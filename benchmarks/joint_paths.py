"""Joint paths of plans as Drake is asked about them: points so far apart as shapes travel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from drake_screw.planning.compiled.trace import dense_output
from drake_screw.planning.swept import SweptChecker, Touched
from drake_screw.typing import Array

PARTS = 2.0
"""Into which a motion of the joints by the spacing, in rad summed up, is divided; of each part the
travel is measured."""


class Noted(SweptChecker):
    """A checker that notes all that it is asked, and what it answers.

    Attributes:
        noted: steps (T, 5, n), where each path's begin, objects and first touches of each call.
        in_doubt: configurations that Drake was asked about, of each path that was left open.
    """

    def __init__(self, *arguments: object, keep: bool = True) -> None:
        super().__init__(*arguments)  # type: ignore[arg-type]
        self.keep = keep
        self.noted: list[tuple[Array, NDArray[np.int64], Array, Touched]] = []
        self.in_doubt: list[int] = []
        self.paths: list[int] = []

    def along(self, q: Array, first: NDArray[np.int64], X_WO: Array) -> Touched:
        found = super().along(q, first, X_WO)
        self.paths.append(len(X_WO))
        if self.keep:
            self.noted.append((q.copy(), first.copy(), X_WO.copy(), found))
        return found

    def touches(self, q: Array, X_WO: Array) -> NDArray[np.bool_]:
        self.in_doubt.append(len(q))
        return super().touches(q, X_WO)


@dataclass(frozen=True)
class Spacing:
    """Points of a path at a spacing of travel.

    Attributes:
        checker: of the workcell.
        spacing: m, that a point of the arm's shapes travels from one to the next, at most.
    """

    checker: SweptChecker
    spacing: float

    def __call__(self, steps: Array) -> tuple[Array, Array]:
        """Points (m, n) of the steps (t, 5, n) of a path, its ends among them; travel (m,) so far.

        A point of a shape travels no farther between two of them than the difference, in m.
        """
        motion = np.abs(steps[:, 1] - steps[:, 0]).sum(axis=1) + np.abs(steps[:, 4]).sum(axis=1)
        parts = 2 + (PARTS * motion / self.spacing).astype(np.int64)
        step = np.repeat(np.arange(len(steps)), parts)
        u = np.concatenate([np.linspace(0.0, 1.0, count) for count in parts])
        q = np.clip(dense_output(steps[step], u), *self.checker.cell.limits)
        gone = np.concatenate([[0.0], np.cumsum(self._travel(q))])
        number = np.floor(gone / self.spacing).astype(np.int64)
        kept = np.flatnonzero(np.diff(number, append=number[-1] + 1))
        kept = np.union1d([0], kept)
        return q[kept], gone[kept]

    def _travel(self, q: Array) -> Array:
        """How far (m - 1,) in m a point of any shape goes from one of q (m, n) to the next."""
        cell, chain = self.checker.cell, self.checker.workcell.arm.screw_chain()
        points = cell.centers.T[:, None] + cell.moved_reach[:, None, None] * np.eye(3)
        return _longest(chain.motions(q), cell.moved_joint, points)


@njit(error_model="numpy")
def _longest(E, joint, points):  # type: ignore[no-untyped-def]
    """The longest way (N - 1,) of points (M, 3, 3) that joints move, by E (n, N, 4, 4)."""
    longest = np.zeros(E.shape[1] - 1)
    for m in range(len(joint)):
        for k in range(3):
            x, y, z = points[m, k]
            before = np.zeros(3)
            for i in range(E.shape[1]):
                way = 0.0
                for axis in range(3):
                    a = E[joint[m], i, axis]
                    at = a[0] * x + a[1] * y + a[2] * z + a[3]
                    way += (at - before[axis]) ** 2
                    before[axis] = at
                if i > 0:
                    longest[i - 1] = max(longest[i - 1], way**0.5)
    return longest
