"""Small symmetric systems and determinants as expressions."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from drake_screw.planning.compiled.expressions import Value, maximum
from drake_screw.typing import Array

DETERMINANT_MIN = 1e-44
"""Determinants are held above this, so that rounding cannot turn their sign."""


@dataclass(frozen=True)
class Factor:
    """A symmetric positive matrix [[P, Q], [Q^T, S]], ready to be solved with.

    P is of size 3 at most. Inverting it, and its complement S - Q^T P^-1 Q, by their cofactors
    takes more multiplications than L D L^T, but few divisions and no long chain of dependent steps.

    Attributes:
        first: P^-1, last: (S - Q^T P^-1 Q)^-1, bridge: P^-1 Q, coupling: Q^T.
        determinant: of the whole.
    """

    first: Array
    last: Array
    bridge: Array
    coupling: Array
    determinant: Value = 1.0

    @staticmethod
    def of(A: Array) -> Factor:
        """Of a matrix, of which only the lower triangle is looked at."""
        k = min(3, len(A))
        first, volume = inverse(A[:k, :k])
        coupling = A[k:, :k]
        bridge = first @ coupling.T
        last, volume_last = inverse(A[k:, k:] - coupling @ bridge)
        return Factor(first, last, bridge, coupling, volume * volume_last)

    def solve(self, b: Array) -> Array:
        """x of A x = b, (n,)."""
        k = len(self.first)
        y = self.first @ b[:k]
        x = self.last @ (b[k:] - self.coupling @ y)
        return np.concatenate([y - self.bridge @ x, x])


def inverse(A: Array) -> tuple[Array, Value]:
    """Inverse and determinant of a symmetric positive matrix of size 0 to 3.

    Args:
        A: the matrix, of which only the lower triangle is looked at.
    """
    A = _symmetric(A)
    if len(A) == 0:
        return A, 1.0
    if len(A) == 1:
        cofactors = np.ones((1, 1), dtype=object)
    elif len(A) == 2:
        cofactors = np.array([[A[1, 1], -A[1, 0]], [-A[1, 0], A[0, 0]]])
    else:
        rows = [np.cross(A[(i + 1) % 3], A[(i + 2) % 3]) for i in range(3)]
        cofactors = _symmetric(np.array(rows))
    determinant = maximum(A[0] @ cofactors[0], DETERMINANT_MIN)
    return (1.0 / determinant) * cofactors, determinant


def _symmetric(A: Array) -> Array:
    return np.where(np.tri(len(A), dtype=bool), A, A.T)


def determinant(A: Array) -> Value:
    """Laplace's expansion, one row after the other, of all minors that it takes."""
    minors: dict[tuple[int, ...], Value] = {(): 1.0}
    for k, row in enumerate(A):
        minors = {
            columns: sum(
                (-1.0) ** (k + i) * row[c] * minors[columns[:i] + columns[i + 1 :]]
                for i, c in enumerate(columns)
            )
            for columns in combinations(range(len(A)), k + 1)
        }
    return minors[tuple(range(len(A)))]
