"""Where a recorded path is near an object of the task, and which one: decided sample by sample."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from drake_screw.screws import translation_distance
from drake_screw.typing import Array


@dataclass(frozen=True)
class Visit:
    """A stretch of a recording in an object's region of interest: samples start to stop - 1."""

    object: int
    start: int
    stop: int


@dataclass(frozen=True)
class Regions:
    """Where the end effector was near which object.

    Attributes:
        smallest: (k,) m, the smallest distance of each object to the end effector.
        task: (k,) bool, which objects belong to the task; the others are bystanders.
        visits: in the order of time, those that are kept.
        left_out: the others.
    """

    smallest: Array
    task: NDArray[np.bool_]
    visits: tuple[Visit, ...]
    left_out: tuple[Visit, ...]

    def samples(self, index: int, *, all_visits: bool = False) -> NDArray[np.int64]:
        """Indices of the samples near an object, in the visits kept or in all."""
        visits = self.visits + (self.left_out if all_visits else ())
        parts = [np.arange(v.start, v.stop) for v in visits if v.object == index]
        return np.sort(np.concatenate(parts)) if parts else np.zeros(0, dtype=np.int64)


def regions_of_interest(
    X_WE: Array,
    X_WO: Array,
    *,
    factor: float,
    reach: float,
    slack: float,
    named: Sequence[int] | None = None,
) -> Regions:
    """The visits of an end effector to the objects of a task.

    An object belongs to the task if it is named or, where none is named, if the end effector comes
    within `reach` of it. Each sample belongs to the object of the task that is nearest in metres,
    and is in its region of interest within `factor` times the object's smallest distance. A visit
    is an unbroken run of such samples. So that trembling breaks no run, the nearest object changes
    only once another is nearer by more than `slack`, and a run ends only where the end effector
    leaves the region by more than `slack`; a visit starts and stops inside the region.

    Where the end effector comes back to an object without visiting another between, the first visit
    that comes as near as any of these (to within `slack`) is kept, and the others are left out: a
    screw that joined two of them would lead from the region's edge to its edge, perhaps through the
    object, as nobody has shown. For a recording of one object that is, unless the end effector only
    grazes the region first, the first run, as in Mahalingam and Chakraborty (ICRA 2023). After a
    visit to another object the end effector comes back from there, and the visit is kept.

    Args:
        X_WE: (m, 4, 4) end-effector poses.
        X_WO: (k, 4, 4) object poses.
        factor: on the smallest distance, at least 1.
        reach: m.
        slack: m.
        named: indices of the objects of the task, if they are known.
    """
    distance = translation_distance(X_WE[:, None], X_WO[None])
    smallest = distance.min(axis=0)
    task = smallest <= reach if named is None else np.isin(np.arange(len(X_WO)), list(named))
    if not task.any():
        return Regions(smallest, task, (), ())
    owner = _nearest(np.where(task, distance, np.inf), slack)
    beyond = distance[np.arange(len(owner)), owner] - (factor * smallest)[owner]
    found = _visits(owner, beyond, slack)
    kept: list[Visit] = []
    for _, again in groupby(found, key=lambda visit: visit.object):
        visits = list(again)
        nearest = [distance[v.start : v.stop, v.object].min() for v in visits]
        close = [d <= min(nearest) + slack for d in nearest]
        kept.append(visits[close.index(True)])
    return Regions(smallest, task, tuple(kept), tuple(v for v in found if v not in kept))


def _nearest(distance: Array, slack: float) -> NDArray[np.int64]:
    nearest = np.argmin(distance, axis=1)
    least = distance.min(axis=1) + slack
    owner = nearest.copy()
    if (nearest != nearest[0]).any():
        for i in range(1, len(owner)):
            if distance[i, owner[i - 1]] <= least[i]:
                owner[i] = owner[i - 1]
    return owner


def _visits(owner: NDArray[np.int64], beyond: Array, slack: float) -> list[Visit]:
    """Runs of one owner, not beyond its region by more than slack, trimmed to what is inside."""
    near = beyond <= slack
    breaks = np.flatnonzero((np.diff(owner) != 0) | (near[1:] != near[:-1])) + 1
    found = []
    for start, stop in zip([0, *breaks], [*breaks, len(owner)], strict=True):
        inside = np.flatnonzero(beyond[start:stop] <= 0.0)
        if len(inside):
            bounds = int(start + inside[0]), int(start + inside[-1]) + 1
            found.append(Visit(int(owner[start]), *bounds))
    return found
