from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from drake_screw.bandits import (
    BanditError,
    Cell,
    CellPull,
    CertifyOrSplit,
    TreeVerdict,
    cell_number,
)
from tests.bandits.bernoulli import GOAL, at_most_plausible

SMALLEST = 1 / 256
Rate = Callable[[np.ndarray], np.ndarray]  # points (n, d) -> their failure probabilities (n,)


def clean(points: np.ndarray) -> np.ndarray:
    return np.zeros(len(points))


def pocket(lower: np.ndarray, upper: np.ndarray, rate: float = 1.0) -> Rate:
    return lambda points: rate * ((points >= lower) & (points < upper)).all(axis=1)


def smallest_cell(d: int, volume: float = SMALLEST) -> np.ndarray:
    """Upper corner of the cell of that volume at the origin."""
    depth = round(-np.log2(volume))
    return np.array([0.5 ** len(range(axis, depth, d)) for axis in range(d)])


def world(rate: Rate, seed: int) -> CellPull:
    rng = np.random.default_rng(seed)

    def pull(lower: np.ndarray, upper: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
        points = rng.uniform(lower, upper, (count, len(lower)))
        return points, rng.random(count) < rate(points)

    return pull


def run(tree: CertifyOrSplit, rates: list[Rate], seed: int) -> list[TreeVerdict]:
    """One round for each rate: every round but the last is followed by a demonstration."""
    frontier, verdicts = tree.start(), []
    for round_, rate in enumerate(rates):
        verdicts.append(tree.decide(world(rate, 1_000 * seed + round_), frontier))
        frontier = tree.advance(verdicts[-1].frontier)
    return verdicts


@pytest.mark.parametrize(("level", "samples"), [(0.5, 2_700), (0.05, 27_000)])
@pytest.mark.parametrize("d", [1, 3, 9])
def test_a_clean_box_costs_the_same_in_any_dimension(d: int, level: float, samples: int) -> None:
    (verdict,) = run(CertifyOrSplit(GOAL, d, SMALLEST, level), [clean], seed=0)
    assert verdict.certified
    assert verdict.cell is None
    assert len(verdict.frontier) == 1
    assert verdict.total_samples == pytest.approx(samples, rel=0.02)


@pytest.mark.parametrize(("level", "least", "most"), [(0.5, 6e3, 8e3), (0.05, 50e3, 64e3)])
@pytest.mark.parametrize("d", [2, 6])
def test_a_failing_pocket_is_found_and_costs_little(
    d: int, level: float, least: float, most: float
) -> None:
    corner = smallest_cell(d)
    rates = [pocket(0 * corner, corner), clean]
    totals = []
    for seed in range(8):
        first, second = run(CertifyOrSplit(GOAL, d, SMALLEST, level), rates, seed)
        assert first.cell is not None
        assert first.cell.volume == SMALLEST
        np.testing.assert_array_equal(first.cell.upper, corner)
        assert second.certified
        totals.append(first.total_samples + second.total_samples)
    assert least <= np.mean(totals) <= most


def test_a_box_that_mostly_fails_is_asked_for_at_once() -> None:
    tree = CertifyOrSplit(GOAL, 3, SMALLEST, 0.5)
    (verdict,) = run(tree, [lambda points: np.full(len(points), 0.95)], seed=1)
    assert verdict.cell is not None
    assert verdict.cell.depth == 0
    assert verdict.total_samples == 16


@pytest.mark.parametrize("rate", [0.0, 0.01])
def test_failures_within_the_goal_are_certified_cell_by_cell(rate: float) -> None:
    tree = CertifyOrSplit(GOAL, 2, 1 / 16, 0.5)
    (verdict,) = run(tree, [lambda points: np.full(len(points), rate)], seed=2)
    assert verdict.certified
    assert all(cell.cleared for cell in verdict.frontier)


def test_seldom_certifies_a_pocket_at_the_limit() -> None:
    corner = smallest_cell(2, 1 / 16)
    tree = CertifyOrSplit(GOAL, 2, 1 / 16, 0.8)
    rates = [pocket(0 * corner, corner, 0.8 + 1e-9)] * 3
    certified = sum(any(v.certified for v in run(tree, rates, seed)) for seed in range(60))
    assert at_most_plausible(certified, 60, GOAL.delta)


def test_seldom_certifies_one_smallest_cell_at_the_limit() -> None:
    corner = smallest_cell(2, 1 / 4)
    tree = CertifyOrSplit(GOAL, 2, 1 / 4, 0.05)
    rates = [pocket(0 * corner, corner, 0.05)]
    certified = sum(run(tree, rates, seed)[0].certified for seed in range(300))
    assert at_most_plausible(certified, 300, GOAL.delta)


def test_frontier_is_a_partition_that_keeps_the_samples_where_they_lie() -> None:
    corner = smallest_cell(3)
    rates = [pocket(0.3 * np.ones(3), 0.3 + corner), clean]
    for verdict in run(CertifyOrSplit(GOAL, 3, SMALLEST, 0.5), rates, seed=3):
        assert sum(cell.volume for cell in verdict.frontier) == 1.0
        points = np.random.default_rng(0).random((500, 3))
        inside = [
            ((points >= cell.lower) & (points < cell.upper)).all(axis=1)
            for cell in verdict.frontier
        ]
        assert (np.sum(inside, axis=0) == 1).all()
        for cell in verdict.frontier:
            assert np.prod(cell.upper - cell.lower) == pytest.approx(cell.volume)
            assert ((cell.points >= cell.lower) & (cell.points <= cell.upper)).all()


@pytest.mark.parametrize("rates", [(0.9, 1.0), (0.65, 1.0), (0.9, 0.8)])
def test_of_several_flagged_cells_the_one_in_which_most_of_the_box_fails_is_asked_for(
    rates: tuple[float, float],
) -> None:
    def cell(lower: float, upper: float, depth: int, rate: float, cleared: bool) -> Cell:
        points = np.linspace(lower, upper, 400, endpoint=False)[:, None]
        failed = np.arange(400) < 400 * rate
        return Cell(np.array([lower]), np.array([upper]), depth, 1, points, failed, cleared)

    half, quarter = cell(0.0, 0.5, 1, rates[0], False), cell(0.5, 0.75, 2, rates[1], False)
    rest = cell(0.75, 1.0, 2, 0.0, True)
    tree = CertifyOrSplit(GOAL, 1, SMALLEST, 0.5)
    for frontier in ((half, quarter, rest), (quarter, half, rest)):
        verdict = tree.decide(world(clean, 0), frontier)
        assert verdict.total_samples == 0
        assert verdict.cell is half


def test_a_demonstration_renews_uncleared_cells_only() -> None:
    corner = smallest_cell(2)
    tree = CertifyOrSplit(GOAL, 2, SMALLEST, 0.5)
    first = tree.decide(world(pocket(0 * corner, corner), 0), tree.start())
    cleared = Cell(np.zeros(2), np.ones(2), 0, 1, np.zeros((5, 2)), np.zeros(5, bool), cleared=True)
    before = (*first.frontier, cleared)
    after = tree.advance(before)
    assert after[-1] is cleared
    for old, new in zip(first.frontier, after, strict=False):
        assert (new.epoch, new.n, new.s) == (2, 0, 0)
        assert new.depth == old.depth
        np.testing.assert_array_equal(new.lower, old.lower)


def test_halves_cut_the_axes_in_turn() -> None:
    points = np.array([[0.1, 0.9], [0.6, 0.2], [0.5, 0.5]])
    whole = Cell(np.zeros(2), np.ones(2), 0, 3, points, np.array([True, False, True]))
    left, right = whole.halves()
    assert (left.n, left.s, right.n, right.s) == (1, 1, 2, 1)
    assert left.epoch == 3
    lower, upper = right.halves()
    np.testing.assert_array_equal([lower.lower, lower.upper], [[0.5, 0], [1, 0.5]])
    np.testing.assert_array_equal(upper.points, points[2:])


@pytest.mark.parametrize("d", [1, 2, 5])
def test_cells_are_numbered_as_in_a_heap(d: int) -> None:
    empty = np.zeros((0, d)), np.zeros(0, bool)
    row, expected = [Cell(np.zeros(d), np.ones(d), 0, 1, *empty)], 1
    for _ in range(6):
        for cell in row:
            assert cell_number(cell.lower, cell.upper) == expected
            expected += 1
        row = [half for cell in row for half in cell.halves()]


def test_bounds_widen_with_depth_and_epoch() -> None:
    tree = CertifyOrSplit(GOAL, 2, SMALLEST, 0.5)
    points, failed = np.zeros((40, 2)), np.arange(40) < 4
    whole = Cell(np.zeros(2), np.ones(2), 0, 1, points, failed)
    ends = [tree.bounds(replace(whole, depth=d, epoch=e)) for d, e in [(0, 1), (0, 2), (3, 2)]]
    assert ends == sorted(ends, reverse=True)
    assert [high for _, high in ends] == sorted(high for _, high in ends)
    assert tree.bounds(replace(whole, points=points[:0], failed=failed[:0])) == (0.0, 1.0)


def test_same_answers_give_the_same_verdict() -> None:
    corner = smallest_cell(2)
    tree = CertifyOrSplit(GOAL, 2, SMALLEST, 0.5)
    one, other = (run(tree, [pocket(0.2 * np.ones(2), 0.2 + corner)], seed=5)[0] for _ in range(2))
    assert one.total_samples == other.total_samples
    assert one.claim == other.claim
    assert [cell.s for cell in one.frontier] == [cell.s for cell in other.frontier]


@pytest.mark.parametrize(
    ("options", "names"),
    [((0, 0.1, 0.5), "dimension"), ((2, 0.0, 0.5), "smallest"), ((2, 0.1, 1.0), "level")],
)
def test_refuses_options_out_of_range(options: tuple[int, float, float], names: str) -> None:
    with pytest.raises(BanditError, match=names):
        CertifyOrSplit(GOAL, *options)


@pytest.mark.parametrize(
    "answer",
    [
        lambda lower, upper, count: (np.zeros((count, 3)), np.zeros(count, bool)),
        lambda lower, upper, count: (np.zeros((count, 2)), np.zeros(count - 1, bool)),
        lambda lower, upper, count: (np.zeros((count, 2)), np.zeros(count)),
        lambda lower, upper, count: (np.full((count, 2), 1.5), np.zeros(count, bool)),
    ],
)
def test_refuses_answers_that_are_not_samples_of_the_cell(answer: CellPull) -> None:
    tree = CertifyOrSplit(GOAL, 2, SMALLEST, 0.5)
    with pytest.raises(BanditError, match="a pull"):
        tree.decide(answer, tree.start())


@pytest.mark.parametrize(("most", "count"), [(1000, 64), (64, 64), (63, 32), (1, 1)])
def test_the_smallest_cells_are_a_partition_or_larger_ones_are(most: int, count: int) -> None:
    tree = CertifyOrSplit(GOAL, 3, 1 / 64, 0.5)
    cells = tree.cells(most)
    assert len(cells) == count
    assert sum(cell.volume for cell in cells) == 1.0
    points = np.random.default_rng(0).random((500, 3))
    inside = [((points >= cell.lower) & (points < cell.upper)).all(axis=1) for cell in cells]
    assert (np.sum(inside, axis=0) == 1).all()
    assert tree.tau(cells[0]) == pytest.approx(min(GOAL.tau, 0.5 * count / 64))


def test_a_box_can_start_in_a_later_epoch() -> None:
    tree = CertifyOrSplit(GOAL, 2, SMALLEST, 0.5)
    (cell,) = tree.start(4)
    assert (cell.epoch, cell.n, cell.cleared) == (4, 0, False)
    assert tree.least(cell) > tree.least(tree.start()[0])


def test_what_a_certificate_says_of_small_cells_is_not_rounded_up() -> None:
    goal = replace(GOAL, beta=1.0 - 1e-7, epsilon=1e-8)
    claim = CertifyOrSplit(goal, 2, SMALLEST, 1e-9)._claim(None)
    assert "succeeds at least 0.9999999 of the time, the whole at least 0.9999999" in claim
