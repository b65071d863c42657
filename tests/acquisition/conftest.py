"""A world without a robot: a demonstration solves every instance near the place it was given at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from drake_screw.acquisition import Evaluation, Lesson, Suggestion
from drake_screw.bandits import Goal, make_strategy
from drake_screw.demonstrations import Demonstration, Recording
from drake_screw.planning import Cause, Outcomes
from drake_screw.screws import pose_from_planar
from drake_screw.tasks import ObjectArea, WorkArea, draw, grid_regions


def recording_at(name: str, x: float, y: float) -> Recording:
    return Recording(
        name,
        ("j0",),
        np.array([0.0, 1.0]),
        np.array([[0.0], [1.0]]),
        pose_from_planar([[x, y, 0.0]]),
    )


def learn(recording: Recording) -> Demonstration:
    X_OE = np.eye(4)[None]
    return Demonstration(recording.name, X_OE, np.array([0]), recording.X_WO, X_OE, np.array([0]))


@dataclass
class Disks:
    """Evaluates with the strategy of the paper; each demonstration covers a disk."""

    radius: float
    seed: int = 0
    log: list[tuple[int, int]] | None = None

    def __post_init__(self) -> None:
        area = WorkArea((ObjectArea("bowl", (0.0, 0.0, 0.0), (1.0, 1.0, 0.0), 0.0),))
        self.regions = grid_regions(area, {"x": 2, "y": 2})
        self.strategy = make_strategy("naive_pac", Goal(0.7, 0.2, 0.1))
        self.log = []

    def evaluate(self, round, demonstrations, attempt):
        self.log.append((round, attempt))
        taken = np.zeros(4, dtype=int)
        seen, region = [], []

        def pull(counts):
            failures = np.zeros(4, dtype=int)
            for j, n in enumerate(counts):
                places = draw(
                    self.regions, j, seed=self.seed, round=round, start=int(taken[j]), count=int(n)
                )
                taken[j] += n
                seen.append(places)
                region.append(np.full(n, j))
                failures[j] = np.count_nonzero(~self.solves(places, demonstrations).any(axis=1))
            return failures

        verdict = self.strategy.decide(pull, 4, attempt=attempt)
        places = np.concatenate(seen)
        solved = self.solves(places, demonstrations)
        cause = np.where(solved, Cause.SUCCESS, Cause.JOINT_LIMIT).astype(np.uint8)
        segment = np.where(solved, -1, (places[:, 0, 0, None] > 0.75).astype(int)).astype(np.int16)
        outcomes = Outcomes(
            cause,
            segment,
            segment.astype(np.int8),
            solved.astype(np.float32),
            np.zeros_like(segment),
        )
        return Evaluation(places, np.concatenate(region), outcomes), verdict

    def solves(self, places, demonstrations):
        if not demonstrations:
            return np.zeros((len(places), 0), dtype=bool)
        centers = np.array([d.X_WO[0, :2, 3] for d in demonstrations])
        return np.linalg.norm(places[:, 0, None, :2] - centers, axis=-1) < self.radius


class Obliging:
    """Demonstrates wherever it is asked to, up to a number of times."""

    def __init__(self, most: int = 1000) -> None:
        self.most = most
        self.asked: list[Suggestion] = []

    def demonstrate(self, suggestion, *, number, used, rng):
        self.asked.append(suggestion)
        if number >= self.most:
            return Lesson(None, "no more")
        x, y, _ = suggestion.coordinates[0]
        return Lesson(recording_at(f"demo_{number + 1:02d}", x, y), "as asked")


@pytest.fixture
def disks() -> Disks:
    return Disks(radius=0.45)
