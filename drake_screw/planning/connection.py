"""A way around what is in the way: start and goal connected by RRT-Connect, of OMPL.

RRT-Connect grows a tree of free motions from either end until they meet (Kuffner and LaValle, ICRA
2000). What is free, `PlanChecker` says. The way found is shortened, its corners are rounded, and
the rounded path is checked once more.

OMPL is an extra (``pip install drake-screw[ompl]``). The same question has the same answer,
whatever was asked before: OMPL's random numbers are seeded for each, and it stops after a number of
iterations, not after a time.
"""

from __future__ import annotations

import importlib
import importlib.util
import logging
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.planning.plan_checker import PlanChecker
from drake_screw.planning.rounding import rounded
from drake_screw.screws.endless import drawn_range
from drake_screw.typing import Array

ITERATIONS = 300
"""Of RRT-Connect at most: samples that the trees are grown towards."""

RANGE = 0.8
"""rad (or m), Euclidean, by which a tree grows towards a sample at once."""

SHORTCUTS = 100
"""Straight motions that are tried between two points of a way, to make it shorter."""

ABSENT = (
    "a plan fails where its free approach touches something; with OMPL the arm would be led around "
    "it: pip install 'drake-screw[ompl]'"
)
"""What is missed without OMPL."""

_LOG = logging.getLogger(__name__)

_ONE_AT_A_TIME = threading.Lock()
"""Seeds and log level are OMPL's own, one for the whole process."""


def available() -> bool:
    """Whether OMPL is installed."""
    return importlib.util.find_spec("ompl") is not None


@lru_cache
def warn_of_its_absence() -> None:
    """Says, once, what OMPL would be good for."""
    _LOG.warning(ABSENT)


def connect(
    checker: PlanChecker,
    q_start: ArrayLike,
    q_goal: ArrayLike,
    X_WO: ArrayLike,
    *,
    seed: int = 0,
    iterations: int = ITERATIONS,
) -> Array | None:
    """A joint path that touches nothing, from a start to a goal.

    Args:
        checker: of the workcell.
        q_start, q_goal: (n,) rad or m.
        X_WO: (k, 4, 4) the objects.
        seed: of the random numbers; the same gives the same path.
        iterations: of RRT-Connect at most.

    Returns:
        (m, n) points at even steps of the parameter of a curve as `rounded` makes it, within the
        joint limits; the first is the start, the last the goal. None if no way is found, or where
        start or goal are outside the limits or touch something.

    Raises:
        ImportError: OMPL is not installed.
    """
    q_start, q_goal = np.asarray(q_start, dtype=float), np.asarray(q_goal, dtype=float)
    X_WO = np.asarray(X_WO, dtype=float)
    ends = np.stack([q_start, q_goal])
    arm = checker.workcell.arm
    if (arm.margin(ends) < 0.0).any() or checker.workcell.collides(ends, X_WO).any():
        return None
    corners = _tree_path(checker, ends, X_WO, seed, iterations)
    if corners is None:
        return None
    ways = _shorter_and_shorter(checker, corners, X_WO, np.random.default_rng(seed))
    # The shorter a way, the nearer it goes past what it leads around, with less room for curves.
    for way in dict.fromkeys((len(ways) - 1, 3 * len(ways) // 4, len(ways) // 2, 0)):
        for q in rounded(ways[way]):
            if checker.free(q, X_WO):
                return q
    return None


def _tree_path(
    checker: PlanChecker,
    ends: Array,
    X_WO: Array,
    seed: int,
    iterations: int,
) -> Array | None:
    """The corners (c, n) of a free way, as RRT-Connect finds it; None if it does not.

    Args:
        checker, X_WO, seed, iterations: as `connect` has them.
        ends: (2, n) rad or m, start and goal.
    """
    base, geometric = (importlib.import_module(f"ompl.{name}") for name in ("base", "geometric"))
    arm, n = checker.workcell.arm, ends.shape[1]

    class Motions(base.MotionValidator):  # type: ignore[name-defined]
        """Asks about a whole motion at once."""

        def checkMotion(self, a: Any, b: Any) -> bool:
            return checker.free(np.stack([_joints(a, n), _joints(b, n)]), X_WO)

    space = base.RealVectorStateSpace(n)
    bounds = base.RealVectorBounds(n)
    lower, upper = drawn_range(arm.lower, arm.upper, ends)
    for i in range(n):
        bounds.setLow(i, float(lower[i]))
        bounds.setHigh(i, float(upper[i]))
    space.setBounds(bounds)
    left = iter(range(iterations))
    with _quiet(seed):
        information = base.SpaceInformation(space)
        # Of single states only those that a motion goes to are asked about; it is checked next.
        information.setStateValidityChecker(lambda _: True)
        information.setMotionValidator(Motions(information))
        information.setup()
        problem = base.ProblemDefinition(information)
        states = [space.allocState(), space.allocState()]
        for state, q in zip(states, ends.tolist(), strict=True):
            for i in range(n):
                state[i] = q[i]
        problem.setStartAndGoalStates(*states)
        planner = geometric.RRTConnect(information)
        planner.setProblemDefinition(problem)
        planner.setRange(RANGE)
        planner.setup()
        stop = base.PlannerTerminationCondition(lambda: next(left, None) is None)
        planner.solve(stop)
        if not problem.hasExactSolution():
            return None
        states = problem.getSolutionPath().getStates()
        found = np.array([_joints(state, n) for state in states])
    found[[0, -1]] = ends
    return found


@contextmanager
def _quiet(seed: int) -> Iterator[None]:
    """OMPL without a word, its next random numbers those of a seed."""
    util = importlib.import_module("ompl.util")
    with _ONE_AT_A_TIME:
        level = util.getLogLevel()
        util.setLogLevel(util.LOG_NONE)
        try:
            util.RNG.setSeed(seed + 1)
            yield
        finally:
            util.setLogLevel(level)


def _joints(state: Any, n: int) -> Array:
    """Joint positions (n,) of OMPL's state."""
    return np.array([state[i] for i in range(n)])


def _shorter_and_shorter(
    checker: PlanChecker, corners: Array, X_WO: Array, rng: np.random.Generator
) -> list[Array]:
    """Free ways: one through corners (c, n), then each with one more straight motion in it."""
    ways = [corners]
    for _ in range(SHORTCUTS):
        corners = ways[-1]
        if len(corners) == 2:
            break
        lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
        ends = np.cumsum(lengths)
        there = np.sort(rng.uniform(0.0, ends[-1], 2))
        i, j = np.minimum(np.searchsorted(ends, there, side="right"), len(lengths) - 1)
        if i == j:
            continue
        share = 1.0 - (ends[[i, j]] - there) / lengths[[i, j]]
        a, b = corners[[i, j]] + share[:, None] * (corners[[i + 1, j + 1]] - corners[[i, j]])
        if checker.free(np.stack([a, b]), X_WO):
            ways.append(np.concatenate([corners[: i + 1], [a, b], corners[j + 1 :]]))
    return ways
