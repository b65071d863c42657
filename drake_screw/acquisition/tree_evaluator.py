"""Rounds on a partition that refines itself: the tree draws where it needs to know more."""

from __future__ import annotations

import numpy as np

from drake_screw.acquisition.events import Evaluation, RegionsEvaluated
from drake_screw.acquisition.grid_evaluator import BATCH, Progress
from drake_screw.acquisition.tries import Executed, Executing, Tried, Try, begin_tries, joined
from drake_screw.bandits import Cell, CertifyOrSplit, TreeVerdict, Verdict, cell_number
from drake_screw.demonstrations import Demonstration
from drake_screw.planning import Outcomes, Planner, concatenate
from drake_screw.tasks import WorkArea, chance, from_unit_box, uniform
from drake_screw.typing import Array


class TreeEvaluator:
    """Evaluates demonstrations on instances that depend only on (seed, round, cell, number).

    It takes the place of `Evaluator`, with the cells of a tree for regions. Rounds build on one
    another: a cell once cleared stays so.

    Args:
        planner: plans the instances.
        area: the work area; the tree's unit box has an axis for each of its free axes.
        q_start: (n,) rad, start configuration of every plan.
        tree: decides where to draw and when enough is known.
        seed: of the run.
        progress: called with every batch's event, which has the counts of the whole area.
        executing: as of `Evaluator`.

    Raises:
        ValueError: the tree has another number of axes.
    """

    def __init__(
        self,
        planner: Planner,
        area: WorkArea,
        q_start: Array,
        tree: CertifyOrSplit,
        seed: int,
        progress: Progress | None = None,
        executing: Executing | None = None,
    ) -> None:
        free = int(area.free.sum())
        if tree.dimension != free:
            raise ValueError(f"the tree has {tree.dimension} axes, the work area {free} free ones")
        self._planner = planner
        self._area = area
        self._q_start = q_start
        self._tree = tree
        self._seed = seed
        self._progress = progress
        self._executing = executing
        self._frontier: tuple[Cell, ...] = ()

    def remember(self, evaluation: Evaluation) -> None:
        """Go on from a round that was evaluated earlier, as if it had been just now."""
        self._frontier = evaluation.frontier

    def start_over(self) -> None:
        """The next round's demonstrations need not include those before: no cell stays cleared.

        The whole area begins in the epoch after the last, so that delta is shared out as ever.
        """
        if self._frontier:
            self._frontier = self._tree.start(max(cell.epoch for cell in self._frontier))

    def evaluate(
        self, round: int, demonstrations: tuple[Demonstration, ...], attempt: int
    ) -> tuple[Evaluation, Verdict]:
        """Run one round; another demonstration has been added since the one before.

        Args:
            round: from 0; another round has fresh instances.
            demonstrations: in hand.
            attempt: without meaning here; the tree shares delta out over the rounds by itself.

        Returns:
            What was drawn in this round, and the verdict on the cells of its frontier. A cell that
            an earlier round cleared is not drawn in again: the verdict has the counts of then.
        """
        tree = self._tree
        before = tree.advance(self._frontier) if self._frontier else tree.start()
        with begin_tries(
            self._planner, self._executing, self._area, self._q_start, round, demonstrations
        ) as tries:
            pulls = _Pulls(self, round, tries)
            found = tree.decide(pulls, before)
        self._frontier = found.frontier
        return pulls.evaluation(found.frontier), self._verdict(found, pulls.looks)

    def _verdict(self, found: TreeVerdict, looks: int) -> Verdict:
        cells, goal = found.frontier, self._tree.goal
        lower, upper = np.array([self._tree.bounds(cell) for cell in cells]).T
        rates = [cell.s / cell.n if cell.n else 0.0 for cell in cells]
        return Verdict(
            certified=found.certified,
            region=int(np.argmax(rates)) if found.cell is None else cells.index(found.cell),
            reason=found.reason,
            claim=found.claim,
            samples=np.array([cell.n for cell in cells]),
            failures=np.array([cell.s for cell in cells]),
            lower=lower,
            upper=upper,
            level=1.0 - goal.delta,
            simultaneous=True,
            gap=None,
            coverage=max(goal.beta if found.certified else 0.0, 1.0 - float(upper.max())),
            attempted=True,
            looks=looks,
        )


class _Pulls:
    """The tree's source of samples, which remembers all it drew."""

    def __init__(self, evaluator: TreeEvaluator, round: int, tries: Try) -> None:
        self._by = evaluator
        self._round = round
        self._try = tries
        self._width = 0 if evaluator._executing is None else evaluator._executing.width
        self._drawn: dict[int, int] = {}
        self._failures = 0
        self._points: list[Array] = [np.empty((0, evaluator._tree.dimension))]
        outcomes, executed = self._tried(self._points[0], np.empty((0, self._width)))
        self._outcomes: list[Outcomes] = [outcomes]
        self._executed: list[Executed | None] = [executed]
        self.looks = 0

    def __call__(self, lower: Array, upper: Array, count: int) -> tuple[Array, Array]:
        number = cell_number(lower, upper)
        start = self._drawn.get(number, 0)
        self._drawn[number] = start + count
        self.looks += 1
        key = (self._round, number)
        unit = uniform(lower.shape, seed=self._by._seed, key=key, start=start, count=count)
        points = lower + unit * (upper - lower)
        numbers = chance(
            self._width, seed=self._by._seed, round=self._round, region=number,
            start=start, count=count,
        )  # fmt: skip
        batches = [slice(i, i + BATCH) for i in range(0, count, BATCH)]
        failed = [self._batch(points[some], numbers[some]) for some in batches]
        return points, np.concatenate(failed)

    def evaluation(self, frontier: tuple[Cell, ...]) -> Evaluation:
        points = np.concatenate(self._points)
        region = np.zeros(len(points), dtype=np.int64)
        for j, cell in enumerate(frontier):
            region[((points >= cell.lower) & (points < cell.upper)).all(axis=1)] = j
        coordinates = from_unit_box(self._by._area, points)
        return Evaluation(
            coordinates, region, concatenate(self._outcomes), frontier, joined(self._executed)
        )

    def _batch(self, points: Array, numbers: Array) -> Array:
        outcomes, executed = self._tried(points, numbers)
        self._points.append(points)
        self._outcomes.append(outcomes)
        self._executed.append(executed)
        failed = ~outcomes.any_success
        self._failures += int(failed.sum())
        if self._by._progress is not None:
            drawn = sum(len(part) for part in self._points)
            self._by._progress(
                RegionsEvaluated(self._round, np.array([drawn]), np.array([self._failures]))
            )
        return failed

    def _tried(self, points: Array, numbers: Array) -> Tried:
        return self._try(from_unit_box(self._by._area, points), numbers)
