"""Verdicts on collisions along plans beside Drake's own, asked every 2 mm of travel."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from joint_paths import Noted, Spacing
from task import Task

from drake_screw.planning import BatchPlanner
from drake_screw.robot import Workcell
from drake_screw.typing import Array

CLOSE = 2e-3
"""m, of travel between configurations that Drake is asked about."""

FAR = 0.05
"""m, up to which Drake is asked how far apart everything is."""

BATCH = 512
"""Instances at a time whose paths are noted."""


def agreement(task: Task, workcell: Workcell, count: int, seed: int) -> Iterator[dict[str, Any]]:
    """Verdicts on plans that keep the limits, beside Drake every 2 mm of travel: so far, and so on.

    Of a plan that touches something Drake is asked at the place first; only where it does not
    agree, all along.
    """
    checker, rng = Noted(workcell), np.random.default_rng(seed)
    points = Spacing(checker, CLOSE)
    planner = BatchPlanner(task.arm.screw_chain()).checked(checker)
    said = {"plans": 0, "touch": 0, "configurations": 0}
    missed: list[dict[str, Any]] = []
    unconfirmed: list[dict[str, Any]] = []
    while said["plans"] < count:
        checker.noted.clear()
        X_WO = task.instances(BATCH, rng)
        planner.all_outcomes(task.demonstrations, X_WO, task.q_start)
        for steps, first, objects, found in sorted(checker.noted, key=_paths):
            kept = rng.permutation(len(objects))[: max(1, len(objects) // 8)]
            for i in kept[: count - said["plans"]]:
                said["plans"] += 1
                said["touch"] += int(found.touches[i])
                X, own = objects[i], steps[first[i] : first[i + 1]]
                if found.touches[i] and workcell.collides(found.q[i : i + 1], X)[0]:
                    continue
                hits, asked = drake_finds(workcell, *points(own), X)
                said["configurations"] += asked
                if found.touches[i] and len(hits) == 0:
                    unconfirmed.append(depth(workcell, found.q[i], X))
                elif not found.touches[i] and len(hits):
                    worst = min((depth(workcell, q, X) for q in hits), key=lambda d: d["m"])
                    missed.append(worst | {"configurations": len(hits)})
        yield {**said, "missed": missed, "unconfirmed": unconfirmed}


def _paths(noted: tuple[Array, Array, Array, Any]) -> bytes:
    """By what paths are sorted, so that those looked at do not depend on the threads' order."""
    steps, _, objects, _ = noted
    return objects.tobytes() + steps.tobytes()


def drake_finds(workcell: Workcell, q: Array, gone: Array, X_WO: Array) -> tuple[list[Array], int]:
    """Those of the configurations of a path at which Drake finds a contact.

    Where Drake finds everything apart, two shapes are so still while neither has travelled half of
    that; the configurations so near are passed over.

    Args:
        q, gone: (m, n) and (m,) m, as `Spacing` has them.
        X_WO: (k, 4, 4) the objects.

    Returns:
        Them; and how many Drake was asked about.
    """
    hits, asked, k = [], 0, 0
    while k < len(q):
        near = workcell.checker.CalcRobotClearance(workcell.positions(q[k], X_WO), FAR)
        least = min([FAR, *near.distances()])
        asked += 1
        if least <= 0.0:
            hits.append(q[k])
        k = max(k + 1, int(np.searchsorted(gone, gone[k] + 0.5 * least)))
    return hits, asked


def depth(workcell: Workcell, q: Array, X_WO: Array) -> dict[str, Any]:
    """The least signed distance in m at q (n,) by Drake, and the bodies it is of."""
    near = workcell.checker.CalcRobotClearance(workcell.positions(q, X_WO), 0.01)
    distances = np.asarray(near.distances())
    if len(distances) == 0:
        return {"m": float("nan"), "bodies": []}
    k = int(distances.argmin())
    bodies = near.robot_indices()[k], near.other_indices()[k]
    names = [workcell.name(body) for body in bodies]
    return {"m": float(distances[k]), "bodies": names}


def report_agreement(found: dict[str, Any]) -> None:
    """Print what `agreement` found."""
    print(
        f"  {found['plans']:,} plans beside Drake every {1e3 * CLOSE:g} mm: "
        f"{found['touch']:,} touch something, {len(found['missed'])} that Drake finds are "
        f"missed, {len(found['unconfirmed'])} it does not find "
        f"({found['configurations']:,} configurations)"
    )
    for kind in ("missed", "unconfirmed"):
        list_depths(kind, found[kind])


def list_depths(kind: str, found: Sequence[dict[str, Any]]) -> None:
    """Print what `depth` says of some configurations."""
    for one in found:
        print(f"    {kind}: {1e3 * one['m']:.4f} mm, {' and '.join(one['bodies'])}")
