"""What is written down is what is computed, and no more than that."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from numba import njit

from drake_screw.planning.compiled import expressions as ex
from drake_screw.planning.compiled.expressions import Block, maximum, minimum, sqrt, varies, where
from drake_screw.planning.compiled.lowering import lane_code
from drake_screw.planning.compiled.rows import LANES
from tests.planning.compiled_arms import OPERATIONS, run_in_numpy


def operations(b: Block) -> Counter[str]:
    return Counter(node.operation for node in b.program("p").nodes)


def test_constants_are_folded() -> None:
    b = Block()
    x = b[0]
    assert (0.0 * x + 2.0 * 3.0 - 1.0).number == 5.0
    for same in (x + 0.0, 0.0 + x, x - 0.0, 1.0 * x, x * 1.0, x / 1.0):
        assert same is x
    for zero in (0.0 * x, x * 0.0, 0.0 / x, x * (1.0 - ex.sqrt(b[0] * 0.0 + 1.0))):
        assert zero.number == 0.0
    assert (0.0 - x).operation == "neg"
    assert minimum(maximum(2.0, 3.0), 4.0).number == 3.0
    assert np.array([1.0, 0.0]) @ np.array([x, b[1]]) is x
    assert not varies(np.cross([0.0, 0.0, 1.0], np.array([0.0 * x, 0.0, 7.0]))).any()


def test_rotations_by_constants_cost_nothing() -> None:
    b = Block()
    b[3:6] = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]) @ b[0:3]
    assert operations(b) == {"load": 3, "store": 3}


def test_what_has_a_name_is_computed_once_and_the_unused_never() -> None:
    b = Block()
    root = sqrt(b[0])
    unused = b[1] / b[2]
    b[3], b[4] = root * root, root + 1.0
    assert unused.operation == "/"
    assert operations(b) == {"load": 1, "sqrt": 1, "*": 1, "+": 1, "constant": 1, "store": 2}


def test_rows_are_read_when_they_are_asked_for() -> None:
    b, block = Block(), np.array([[1.0], [2.0]])
    old = b[0]
    b[0] = b[1]
    b[1] = old + 10.0 * b[0]
    run_in_numpy(b.program("p"), block)
    assert block.tolist() == [[2.0], [21.0]]


def test_rows_of_another_block_are_refused() -> None:
    mine, other = Block(), Block()
    mine[0] = other[1] + mine[2]
    with pytest.raises(ValueError, match="another block"):
        mine.program("p")


def test_python_cannot_decide_what_only_compiled_code_knows() -> None:
    x = Block()[0]
    with pytest.raises(TypeError, match="where"):
        max(x, 1.0)
    with pytest.raises(TypeError, match="where"):
        bool(x)


def test_listings_tell_programs_apart() -> None:
    def listing(constant: float, row: int) -> str:
        b = Block()
        b[row] = constant * b[0]
        return str(b.program("p"))

    assert listing(2.0, 1) == listing(2.0, 1)
    assert len({listing(2.0, 1), listing(np.nextafter(2.0, 3.0), 1), listing(2.0, 2)}) == 3


def test_compiled_code_does_what_the_operations_say() -> None:
    """Each of them, on numbers of both signs, zeros and NaN."""
    b = Block()
    x, y = b[0], b[1]
    results = [x + y, x - y, x * y, x / y, -x, abs(x), sqrt(abs(x)), ex.floor(x), ex.ceil(x)]
    results += [minimum(x, y), maximum(x, y), 2.0 - x, 2.0 / y]
    conditions = [x < y, x <= y, x > y, x >= y, (x < y) & (x > 0.0), (x < y) | (x > 0.0), ~(x < y)]
    results += [where(condition, x, 7.0) for condition in conditions]
    for k, result in enumerate(results):
        b[2 + k] = result
    program = b.program("everything")
    used = {node.operation for node in program.nodes} - {"constant", "load", "store"}
    assert used == set(OPERATIONS)
    compiled = lane_code(program, __name__)

    @njit
    def run(block):  # type: ignore[no-untyped-def]
        compiled(block)

    block = np.zeros((2 + len(results), LANES))
    block[:2] = np.random.default_rng(0).normal(size=(2, LANES)) * 3.0
    block[0, :3], block[1, 2:6] = [np.nan, 2.0, 0.0], [0.0, np.nan, 1.0, -1.0]
    block[1, 1] = 2.0
    want, flat = block.copy(), block.reshape(-1).copy()
    with np.errstate(all="ignore"):
        run_in_numpy(program, want)
    run(flat)
    np.testing.assert_allclose(flat.reshape(block.shape), want, rtol=1e-15)
