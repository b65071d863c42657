"""Instances that two runs have both drawn, and what each made of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.acquisition import Evaluation
from drake_screw.errors import counted
from drake_screw.typing import Array


@dataclass(frozen=True)
class SharedInstances:
    """What two runs made of the instances that the last rounds of both have drawn.

    Runs with the same seed, work area and regions draw the same ones in a round of the same number.
    They are as many in each region as the run that drew less there has; so these are counts, and
    shares of the work area are not to be had from them.

    Attributes:
        first, second: numbers of the runs, from 1.
        instances: how many they share.
        both, only_first, only_second, neither: how many of these succeed where.
        example_only_first: an instance that succeeds in the first alone, by its row in the last
            round of each; None where there is none.
        example_only_second: likewise.
    """

    first: int
    second: int
    instances: int
    both: int
    only_first: int
    only_second: int
    neither: int
    example_only_first: tuple[int, int] | None
    example_only_second: tuple[int, int] | None

    @property
    def lines(self) -> tuple[str, ...]:
        """The same in words, with instances to look at; () where they share none."""
        if self.instances == 0:
            return ()
        examples = (
            (self.first, self.example_only_first),
            (self.second, self.example_only_second),
        )
        return (
            f"runs {self.first} and {self.second} share {counted(self.instances, 'instance')}: "
            f"{self.both:,} succeed in both, {self.only_first:,} in run {self.first} alone, "
            f"{self.only_second:,} in run {self.second} alone, {self.neither:,} in neither",
            *(
                f"in run {alone} alone succeeds, for example, instance {rows[0]} of the last round "
                f"of run {self.first}, which is {rows[1]} of run {self.second}"
                for alone, rows in examples
                if rows is not None
            ),
        )


def shared_instances(
    first: int, one: Evaluation, second: int, other: Evaluation
) -> SharedInstances:
    """What two runs, by their numbers, made of what both have drawn in the same work area."""
    rows = common_rows(one.coordinates, other.coordinates)
    a, b = ~one.failed[rows[:, 0]], ~other.failed[rows[:, 1]]
    return SharedInstances(
        first=first,
        second=second,
        instances=len(rows),
        both=int((a & b).sum()),
        only_first=int((a & ~b).sum()),
        only_second=int((~a & b).sum()),
        neither=int((~a & ~b).sum()),
        example_only_first=_first_of(rows[a & ~b]),
        example_only_second=_first_of(rows[~a & b]),
    )


def common_rows(one: Array, other: Array) -> NDArray[np.int64]:
    """Rows (M, 2) in which coordinates (N, k, c) and (N', k, c) are equal, to the last bit.

    In the order of the first.
    """
    known = {place.tobytes(): row for row, place in enumerate(np.ascontiguousarray(other))}
    found = [
        (row, known[key])
        for row, place in enumerate(np.ascontiguousarray(one))
        if (key := place.tobytes()) in known
    ]
    return np.array(found, dtype=np.int64).reshape(-1, 2)


def _first_of(rows: NDArray[np.int64]) -> tuple[int, int] | None:
    return None if len(rows) == 0 else (int(rows[0, 0]), int(rows[0, 1]))
