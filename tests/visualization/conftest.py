"""Rounds with real regions and invented outcomes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from pydrake.geometry import Meshcat

from drake_screw.acquisition.events import Evaluation, RoundFinished, Suggestion
from drake_screw.bandits import Verdict
from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Cause, Outcomes
from drake_screw.screws import pose_from_planar
from drake_screw.tasks import GridRegions, ObjectArea, WorkArea, draw, grid_regions
from drake_screw.visualization.lifetime import page_meshcat

BOWL = ObjectArea("bowl", (0.6, -0.3, 0.0), (1.0, 0.9, 0.0), 0.1)

MakeRound = Callable[..., RoundFinished]


@pytest.fixture(scope="module")
def meshcat() -> Meshcat:
    return page_meshcat("localhost")


@pytest.fixture
def regions() -> GridRegions:
    """2 x 3 cells of 0.2 m x 0.4 m."""
    return grid_regions(WorkArea((BOWL,)), {"x": 2, "y": 3})


@pytest.fixture
def make_round() -> MakeRound:
    """A round in which the first `failures[j]` of the instances of region j fail."""

    def make(
        regions: GridRegions,
        failures: list[int],
        *,
        number: int = 0,
        demonstrations: int = 2,
        each: int = 10,
        samples: list[int] | None = None,
    ) -> RoundFinished:
        bad = np.array(failures)
        drawn = np.array(samples if samples is not None else [each] * regions.K)
        coordinates = np.concatenate(
            [
                draw(regions, j, seed=5, round=number, start=0, count=int(n))
                for j, n in enumerate(drawn)
            ]
        )
        region = np.repeat(np.arange(regions.K), drawn)
        within = np.concatenate([np.arange(n) for n in drawn])
        cause = np.where(within < bad[region], 1 + within % 3, Cause.SUCCESS).astype(np.uint8)
        worst = int(np.argmax(bad / np.maximum(drawn, 1)))
        certified = not bad.any()
        estimates = bad / np.maximum(drawn, 1)
        verdict = Verdict(
            certified=certified,
            region=worst,
            reason="largest estimate <= <that & this>",
            claim="",
            samples=drawn,
            failures=bad,
            lower=np.maximum(estimates - 0.1, 0.0),
            upper=np.minimum(estimates + 0.1, 1.0),
            level=0.95,
            simultaneous=True,
            gap=None,
            coverage=0.0,
            attempted=True,
            looks=1,
        )
        lower, upper = regions.bounds(worst)
        suggestion = None if certified else Suggestion(worst, 0.25 * lower + 0.75 * upper, 1)
        return RoundFinished(
            number,
            tuple(demonstration(regions.area, i) for i in range(demonstrations)),
            Evaluation(
                coordinates, region, _outcomes(np.tile(cause[:, None], max(demonstrations, 1)))
            ),
            verdict,
            suggestion,
            regions,
        )

    return make


def demonstration(area: WorkArea, number: int) -> Demonstration:
    """Three guiding poses above the first object, which stands somewhere on a diagonal."""
    share = (number + 0.5) / 8.0
    X_WO = area.X_WO(area.lower + share * (area.upper - area.lower))
    height = np.linspace(0.1, 0.3, 3)
    X_OE = pose_from_planar(np.zeros((3, 3)), height)
    path = X_WO[0] @ pose_from_planar(np.zeros((40, 3)), np.linspace(0.5, 0.1, 40))
    kept = np.array([0, 20, 39])
    return Demonstration(f"demo_{number}", X_OE, np.zeros(3, dtype=np.int64), X_WO, path, kept)


def _outcomes(cause: np.ndarray) -> Outcomes:
    failed = cause != Cause.SUCCESS
    segment = np.where(failed, 1, -1).astype(np.int16)
    joint = np.where(cause == Cause.JOINT_LIMIT, 3, -1).astype(np.int8)
    return Outcomes(
        cause, segment, joint, np.where(failed, 0.5, 1.0).astype(np.float32), 0 * segment
    )
