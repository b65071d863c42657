"""How much of a recorded motion guiding poses keep, measured apart from how they were found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.compile_cache import cached_njit
from drake_screw.demonstrations.deviations import (
    Deviations,
    deviations_from_screws,
    on_screws,
    runs_of,
)
from drake_screw.demonstrations.faithful import FaithfulConfig
from drake_screw.demonstrations.regions import Regions
from drake_screw.screws import quaternion_from_rotation
from drake_screw.typing import Array


@dataclass(frozen=True)
class Fidelity:
    """How faithfully guiding poses keep what was shown near one object.

    Attributes:
        object: its name.
        guiding_poses: how many are its own.
        position: m, and
        rotation: rad, largest deviation of the samples kept from the screws through the guiding
            poses, each sample held against one point of a screw, in the order shown; infinite where
            no sample is kept.
        time: share of the recording's time in which the samples kept were recorded.
        turn_shown: rad, how much the end effector turned near the object (see `turn`).
        turn_kept: rad, how much it turns on the screws.
    """

    object: str
    guiding_poses: int
    position: float
    rotation: float
    time: float
    turn_shown: float
    turn_kept: float

    def __str__(self) -> str:
        if not self.guiding_poses:
            return f"no guiding pose of the {self.object}; {self.turn_shown:.2f} rad of turn lost"
        poses = f"{self.guiding_poses} guiding pose{'s' if self.guiding_poses > 1 else ''}"
        return (
            f"{poses} of the {self.object}; kept to {self.position * 1e3:.0f} mm and "
            f"{self.rotation:.2f} rad; turn {self.turn_kept:.2f} of {self.turn_shown:.2f} rad"
        )


def fidelity(
    X_WE: Array,
    t: Array,
    X_WO: Array,
    X_OE: Array,
    objects: NDArray[np.int64],
    names: Sequence[str],
    config: FaithfulConfig,
    *,
    regions: Regions | None = None,
    deviations: Sequence[Deviations] | None = None,
) -> tuple[Fidelity, ...]:
    """How faithfully guiding poses keep a recording, for each object of the task.

    What was shown near an object are the samples of its visits (`regions_of_interest`); which of
    them are kept, and how far from the screws each is, `deviations_from_screws` says.

    Args:
        X_WE: (m, 4, 4) end-effector poses as recorded.
        t: (m,) s.
        X_WO: (k, 4, 4) object poses.
        X_OE: (g, 4, 4) guiding poses, however they were found, each in its object's frame.
        objects: (g,) index of that object.
        names: k names of objects.
        config: tolerances and regions.
        regions: `config.regions(X_WE, X_WO)`, if known; needed where objects are named.
        deviations: those of `deviations_from_screws`, if known.

    Returns:
        One for each object of the task and for any other with guiding poses, in their order.
    """
    regions = config.regions(X_WE, X_WO) if regions is None else regions
    if deviations is None:
        deviations = deviations_from_screws(X_WE, X_WO, X_OE, objects, config, regions=regions)
    guides = X_WO[objects] @ X_OE
    least = 2.0 * config.rotation_tolerance
    return tuple(
        _fidelity(X_WE, t, regions, near, runs_of(guides, objects, near.object), names, least)
        for near in deviations
    )


def _fidelity(
    X_WE: Array,
    t: Array,
    regions: Regions,
    near: Deviations,
    runs: Sequence[Array],
    names: Sequence[str],
    least: float,
) -> Fidelity:
    visits = [v for v in (*regions.visits, *regions.left_out) if v.object == near.object]
    seconds = np.diff(t, append=t[-1])[near.samples].sum()
    return Fidelity(
        object=names[near.object],
        guiding_poses=sum(map(len, runs)),
        position=float(near.position.max()) if len(near.position) else math.inf,
        rotation=float(near.rotation.max()) if len(near.rotation) else math.inf,
        time=float(seconds / (t[-1] - t[0])) if t[-1] > t[0] else 0.0,
        turn_shown=sum(turn(X_WE[v.start : v.stop], least) for v in visits),
        turn_kept=sum(turn(on_screws(X), least) for X in runs),
    )


def turn(X_WE: Array, least: float) -> float:
    """How much a path turns, there and back added up; rad.

    The sum of the angles from one turning point to the next: the first pose is one, and so is each
    pose at which the path is farthest, by angle, from the turning point before, if afterwards it
    turns away from there by more than `least`; the way to the farthest pose after the last of them
    is added. So trembling and oscillating by less do not count. About one axis it is the total
    variation of the angle, beyond pi as well.

    `fidelity` takes twice the tolerance for `least`: from oscillating by less, a path within the
    tolerance need not oscillate. An oscillation of up to twice `least` may become one of less than
    `least` on such a path, and then counts as lost altogether.

    Args:
        X_WE: (m, 4, 4).
        least: rad.

    >>> from drake_screw.screws import pose_from_planar
    >>> there_and_back = np.zeros((200, 3))
    >>> there_and_back[:, 2] = np.concatenate([np.linspace(0, 1.5, 100), np.linspace(1.5, 0, 100)])
    >>> round(turn(pose_from_planar(there_and_back), 0.1), 6)
    3.0
    """
    q = quaternion_from_rotation(X_WE[:, :3, :3])
    return float(_turn(q, least))


@cached_njit()
def _turn(q: Array, least: float) -> float:
    total, farthest, angle = 0.0, 0, 0.0
    anchor = 0
    for i in range(1, len(q)):
        away = _apart(q[anchor], q[i])
        if away >= angle:
            farthest, angle = i, away
        elif _apart(q[farthest], q[i]) > least:
            total += angle
            anchor, farthest = farthest, i
            angle = _apart(q[anchor], q[i])
    return total + angle


@cached_njit()
def _apart(a: Array, b: Array) -> float:
    cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
    return 2.0 * np.arccos(min(1.0, abs(cosine)))
