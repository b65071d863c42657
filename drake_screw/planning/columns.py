"""Every turn of every demonstration as a column of its own, for the kernel to try."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.planning.compiled import Answers
from drake_screw.planning.outcomes import Cause, Outcomes, concatenate, one_outcome
from drake_screw.planning.symmetry import Symmetries
from drake_screw.typing import Array


@dataclass(frozen=True, eq=False)
class Columns:
    """The turns of D demonstrations, those of one after those of another, C in all.

    Attributes:
        X_OE: C arrays (g, 4, 4), guiding poses in the frames that `poses` gives.
        objects: C arrays (g,), which of those frames each belongs to.
        first: (D + 1,) the first column of each demonstration; the last entry is C.
        demonstrations: D of them.
        symmetries: say which turns there are.
    """

    X_OE: tuple[Array, ...]
    objects: tuple[NDArray[np.int64], ...]
    first: NDArray[np.int64]
    demonstrations: tuple[Demonstration, ...]
    symmetries: Symmetries

    @staticmethod
    def of(demonstrations: Sequence[Demonstration], symmetries: Symmetries, k: int) -> Columns:
        """The columns of demonstrations, for instances of k objects."""
        counts = [symmetries.count(d) for d in demonstrations]
        first = np.cumsum([0, *counts], dtype=np.int64)
        if all(count == 1 for count in counts):
            X_OE = [d.X_OE for d in demonstrations]
            objects = [d.objects for d in demonstrations]
        else:
            X_OE = [X for d in demonstrations for X in symmetries.variants(d, k)]
            objects = [
                k * number + d.objects
                for number, d in enumerate(demonstrations)
                for _ in range(counts[number])
            ]
        return Columns(tuple(X_OE), tuple(objects), first, tuple(demonstrations), symmetries)

    @property
    def counts(self) -> NDArray[np.int64]:
        """(D,) turns of each demonstration."""
        return np.diff(self.first)

    @property
    def plain(self) -> bool:
        """Whether nothing turns, so that columns are demonstrations."""
        return len(self.X_OE) == len(self.demonstrations)

    def poses(self, X_WO: Array) -> Array:
        """Frames that guiding poses belong to: objects as each demonstration turns them first.

        Args:
            X_WO: (N, k, 4, 4).

        Returns:
            (N, k, 4, 4) the objects themselves where nothing turns, else (N, D k, 4, 4).
        """
        if self.plain:
            return X_WO
        turned = [
            self.symmetries.turned(X_WO, self.symmetries.first(d, X_WO)[..., :-1])
            for d in self.demonstrations
        ]
        return np.concatenate(turned, axis=1)

    def in_order(self, order: NDArray[np.int64]) -> NDArray[np.int64]:
        """The order (N, C) in which to try columns, of the order (N, D) of demonstrations.

        All are tried as they are turned first, then all as they are turned second, and so on.
        """
        if self.plain:
            return order
        turn = np.arange(self.counts.max())
        columns = (self.first[order][:, None, :] + turn[:, None]).reshape(len(order), -1)
        there = (turn[:, None] < self.counts[order][:, None, :]).reshape(len(order), -1)
        return columns if there.all() else columns[there].reshape(len(order), -1)

    def outcomes(self, answers: Answers) -> Outcomes:
        """Outcomes (N, D) of answers (N, C): of each demonstration its best attempt.

        A demonstration without success is NOT_TRIED unless all its turns were tried.
        """
        found = every_turn(answers)
        if self.plain:
            return found
        N, D = len(answers.cause), len(self.demonstrations)
        if len(np.unique(self.counts)) == 1:
            return best_turn(found.reshape((N, D, int(self.counts[0]))))
        ends = zip(self.first[:-1], self.first[1:], strict=True)
        return concatenate([best_turn(found[:, a:b])[:, None] for a, b in ends], axis=1)


def every_turn(answers: Answers) -> Outcomes:
    """Outcomes (N, C) of answers (N, C); none says which turn it is of."""
    turn = np.zeros(answers.cause.shape, dtype=np.int16)
    return Outcomes(answers.cause, answers.segment, answers.joint, answers.fraction, turn)


def best_turn(outcomes: Outcomes) -> Outcomes:
    """Outcomes (...) of outcomes (..., T) of a demonstration's turns: of the first that succeeds.

    Where none does, of the one that came furthest; NOT_TRIED where some were not tried.
    """
    best = outcomes.best_attempt
    found = outcomes.take(np.maximum(best, 0))
    found = replace(found, turn=np.maximum(best, 0).astype(np.int16))
    undecided = ~found.success & (outcomes.cause == Cause.NOT_TRIED).any(axis=-1)
    return found.replaced(undecided, one_outcome(Cause.NOT_TRIED, fraction=0.0))
