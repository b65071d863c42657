"""Poses and twists for property tests, on purpose often where formulas lose digits."""

from __future__ import annotations

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

from drake_screw.screws import exp

PI = np.pi
ODD_ANGLES = (0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.2 - 1e-9, 0.2 + 1e-9, PI - 1e-3, PI - 1e-6, PI - 1e-9)

# A busy machine may take a second over an example: time is not what is tested.
many = settings(deadline=None, max_examples=100)
some = settings(deadline=None, max_examples=40)

parts = st.floats(0.0, 1.0)
seeds = st.integers(0, 2**32 - 1)


@st.composite
def directions(draw: st.DrawFn) -> np.ndarray:
    """A unit vector, along a coordinate axis now and then."""
    if draw(st.booleans()):
        return np.eye(3)[draw(st.integers(0, 2))] * draw(st.sampled_from([-1.0, 1.0]))
    x = np.random.default_rng(draw(seeds)).normal(size=3)
    return x / np.linalg.norm(x)


def angles(highest: float = PI - 1e-9) -> st.SearchStrategy[float]:
    """Angles in rad, up to `highest`."""
    odd = [a for a in ODD_ANGLES if a <= highest]
    return st.one_of(st.sampled_from(odd), st.floats(0.0, highest))


@st.composite
def twists(draw: st.DrawFn, angle: st.SearchStrategy[float] | None = None) -> np.ndarray:
    """A twist [w; v] that turns by less than pi; |v| up to 2 m, and zero now and then."""
    w = draw(angles() if angle is None else angle) * draw(directions())
    length = draw(st.one_of(st.sampled_from([0.0, 1e-9, 1e-4]), st.floats(0.0, 2.0)))
    return np.concatenate([w, length * draw(directions())])


@st.composite
def poses(draw: st.DrawFn) -> np.ndarray:
    """A pose, by half a turn now and then."""
    return exp(draw(twists(st.one_of(angles(), st.just(PI)))))


def random_poses(rng: np.random.Generator, shape: tuple[int, ...] = ()) -> np.ndarray:
    """Poses (*shape, 4, 4) within about 2 m of the origin."""
    return exp(rng.uniform(-1.0, 1.0, (*shape, 6)) * np.array([1.6] * 3 + [1.0] * 3))
