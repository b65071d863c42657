"""Small symmetric systems and determinants as straight-line code."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

from drake_screw.planning.compiled.emitter import Emitter, Value, Vector, text

DETERMINANT_MIN = 1e-44
"""Determinants are held above this, so that rounding cannot turn their sign."""


@dataclass
class Factor:
    """A symmetric positive matrix [[P, Q], [Q^T, S]], ready to be solved with.

    P is of size 3 at most. Inverting it, and its complement S - Q^T P^-1 Q, by their cofactors
    takes more multiplications than L D L^T, but few divisions and no long chain of dependent steps.

    Attributes:
        first: P^-1, last: (S - Q^T P^-1 Q)^-1, bridge: P^-1 Q, coupling: Q^T.
        determinant: of the whole.
    """

    first: list[list[Value]]
    last: list[list[Value]]
    bridge: list[list[Value]]
    coupling: list[list[Value]]
    determinant: Value = 1.0

    @staticmethod
    def of(e: Emitter, A: list[list[Value]]) -> Factor:
        """Of a matrix given by its lower triangle."""
        k = min(3, len(A))
        first, volume = inverse(e, A[:k])
        coupling = [row[:k] for row in A[k:]]
        bridge = [[e.dot(row, column) for column in coupling] for row in first]
        last, volume_last = inverse(
            e,
            [
                [
                    e.sum((1.0, row[k + j]), *((-1.0, row[a], bridge[a][j]) for a in range(k)))
                    for j in range(i + 1)
                ]
                for i, row in enumerate(A[k:])
            ],
        )
        return Factor(first, last, bridge, coupling, e.sum((volume, volume_last)))

    def solve(self, e: Emitter, b: Vector) -> list[Value]:
        k = len(self.first)
        y = [e.dot(row, b[:k]) for row in self.first]
        rest = [
            e.sum((1.0, value), *((-1.0, q, yj) for q, yj in zip(row, y, strict=True)))
            for value, row in zip(b[k:], self.coupling, strict=True)
        ]
        x = [e.dot(row, rest) for row in self.last]
        head = [
            e.sum((1.0, value), *((-1.0, w, xj) for w, xj in zip(row, x, strict=True)))
            for value, row in zip(y, self.bridge, strict=True)
        ]
        return [*head, *x]


def inverse(e: Emitter, lower: list[list[Value]]) -> tuple[list[list[Value]], Value]:
    """Inverse and determinant of a symmetric positive matrix of size 0 to 3.

    Args:
        lower: its lower triangle.
    """
    n = len(lower)
    A = [[lower[max(i, j)][min(i, j)] for j in range(n)] for i in range(n)]
    if n == 0:
        return [], 1.0
    if n == 1:
        cofactors: list[list[Value]] = [[1.0]]
    elif n == 2:
        cofactors = [[A[1][1], e.sum((-1.0, A[1][0]))], [e.sum((-1.0, A[1][0])), A[0][0]]]
    else:
        cofactors = [[0.0] * 3 for _ in range(3)]
        for i in range(3):
            for j in range(i + 1):
                (a, b), (c, d) = ((i + 1) % 3, (i + 2) % 3), ((j + 1) % 3, (j + 2) % 3)
                minor = e.sum((A[a][c], A[b][d]), (-1.0, A[a][d], A[b][c]))
                cofactors[i][j] = cofactors[j][i] = minor
    determinant = e.let(f"max({text(e.dot(A[0], cofactors[0]))}, {DETERMINANT_MIN})")
    scale = e.let(f"1.0 / {determinant}")
    return [[e.sum((scale, c)) for c in row] for row in cofactors], determinant


def determinant(e: Emitter, A: list[list[Value]]) -> Value:
    """Laplace's expansion, one row after the other, of all minors that it takes."""
    minors: dict[tuple[int, ...], Value] = {(): 1.0}
    for k, row in enumerate(A):
        minors = {
            columns: e.sum(
                *(
                    ((-1.0) ** (k + i), row[c], minors[columns[:i] + columns[i + 1 :]])
                    for i, c in enumerate(columns)
                )
            )
            for columns in combinations(range(len(A)), k + 1)
        }
    return minors[tuple(range(len(A)))]
