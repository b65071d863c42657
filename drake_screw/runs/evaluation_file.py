"""The file of a round's instances: where they are, what became of them, and the tree's cells."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.acquisition import Evaluation
from drake_screw.bandits import Cell
from drake_screw.planning import Outcomes


def save_evaluation(file: Path, evaluation: Evaluation) -> None:
    """Write the instances of a round and their outcomes as .npz."""
    outcomes = evaluation.outcomes
    arrays: dict[str, Any] = {
        "x_y_yaw": evaluation.x_y_yaw,
        "region": evaluation.region.astype(np.uint16),
        "cause": outcomes.cause,
        "segment": outcomes.segment,
        "joint": outcomes.joint,
        "fraction": outcomes.fraction,
        **_frontier_arrays(evaluation.frontier),
    }
    np.savez_compressed(file, **arrays)


def load_evaluation(file: Path) -> Evaluation:
    """Read what `save_evaluation` wrote."""
    with np.load(file) as data:
        outcomes = Outcomes(data["cause"], data["segment"], data["joint"], data["fraction"])
        region = data["region"].astype(np.int64)
        return Evaluation(data["x_y_yaw"], region, outcomes, _frontier(data))


def _frontier_arrays(frontier: tuple[Cell, ...]) -> dict[str, np.ndarray]:
    """The cells as arrays with a first axis for cells, and of samples, cell after cell."""
    if not frontier:
        return {}
    each = ("lower", "upper", "depth", "epoch", "cleared", "n")
    arrays = {f"cell_{name}": np.array([getattr(c, name) for c in frontier]) for name in each}
    points = np.concatenate([cell.points for cell in frontier])
    failed = np.concatenate([cell.failed for cell in frontier])
    return {**arrays, "cell_points": points, "cell_failed": failed}


def _frontier(data: Mapping[str, np.ndarray]) -> tuple[Cell, ...]:
    """What `_frontier_arrays` made arrays of."""
    if "cell_n" not in data:
        return ()
    ends = np.cumsum(data["cell_n"])[:-1]
    columns = (
        data["cell_lower"],
        data["cell_upper"],
        data["cell_depth"].tolist(),
        data["cell_epoch"].tolist(),
        np.split(data["cell_points"], ends),
        np.split(data["cell_failed"], ends),
        data["cell_cleared"].tolist(),
    )
    return tuple(Cell(*values) for values in zip(*columns, strict=True))
