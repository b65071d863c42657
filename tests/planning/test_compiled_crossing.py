"""Where a step's cubic reaches a limit, against numpy's roots."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from drake_screw.planning.compiled import rows as r
from drake_screw.planning.compiled.crossing import cubic_reaches_zero, first_crossing
from drake_screw.planning.compiled.lanes import Places

N = 3


@njit
def reaches_zero(f0, d0, f1, d1):  # type: ignore[no-untyped-def]
    return cubic_reaches_zero(f0, d0, f1, d1)


@njit
def crossing(b, rows, limits):  # type: ignore[no-untyped-def]
    return first_crossing(b, 5, rows, limits)


def coefficients(f0: float, d0: float, f1: float, d1: float) -> list[float]:
    return [d0 + d1 - 2.0 * (f1 - f0), 3.0 * (f1 - f0) - 2.0 * d0 - d1, d0, f0]


def by_roots(f0: float, d0: float, f1: float, d1: float) -> float:
    if f0 <= 0.0:
        return 0.0
    roots = np.roots(coefficients(f0, d0, f1, d1))
    real = roots[np.abs(roots.imag) < 1e-9].real
    inside = real[(real >= 0.0) & (real <= 1.0)]
    return float(inside.min()) if len(inside) else 2.0


def test_random_cubics() -> None:
    rng = np.random.default_rng(0)
    found = []
    for _ in range(2000):
        f0, d0, f1, d1 = rng.normal(size=4) * [0.3, 2.0, 0.3, 2.0] + [0.2, 0.0, 0.2, 0.0]
        want, got = by_roots(f0, d0, f1, d1), reaches_zero(f0, d0, f1, d1)
        grazing = np.abs(np.polyval(coefficients(f0, d0, f1, d1), np.linspace(0, 1, 999))).min()
        if grazing > 1e-7 or want == got:
            assert got == pytest.approx(want, abs=1e-7)
        found.append(got)
    kinds = np.array(found)
    assert (kinds == 0.0).any()
    assert (kinds == 2.0).any()
    assert ((kinds > 0.0) & (kinds < 1.0)).sum() > 300


@pytest.mark.parametrize("d0", [-1.0, -4.0, -40.0])
def test_a_dip_between_two_good_ends_is_seen(d0: float) -> None:
    u = reaches_zero(0.1, d0, 0.1, -d0)
    assert u == pytest.approx(by_roots(0.1, d0, 0.1, -d0), abs=1e-9)
    assert 0.0 < u < 0.5


@pytest.mark.parametrize(
    ("cubic", "want"),
    [
        ((1.0, -1.0, 0.0, -1.0), 1.0),
        ((1.0, -2.0, -1.0, -2.0), 0.5),
        ((0.0, 1.0, 1.0, 1.0), 0.0),
        ((-0.1, 5.0, 1.0, 0.0), 0.0),
        ((1.0, 0.0, 1.0, 0.0), 2.0),
        ((1e-9, 0.0, 1e-9, 0.0), 2.0),
        ((1.0, 0.0, 0.5, 0.0), 2.0),
    ],
)
def test_special_cubics(cubic: tuple[float, ...], want: float) -> None:
    assert reaches_zero(*cubic) == pytest.approx(want, abs=1e-9)


def lane(q0: list[float], d0: list[float], q1: list[float], d1: list[float]) -> tuple[int, float]:
    """The first crossing of limits +-1 in a step of 0.5, in one lane of a block."""
    rows = r.Rows(N)
    block = np.full((rows.kept, r.LANES), 77.0)
    block[r.STEP, 5] = 0.5
    block[rows.q : rows.q + N, 5] = q0
    block[rows.q_stage : rows.q_stage + N, 5] = q1
    block[rows.slope(0) : rows.slope(0) + N, 5] = d0
    block[rows.slope(6) : rows.slope(6) + N, 5] = d1
    places = Places(rows.q, rows.q_stage, rows.kept, rows.kept)
    joint, u = crossing(block.reshape(-1), places, np.array([-np.ones(N), np.ones(N)]))
    return int(joint), float(u)


def test_the_first_joint_to_cross_is_named() -> None:
    still = [0.0, 0.0, 0.0]
    assert lane(still, still, still, still) == (-1, 2.0)
    joint, u = lane([0.0, 0.5, 0.0], [2.0, 2.0, 0.0], [1.0, 1.5, 0.0], [2.0, 2.0, 0.0])
    assert (joint, u) == (1, pytest.approx(0.5))
    joint, u = lane([0.0, 0.5, -0.9], [2.0, 2.0, -2.0], [1.0, 1.5, -1.9], [2.0, 2.0, -2.0])
    assert (joint, u) == (2, pytest.approx(0.1))


def test_slopes_are_per_unit_of_s() -> None:
    """A turn inside the step: 0.95 and back, which slopes twice as steep carry over the limit."""
    joint, _ = lane([0.9, 0.0, 0.0], [0.3, 0.0, 0.0], [0.9, 0.0, 0.0], [-0.3, 0.0, 0.0])
    assert joint == -1
    joint, u = lane([0.9, 0.0, 0.0], [1.0, 0.0, 0.0], [0.9, 0.0, 0.0], [-1.0, 0.0, 0.0])
    assert joint == 0
    assert 0.0 < u < 0.5
