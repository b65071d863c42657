"""The smallest set that covers: found in two ways, against brute force; and what is claimed."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from scipy.stats import binomtest

from drake_screw.acquisition import cover, cover_program
from drake_screw.acquisition.cover import Cover, best_of_size, greedy_cover, smallest_cover, too_few
from drake_screw.acquisition.cover_program import Program
from drake_screw.acquisition.cover_search import searched
from drake_screw.acquisition.cover_table import Chosen, CoverTable, GaveUp


class Problem:
    """A small random table with what is allowed, and sets that the answer must not lie in."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        D, N, K = int(rng.integers(1, 9)), int(rng.integers(4, 60)), int(rng.integers(1, 5))
        self.solved = rng.random((N, D)) < rng.uniform(0.1, 0.9)
        if D > 2 and rng.random() < 0.4:
            self.solved[:, 1] = self.solved[:, 0]  # a tie, whatever they are in
        self.region = rng.integers(0, K, N)
        self.table = CoverTable.of(self.solved, self.region, K)
        self.allowed = np.floor(self.table.samples * rng.uniform(0.0, 0.6)).astype(int)
        if rng.random() < 0.8:
            self.allowed = np.maximum(self.allowed, self.table.failures(range(D)))
        self.beyond = [
            tuple(rng.choice(D, size=rng.integers(1, D + 1), replace=False).tolist())
            for _ in range(rng.integers(0, 3))
        ]

    def failures(self, chosen: Chosen) -> np.ndarray:
        failed = ~self.solved[:, chosen].any(axis=1)
        return np.bincount(self.region[failed], minlength=self.table.K)

    def best(self, size: int) -> Chosen | None:
        """By going through all of them."""
        found = [
            (failures.max(), failures.sum(), chosen)
            for chosen in combinations(range(self.table.D), size)
            if ((failures := self.failures(chosen)) <= self.allowed).all()
            and not any(set(chosen) <= set(others) for others in self.beyond)
        ]
        return min(found)[2] if found else None

    def smallest(self) -> Chosen | None:
        sizes = range(1, self.table.D + 1)
        return next((found for size in sizes if (found := self.best(size))), None)


PROBLEMS = range(150)


def test_the_problems_are_of_all_kinds() -> None:
    sizes = [len(Problem(seed).smallest() or ()) for seed in PROBLEMS]
    assert min(np.bincount(sizes, minlength=5)[:5]) >= 5


@pytest.mark.parametrize("seed", PROBLEMS)
def test_going_through_the_sets_finds_what_brute_force_finds(seed: int) -> None:
    of = Problem(seed)
    for size in range(1, of.table.D + 1):
        assert searched(of.table, size, of.allowed, of.beyond) == of.best(size)
    found, best = smallest_cover(of.table, of.allowed, beyond=of.beyond), of.smallest()
    assert found == (None if best is None else Cover(best, True))


@pytest.mark.parametrize("seed", PROBLEMS[:60])
def test_the_linear_program_finds_what_brute_force_finds(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    of = Problem(seed)
    size = 1 + seed % of.table.D
    assert Program(of.table, of.allowed, of.beyond).best(size) == of.best(size)
    monkeypatch.setattr(cover, "WORK", (0.0, 0.0))
    found, best = smallest_cover(of.table, of.allowed, beyond=of.beyond), of.smallest()
    assert found == (None if best is None else Cover(best, True))


def test_both_ways_agree_on_a_table_like_those_of_recordings() -> None:
    """Disks that candidates cover, 20 of them, on 16 regions."""
    rng = np.random.default_rng(20)
    places, centers, radii = rng.random((3200, 2)), rng.random((20, 2)), rng.uniform(0.2, 0.4, 20)
    solved = np.linalg.norm(places[:, None] - centers, axis=-1) < radii
    table = CoverTable.of(solved, (np.floor(4 * places) @ [1, 4]).astype(int), 16)
    allowed = np.maximum(table.failures(range(20)), np.floor(0.03 * table.samples).astype(int))
    found = smallest_cover(table, allowed)
    assert found is not None
    assert found.smallest
    program = Program(table, allowed)
    assert program.smallest() == len(found.chosen) > 3
    assert program.best(len(found.chosen)) == found.chosen
    fewer = best_of_size(table, len(found.chosen) - 1)
    assert fewer is not None
    assert Program(table, table.samples).best(len(fewer)) == fewer
    assert (table.failures(fewer) > allowed).any()


def test_the_table_counts_instances() -> None:
    of = Problem(5)
    assert of.table.solves.shape == (len(of.table.region), of.table.D)
    assert len(of.table.region) < len(of.solved)
    assert of.table.weight.sum() == len(of.solved)
    np.testing.assert_array_equal(of.table.samples, np.bincount(of.region, minlength=of.table.K))
    for chosen in ((), (0,), (0, 2), tuple(range(of.table.D))):
        np.testing.assert_array_equal(of.table.failures(chosen), of.failures(chosen))


def test_a_region_without_instances_asks_for_nothing() -> None:
    table = CoverTable.of([[1, 0], [0, 1]], [0, 2], K=3)
    assert table.samples.tolist() == [1, 0, 1]
    assert table.rates((0,)).tolist() == [0.0, 0.0, 1.0]
    assert smallest_cover(table, [0, 0, 0]) == Cover((0, 1), True)


def test_of_sets_as_good_the_first_in_order_is_chosen() -> None:
    table = CoverTable.of([[1, 0, 1, 1, 0], [0, 1, 0, 0, 1]], [0, 0], K=1)
    assert smallest_cover(table, [0]) == Cover((0, 1), True)
    assert Program(table, [0]).best(2) == (0, 1)
    assert best_of_size(table, 2, other_than=[(0, 1)]) == (0, 4)
    assert Program(table, [0], [(0, 1), (0, 4)]).best(2) == (1, 2)


def test_a_set_beyond_others_has_something_that_they_lack() -> None:
    table = CoverTable.of([[1, 1, 0], [0, 1, 1]], [0, 0], K=1)
    assert smallest_cover(table, [0]) == Cover((1,), True)
    assert smallest_cover(table, [0], beyond=[(1,)]) == Cover((0, 1), True)
    assert smallest_cover(table, [0], beyond=[(1,), (0, 1)]) == Cover((0, 2), True)
    assert smallest_cover(table, [0], beyond=[(0, 1, 2)]) is None


@pytest.mark.parametrize("seed", PROBLEMS)
def test_greedily_a_set_is_found_where_there_is_one(seed: int) -> None:
    of = Problem(seed)
    found = greedy_cover(of.table, of.allowed, beyond=of.beyond)
    assert (found is None) == (of.smallest() is None)
    if found is not None:
        assert (of.failures(found) <= of.allowed).all()
        assert not any(set(found) <= set(others) for others in of.beyond)


def test_where_looking_would_take_too_long_the_answer_says_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Greedily, 0 comes first, which solves the most; then it takes three."""
    rows = [[1, 1, 0]] * 2 + [[1, 0, 1]] * 2 + [[0, 1, 0], [0, 0, 1]]
    table = CoverTable.of(np.hstack([rows, np.zeros((6, 1))]), [0] * 6, K=1)
    monkeypatch.setattr(cover, "WORK", (0.0, 0.0))
    assert smallest_cover(table, [0]) == Cover((1, 2), True)

    def give_up(*_: object) -> None:
        raise GaveUp

    monkeypatch.setattr(Program, "_least", give_up)
    assert smallest_cover(table, [0]) == Cover(greedy_cover(table, [0]), False)
    assert best_of_size(table, 2) is None


def test_a_linear_program_out_of_time_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(0)
    table = CoverTable.of(rng.random((800, 30)) < 0.3, np.arange(800) % 4, 4)
    monkeypatch.setattr(cover_program, "TIME_LIMIT", 0.05)
    with pytest.raises(GaveUp):
        Program(table, np.full(4, 5)).smallest()


@pytest.mark.parametrize(("D", "size", "K"), [(1, 1, 1), (4, 2, 3)])
def test_sets_are_ruled_out_wrongly_with_probability_delta_at_most(
    D: int, size: int, K: int
) -> None:
    """At the hardest: each set fails just tau of the time everywhere, and so suffices."""
    rng, n, tau, delta, trials = np.random.default_rng(8), 120, 0.05, 0.1, 3000
    region, wrong = np.repeat(np.arange(K), n), 0
    for _ in range(trials):
        failed = rng.random((K * n, 1)) < tau
        table = CoverTable.of(np.repeat(~failed, D, axis=1), region, K)
        best = best_of_size(table, size)
        assert best is not None
        wrong += too_few(table, best, tau, delta)
    assert binomtest(wrong, trials, delta, alternative="greater").pvalue > 1e-6
    assert wrong > 0


def test_what_is_far_too_little_is_ruled_out() -> None:
    rng = np.random.default_rng(2)
    table = CoverTable.of(rng.random((800, 5)) < 0.6, np.repeat([0, 1], 400), 2)
    best = best_of_size(table, 2)
    assert best is not None
    assert table.rates(best).max() > 0.1
    assert too_few(table, best, 0.05, 0.05)
    assert not too_few(table, best, 0.2, 0.05)
