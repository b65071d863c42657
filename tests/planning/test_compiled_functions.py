"""Elementary functions and small matrices as expressions, against numpy."""

from __future__ import annotations

import numpy as np
import pytest

from drake_screw.planning.compiled.expressions import Block
from drake_screw.planning.compiled.functions import cos_sin, log_between
from drake_screw.planning.compiled.matrices import Factor, determinant
from drake_screw.screws import exp, log
from tests.planning.compiled_arms import run_in_numpy


def run(b: Block, rows: np.ndarray) -> np.ndarray:
    """Run what was written down on rows (k, m) of inputs."""
    out = rows.copy()
    run_in_numpy(b.program("code"), out)
    return out


def test_cos_and_sin() -> None:
    b = Block()
    b[1:3] = cos_sin(b[0])
    special = np.arange(-8, 9) * np.pi / 4.0
    angles = np.concatenate([special, special + 1e-9, np.linspace(-20.0, 20.0, 2001)])
    rows = np.zeros((3, len(angles)))
    rows[0] = angles
    _, c, s = run(b, rows)
    np.testing.assert_allclose(c, np.cos(angles), rtol=0, atol=4e-13)
    np.testing.assert_allclose(s, np.sin(angles), rtol=0, atol=4e-13)
    np.testing.assert_allclose(c * c + s * s, 1.0, rtol=0, atol=1e-12)


def twist_of(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    """log(Y X^-1) by the generated code."""
    b = Block()
    b[24:30] = log_between(b[0:12].reshape(3, 4), b[12:24].reshape(3, 4))
    rows = np.zeros((30, len(X)))
    rows[:12], rows[12:24] = X[:, :3].reshape(-1, 12).T, Y[:, :3].reshape(-1, 12).T
    return run(b, rows)[24:].T


@pytest.mark.parametrize(
    "angle", [0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.1, 1.0, 2.0, 3.0, np.pi - 1e-3, np.pi - 1e-6]
)
def test_logarithm_gives_back_the_twist(angle: float) -> None:
    rng = np.random.default_rng(int(1e6 * angle))
    w = rng.normal(size=(48, 3))
    w[:3] = np.eye(3)
    V = np.concatenate(
        [w / np.linalg.norm(w, axis=1)[:, None] * angle, rng.normal(size=(48, 3))], 1
    )
    X = exp(rng.normal(size=(48, 6)))
    got = twist_of(X, exp(V) @ X)
    loss = 1.0 / max(np.pi - angle, 1e-3)  # towards pi the axis is all that keeps its digits
    np.testing.assert_allclose(got, V, rtol=0, atol=1e-12 * max(1.0, loss))
    np.testing.assert_allclose(got, log(exp(V) @ X @ np.linalg.inv(X)), rtol=0, atol=1e-11 * loss)


@pytest.mark.parametrize("angle", [np.pi - 1e-9, np.pi])
def test_logarithm_at_half_a_turn_leads_there(angle: float) -> None:
    rng = np.random.default_rng(1)
    w = rng.normal(size=(16, 3))
    w[:3] = np.eye(3)
    V = np.concatenate(
        [w / np.linalg.norm(w, axis=1)[:, None] * angle, rng.normal(size=(16, 3))], 1
    )
    X = exp(rng.normal(size=(16, 6)))
    got = twist_of(X, exp(V) @ X)
    np.testing.assert_allclose(exp(got) @ X, exp(V) @ X, rtol=0, atol=1e-11)
    assert (np.linalg.norm(got[:, :3], axis=1) <= np.pi + 1e-12).all()


@pytest.mark.parametrize("n", range(1, 7))
def test_symmetric_systems(n: int) -> None:
    rng = np.random.default_rng(n)
    m = 64
    root = rng.normal(size=(m, n, n + 1))
    A, b = root @ np.swapaxes(root, 1, 2), rng.normal(size=(m, n))
    block = Block()
    factor = Factor.of(np.tril(block[0 : n * n].reshape(n, n)))
    block[n * n + n : n * n + 2 * n] = factor.solve(block[n * n : n * n + n])
    block[n * n + 2 * n] = factor.determinant
    rows = np.zeros((n * n + 2 * n + 1, m))
    rows[: n * n], rows[n * n : n * n + n] = A.reshape(m, -1).T, b.T
    out = run(block, rows)
    x = out[n * n + n : n * n + 2 * n].T
    scale = np.linalg.cond(A) * np.linalg.norm(np.linalg.solve(A, b[..., None])[..., 0], axis=1)
    error = np.linalg.norm(x - np.linalg.solve(A, b[..., None])[..., 0], axis=1)
    assert (error < 1e-13 * scale + 1e-14).all()
    np.testing.assert_allclose(out[-1], np.linalg.det(A), rtol=1e-9 * np.linalg.cond(A).max())


@pytest.mark.parametrize("n", range(1, 7))
def test_determinants(n: int) -> None:
    A = np.random.default_rng(n).normal(size=(48, n, n))
    b = Block()
    b[n * n] = determinant(b[0 : n * n].reshape(n, n))
    rows = np.zeros((n * n + 1, 48))
    rows[: n * n] = A.reshape(48, -1).T
    np.testing.assert_allclose(run(b, rows)[-1], np.linalg.det(A), rtol=0, atol=1e-12)
