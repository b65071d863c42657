"""The work area: the largest rectangle that one demonstration at its farthest corner covers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.acquisition.first import first_place
from drake_screw.onboarding.rectangles import Rectangle, best_rectangle
from drake_screw.onboarding.trial import Trial
from drake_screw.tasks import ObjectArea, WorkArea
from drake_screw.typing import Array

LARGEST = (0.4, 1.0)
"""m, along x and y; beyond it no work area is better."""

SMALLEST = (0.1, 0.1)
"""m. Below it there is none."""

WANTED = (0.3, 0.4)
"""m, from which on a work area is as large as one would like."""

ENOUGH = 0.97
"""Share of places that have to be planned for."""

PLACES = 400
ROUNDS = 8
SHRUNK = 0.05
"""m, that a side is moved in by."""


@dataclass(frozen=True, eq=False)
class Survey:
    """Places on a table that are planned for from a start, with demonstrations at some of them.

    Attributes:
        x, y: (X,), (Y,) m.
        good: (X, Y).
        given: (d, 2) m, where demonstrations were given.
    """

    x: Array
    y: Array
    good: NDArray[np.bool_]
    given: Array


@dataclass(frozen=True)
class Verified:
    """A work area, and the share of places in it that one demonstration covers."""

    area: Rectangle
    share: float
    corner: tuple[float, float]


def survey(trial: Trial, x: Array, y: Array, places: Array) -> Survey:
    """Plan for all of a grid with demonstrations at some places (d, 2), as far as they succeed."""
    given, taught = [], []
    for place in places:
        demonstration = trial.demonstration(*map(float, place))
        if demonstration is not None:
            given.append(place)
            taught.append(demonstration)
    xy = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    good = np.zeros(len(xy), dtype=bool)
    # Grids of several demonstrations: what each covers counts, not what all do together.
    alone = [trial.success([demonstration], xy) for demonstration in taught]
    if alone:
        best = max(range(len(alone)), key=lambda i: int(alone[i].sum()))
        good = alone[best]
        given = [given[best]]
    return Survey(x, y, good.reshape(len(x), len(y)), np.array(given).reshape(-1, 2))


def verify(
    trial: Trial,
    begin: Rectangle,
    shoulder: Array,
    middle: tuple[float, float],
    spacing: float,
    say: Callable[[str], None],
) -> Verified | None:
    """Shrink a work area until a demonstration at its farthest corner covers it.

    Args:
        trial: of the workcell and the start.
        begin: the area to begin with.
        shoulder: (3,) m.
        middle: (x, y) m, that the area is to be around.
        spacing: m, of the grid it is looked at on.
        say: told of each attempt.

    Returns:
        None where it would become too small.
    """
    area = begin
    rng = np.random.default_rng(0)
    for _ in range(ROUNDS):
        if area.size[0] < SMALLEST[0] - 1e-9 or area.size[1] < SMALLEST[1] - 1e-9:
            return None
        corner = farthest_corner(area, shoulder)
        demonstration = trial.demonstration(*corner)
        if demonstration is None:
            say(f"no demonstration at {corner[0]:.2f}, {corner[1]:.2f}; a smaller area")
            area = _without_corner(area, corner)
            continue
        xy = rng.uniform([area.x[0], area.y[0]], [area.x[1], area.y[1]], (PLACES, 2))
        share = float(trial.success([demonstration], xy).mean())
        width, depth = area.size[1], area.size[0]
        say(f"{depth:.2f} x {width:.2f} m: {share:.1%} of {PLACES} places are planned for")
        if share >= ENOUGH:
            return Verified(area, share, corner)
        x, y = _grid(area.x, spacing), _grid(area.y, spacing)
        grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        good = trial.success([demonstration], grid).reshape(len(x), len(y))
        smaller = best_rectangle(x, y, good, most=LARGEST, middle=middle)
        if smaller is None:
            return None
        area = _shrunk(area) if smaller == area else smaller
    return None


def farthest_corner(area: Rectangle, shoulder: Array) -> tuple[float, float]:
    """x, y in m of the corner where a run asks for its first demonstration."""
    item = ObjectArea("bowl", (area.x[0], area.y[0], 0.0), (area.x[1], area.y[1], 0.0), 0.0)
    x, y, _ = first_place("farthest", WorkArea((item,)), shoulder)[0].tolist()
    return x, y


def _grid(interval: tuple[float, float], spacing: float) -> Array:
    count = max(round((interval[1] - interval[0]) / spacing), 1)
    return np.linspace(*interval, count + 1)


def _without_corner(area: Rectangle, corner: tuple[float, float]) -> Rectangle:
    """Both sides at a corner moved in, and the opposite one in y, too, so that it stays put."""
    x0, x1 = area.x
    x0, x1 = (x0, x1 - SHRUNK) if corner[0] == x1 else (x0 + SHRUNK, x1)
    return Rectangle((x0, x1), (area.y[0] + SHRUNK, area.y[1] - SHRUNK))


def _shrunk(area: Rectangle) -> Rectangle:
    half = SHRUNK / 2.0
    return Rectangle((area.x[0] + half, area.x[1] - half), (area.y[0] + half, area.y[1] - half))
