"""Every variant of every demonstration as a column of its own, for the kernel to try.

A variant is a turn of what is symmetric and, where the approach is free, a configuration from which
the first guiding pose is reached.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.planning.compiled import Answers
from drake_screw.planning.outcomes import Cause, Outcomes, concatenate, one_outcome
from drake_screw.planning.symmetry import Symmetries
from drake_screw.typing import Array


@dataclass(frozen=True, eq=False)
class Columns:
    """The variants of D demonstrations, those of one after those of another, C in all.

    A demonstration's variants are numbered by configuration, then by turn.

    Attributes:
        X_OE: C arrays (g, 4, 4), guiding poses in the frames that `poses` gives.
        objects: C arrays (g,), which of those frames each belongs to.
        begins: (C,) the configuration that each begins at: 0 for the arm's start, 1 and so on
            for those from which inverse kinematics sets out.
        first: (D + 1,) the first column of each demonstration; the last entry is C.
        starts: the configurations there are.
        demonstrations: D of them.
        symmetries: say which turns there are.
    """

    X_OE: tuple[Array, ...]
    objects: tuple[NDArray[np.int64], ...]
    begins: NDArray[np.int64]
    first: NDArray[np.int64]
    starts: range
    demonstrations: tuple[Demonstration, ...]
    symmetries: Symmetries

    @staticmethod
    def of(
        demonstrations: Sequence[Demonstration],
        symmetries: Symmetries,
        k: int,
        starts: range = range(1),
    ) -> Columns:
        """The columns of demonstrations, for instances of k objects, from some configurations."""
        turns = [symmetries.count(d) for d in demonstrations]
        fixed = all(count == 1 for count in turns)
        X_OE: list[Array] = []
        objects: list[NDArray[np.int64]] = []
        for number, d in enumerate(demonstrations):
            turned = [d.X_OE] if fixed else list(symmetries.variants(d, k))
            frames = d.objects if fixed else k * number + d.objects
            X_OE += len(starts) * turned
            objects += len(starts) * len(turned) * [frames]
        begins = [np.repeat(np.array(starts), count) for count in turns]
        return Columns(
            tuple(X_OE),
            tuple(objects),
            np.concatenate([*begins, np.zeros(0, dtype=np.int64)]).astype(np.int64),
            np.cumsum([0, *(len(starts) * count for count in turns)], dtype=np.int64),
            starts,
            tuple(demonstrations),
            symmetries,
        )

    @property
    def counts(self) -> NDArray[np.int64]:
        """(D,) columns of each demonstration."""
        return np.diff(self.first)

    @property
    def turns(self) -> NDArray[np.int64]:
        """(D,) turns of each demonstration."""
        return self.counts // len(self.starts)

    def poses(self, X_WO: Array) -> Array:
        """Frames that guiding poses belong to: objects as each demonstration turns them first.

        Args:
            X_WO: (N, k, 4, 4).

        Returns:
            (N, k, 4, 4) the objects themselves where nothing turns, else (N, D k, 4, 4).
        """
        if (self.turns == 1).all():
            return X_WO
        turned = [
            self.symmetries.turned(X_WO, self.symmetries.first(d, X_WO)[..., :-1])
            for d in self.demonstrations
        ]
        return np.concatenate(turned, axis=1)

    def in_order(self, order: NDArray[np.int64]) -> NDArray[np.int64]:
        """The order (N, C) in which to try columns, of the order (N, D) of demonstrations.

        The first variant of all is tried first, then the second one of all, and so on.
        """
        if len(self.X_OE) == len(self.demonstrations):
            return order
        variant = np.arange(self.counts.max())
        columns = (self.first[order][:, None, :] + variant[:, None]).reshape(len(order), -1)
        there = (variant[:, None] < self.counts[order][:, None, :]).reshape(len(order), -1)
        return columns if there.all() else columns[there].reshape(len(order), -1)

    def each(self, answers: Answers) -> Outcomes:
        """Outcomes (N, C) of answers (N, C).

        What fails on the way to the first guiding pose from another configuration than the arm's
        own has not come any way at all.
        """
        away = (answers.segment == 0) & (self.begins > 0)
        return Outcomes(
            answers.cause,
            answers.segment,
            answers.joint,
            np.where(away, np.float32(0.0), answers.fraction),
            np.broadcast_to(self._numbers, answers.cause.shape),
            answers.pair,
        )

    def outcomes(self, answers: Answers) -> Outcomes:
        """Outcomes (N, D) of answers (N, C): of each demonstration its best attempt.

        A demonstration without success is NOT_TRIED unless all its variants were tried.
        """
        found = self.each(answers)
        if len(self.X_OE) == len(self.demonstrations):
            return found
        N, D = len(answers.cause), len(self.demonstrations)
        if len(np.unique(self.counts)) == 1:
            return best_variant(found.reshape((N, D, int(self.counts[0]))))
        ends = zip(self.first[:-1], self.first[1:], strict=True)
        return concatenate([best_variant(found[:, a:b])[:, None] for a, b in ends], axis=1)

    def of_columns(self, answers: Answers, column: NDArray[np.int64]) -> Outcomes:
        """Outcomes (N,) of answers (N, 1), each of one column (N,)."""
        away = (answers.segment[:, 0] == 0) & (self.begins[column] > 0)
        return Outcomes(
            answers.cause[:, 0],
            answers.segment[:, 0],
            answers.joint[:, 0],
            np.where(away, np.float32(0.0), answers.fraction[:, 0]),
            self._numbers[column],
            answers.pair[:, 0],
        )

    def followed(
        self, X_WO: Array, which: NDArray[np.int64], variant: NDArray[np.int64]
    ) -> tuple[list[Array], Array]:
        """What plans follow, and how their bodies are turned.

        Args:
            X_WO: (N, k, 4, 4).
            which: (N,) the demonstration of each instance.
            variant: (N,) its number.

        Returns:
            N arrays X_WE (g, 4, 4) of guiding poses; angles (N, k + 1) as `Symmetries` has them.
        """
        angles = np.zeros((len(X_WO), X_WO.shape[1] + 1))
        guides: list[Array] = [np.empty((0, 4, 4))] * len(X_WO)
        for d in np.unique(which).tolist():
            rows, demonstration = np.flatnonzero(which == d), self.demonstrations[d]
            angles[rows] = self.symmetries.angles(demonstration, X_WO[rows], variant[rows])
            X_WE = self.symmetries.guides(demonstration, X_WO[rows], angles[rows])
            for row, X in zip(rows.tolist(), X_WE, strict=True):
                guides[row] = X
        return guides, angles

    @property
    def _numbers(self) -> NDArray[np.int16]:
        """(C,) the number of each column's variant."""
        turns = np.repeat(self.turns, self.counts)
        place = np.arange(len(turns)) - np.repeat(self.first[:-1], self.counts)
        return (self.starts.start * turns + place).astype(np.int16)


def best_variant(outcomes: Outcomes) -> Outcomes:
    """Outcomes (...) of outcomes (..., V) of variants: of the first that succeeds.

    Where none does, of the one that came furthest; NOT_TRIED where some were not tried.
    """
    found = outcomes.take(np.maximum(outcomes.best_attempt, 0))
    undecided = ~found.success & (outcomes.cause == Cause.NOT_TRIED).any(axis=-1)
    return found.replaced(undecided, one_outcome(Cause.NOT_TRIED, fraction=0.0))


def furthest(a: Outcomes, b: Outcomes) -> Outcomes:
    """Of outcomes (...) of the same demonstrations and instances those of the better attempt.

    What one of them has not tried to the end is not tried, unless the other one succeeds.
    """
    both = concatenate([a[..., None], b[..., None]], axis=-1)
    return best_variant(both)
