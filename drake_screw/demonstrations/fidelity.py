"""How much of a recorded motion guiding poses keep, measured apart from how they were found."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numba import njit
from numpy.typing import NDArray

from drake_screw.demonstrations.faithful import FaithfulConfig
from drake_screw.demonstrations.regions import Regions
from drake_screw.screws import (
    quaternion_from_rotation,
    rotation_angle,
    sclerp,
    sclerp_position,
    translation_distance,
)
from drake_screw.typing import Array

_STEP, _TURN_STEP = 2.5e-4, 2.5e-3  # m, rad: screws are sampled so densely
_SAME = 0.2  # of the tolerances: samples nearer than this to a guiding pose may have become it


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
) -> tuple[Fidelity, ...]:
    """How faithfully guiding poses keep a recording, for each object of the task.

    What was shown near an object are the samples of its visits (`regions_of_interest`). The screws
    lead between guiding poses of one object that follow on each other; from the last before another
    object's to the first of that one, the way is free. Kept are the samples near the object from
    the one at the first guiding pose of such a run to the one at its last: the first and the last
    that are as near as any, to within a fifth of the tolerances.

    The screws are sampled every 0.25 mm and 2.5 mrad, and each sample kept is given a point of
    them, in the order shown. Of all ways to do that the largest deviation, in proportion to the
    tolerances, decides, then the sum of squares.

    Args:
        X_WE: (m, 4, 4) end-effector poses as recorded.
        t: (m,) s.
        X_WO: (k, 4, 4) object poses.
        X_OE: (g, 4, 4) guiding poses, however they were found, each in its object's frame.
        objects: (g,) index of that object.
        names: k names of objects.
        config: tolerances and regions.
        regions: `config.regions(X_WE, X_WO)`, if known; needed where objects are named.

    Returns:
        One for each object of the task and for any other with guiding poses, in their order.
    """
    regions = config.regions(X_WE, X_WO) if regions is None else regions
    guides = X_WO[objects] @ X_OE
    concerned = np.union1d(np.flatnonzero(regions.task), objects)
    return tuple(
        _fidelity(X_WE, t, regions, int(index), _runs(guides, objects, index), names[index], config)
        for index in concerned
    )


def _fidelity(
    X_WE: Array,
    t: Array,
    regions: Regions,
    index: int,
    runs: list[Array],
    name: str,
    config: FaithfulConfig,
) -> Fidelity:
    least = 2.0 * config.rotation_tolerance
    visits = [v for v in (*regions.visits, *regions.left_out) if v.object == index]
    shown = sum(turn(X_WE[v.start : v.stop], least) for v in visits)
    rest = regions.samples(index)
    kept, position, rotation, turned = [], [], [], 0.0
    for X in runs:
        screws = on_screws(X)
        turned += turn(screws, least)
        first, last = _stretch(X_WE[rest], X, config)
        samples, rest = rest[first : last + 1], rest[last + 1 :]
        if len(samples):
            away, off = deviations(X_WE[samples], screws, config)
            kept.append(samples)
            position.append(float(away.max()))
            rotation.append(float(off.max()))
    seconds = sum(np.diff(t, append=t[-1])[samples].sum() for samples in kept)
    return Fidelity(
        object=name,
        guiding_poses=sum(map(len, runs)),
        position=max(position, default=math.inf),
        rotation=max(rotation, default=math.inf),
        time=float(seconds / (t[-1] - t[0])) if t[-1] > t[0] else 0.0,
        turn_shown=shown,
        turn_kept=turned,
    )


def _stretch(samples: Array, guides: Array, config: FaithfulConfig) -> tuple[int, int]:
    """The first sample at the first guiding pose, and the last sample at the last one."""
    if not len(samples):
        return 0, -1
    first, last = (
        np.maximum(
            translation_distance(samples, X) / config.position_tolerance,
            rotation_angle(samples, X) / config.rotation_tolerance,
        )
        for X in (guides[0], guides[-1])
    )
    start = int(np.argmax(first <= first.min() + _SAME))
    last = last[start:]
    return start, start + int(np.flatnonzero(last <= last.min() + _SAME)[-1])


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


def on_screws(X_WE: Array) -> Array:
    """Poses densely on the constant screws from pose to pose; (g, 4, 4) to (M, 4, 4)."""
    parts = [X_WE[:1]]
    for A, B in pairwise(X_WE):
        chords = np.diff(sclerp_position(A, B, np.linspace(0.0, 1.0, 17)), axis=0)
        arc = 1.01 * float(np.linalg.norm(chords, axis=1).sum())
        steps = math.ceil(max(arc / _STEP, float(rotation_angle(A, B)) / _TURN_STEP, 1.0))
        parts.append(sclerp(A, B, np.arange(1, steps + 1) / steps))
    return np.concatenate(parts)


def deviations(samples: Array, track: Array, config: FaithfulConfig) -> tuple[Array, Array]:
    """How far samples are from a dense track, each held against one pose of it, in order.

    Args:
        samples: (n, 4, 4).
        track: (M, 4, 4).
        config: the tolerances, in proportion to which positions and rotations are weighed.

    Returns:
        (n,) m and (n,) rad.
    """
    at = _in_order(
        np.ascontiguousarray(samples[:, :3, 3]),
        quaternion_from_rotation(samples[:, :3, :3]),
        np.ascontiguousarray(track[:, :3, 3]),
        quaternion_from_rotation(track[:, :3, :3]),
        config.position_tolerance,
        config.rotation_tolerance,
    )
    return translation_distance(samples, track[at]), rotation_angle(samples, track[at])


def _runs(X_WE: Array, objects: NDArray[np.int64], index: int) -> list[Array]:
    """The guiding poses of one object, in runs that no other object's interrupt."""
    breaks = np.flatnonzero(np.diff(objects) != 0) + 1
    bounds = zip([0, *breaks], [*breaks, len(objects)], strict=True)
    return [X_WE[a:b] for a, b in bounds if a < b and objects[a] == index]


@njit(cache=True)
def _turn(q: Array, least: float) -> float:
    total, farthest, angle = 0.0, 0, 0.0
    anchor = 0
    for i in range(1, len(q)):
        away = 2.0 * np.arccos(min(1.0, abs((q[anchor] * q[i]).sum())))
        if away >= angle:
            farthest, angle = i, away
        elif 2.0 * np.arccos(min(1.0, abs((q[farthest] * q[i]).sum()))) > least:
            total += angle
            anchor, farthest = farthest, i
            angle = 2.0 * np.arccos(min(1.0, abs((q[anchor] * q[i]).sum())))
    return total + angle


@njit(cache=True)
def _in_order(
    p: Array, q: Array, P: Array, Q: Array, position_tolerance: float, rotation_tolerance: float
) -> NDArray[np.int64]:
    """For each sample (p, q) the pose of a track (P, Q): first the bottleneck, then the squares."""
    n, M = len(p), len(P)
    cost = np.empty((n, M))
    for k in range(n):
        for m in range(M):
            d0, d1, d2 = p[k, 0] - P[m, 0], p[k, 1] - P[m, 1], p[k, 2] - P[m, 2]
            away = np.sqrt(d0 * d0 + d1 * d1 + d2 * d2) / position_tolerance
            c = abs(q[k, 0] * Q[m, 0] + q[k, 1] * Q[m, 1] + q[k, 2] * Q[m, 2] + q[k, 3] * Q[m, 3])
            off = 2.0 * np.arccos(min(1.0, c)) / rotation_tolerance
            cost[k, m] = max(away, off)
    worst = np.zeros(M)
    for k in range(n):
        least = np.inf
        for m in range(M):
            least = min(least, worst[m])
            worst[m] = max(least, cost[k, m])
    bottleneck = worst.min()
    total = np.zeros(M)
    origin = np.empty((n, M), dtype=np.int32)
    for k in range(n):
        least, where = np.inf, 0
        for m in range(M):
            if total[m] < least:
                least, where = total[m], m
            origin[k, m] = where
            total[m] = least + cost[k, m] ** 2 if cost[k, m] <= bottleneck else np.inf
    chosen = np.empty(n, dtype=np.int64)
    at = np.argmin(total)
    for k in range(n - 1, -1, -1):
        chosen[k] = at
        at = origin[k, at]
    return chosen
