"""A draw depends on nothing but its place in the run, and is uniform."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from drake_screw.tasks import ObjectArea, WorkArea, draw, grid_regions
from drake_screw.tasks.sampling import CHUNK

BOWL = ObjectArea("bowl", (0.7, -0.2, -1.0), (1.1, 0.8, 1.0), 0.0)
CUP = ObjectArea("cup", (0.5, 0.0, 0.0), (0.5, 0.5, 0.0), 0.0)
GRID = grid_regions(WorkArea((BOWL, CUP)), {"bowl.x": 4, "bowl.y": 2, "cup.y": 2})


def drawn(
    region: int = 3, start: int = 0, count: int = 5000, seed: int = 1, round: int = 0
) -> np.ndarray:
    return draw(GRID, region, seed=seed, round=round, start=start, count=count)


ALL = drawn()


def test_instances_lie_in_their_region_and_fixed_coordinates_stay() -> None:
    for region in range(GRID.K):
        coordinates = drawn(region, count=300)
        assert coordinates.shape == (300, 2, 3)
        np.testing.assert_array_equal(GRID.index(coordinates), region)
        np.testing.assert_array_equal(coordinates[:, 1, [0, 2]], [[0.5, 0.0]] * 300)


@settings(deadline=None, max_examples=50)
@given(st.integers(0, 4999), st.integers(0, 5000))
def test_slices_are_parts_of_one_stream(start: int, count: int) -> None:
    count = min(count, 5000 - start)
    np.testing.assert_array_equal(drawn(start=start, count=count), ALL[start : start + count])


@settings(deadline=None, max_examples=20)
@given(st.lists(st.integers(1, 5000), max_size=6), st.randoms(use_true_random=False))
def test_order_and_batch_size_make_no_difference(cuts: list[int], random: object) -> None:
    edges = sorted({0, 5000, *cuts})
    pieces = list(pairwise(edges))
    random.shuffle(pieces)  # type: ignore[attr-defined]
    parts = {a: drawn(start=a, count=b - a) for a, b in pieces}
    np.testing.assert_array_equal(np.concatenate([parts[a] for a in sorted(parts)]), ALL)


@pytest.mark.parametrize("start", [0, CHUNK - 1, CHUNK, 10**7])
def test_drawing_nothing(start: int) -> None:
    assert drawn(start=start, count=0).shape == (0, 2, 3)


def test_first_chunk_is_the_documented_stream() -> None:
    sequence = np.random.SeedSequence(1, spawn_key=(0, 3, 0))
    unit = np.random.default_rng(sequence).random((CHUNK, 2, 3))
    lower, upper = GRID.bounds(3)
    np.testing.assert_array_equal(drawn(count=CHUNK), lower + unit * (upper - lower))


def test_other_seeds_rounds_regions_and_chunks_have_other_instances() -> None:
    others = [
        drawn(seed=2),
        drawn(round=1),
        drawn(seed=0, round=1),
        drawn(region=4) - GRID.bounds(4)[0] + GRID.bounds(3)[0],
        drawn(start=CHUNK),
    ]
    for other in others:
        assert not np.isclose(other[:, 0], ALL[:, 0]).all(axis=1).any()
    assert len(np.unique(ALL[:, 0, 0])) == 5000


def test_draws_are_uniform_and_independent() -> None:
    lower, upper = GRID.bounds(3)
    free = upper > lower
    unit = ((ALL - lower)[:, free]) / (upper - lower)[free]
    assert unit.shape == (5000, 4)
    for column in unit.T:
        assert stats.kstest(column, "uniform").pvalue > 1e-3
        ranks = stats.spearmanr(column[:-1], column[1:])
        assert ranks.pvalue > 1e-3
    correlation = np.corrcoef(unit.T) - np.eye(4)
    assert np.abs(correlation).max() < 4.0 / np.sqrt(5000)
