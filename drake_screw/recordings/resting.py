"""Where an object stood that was watched: its pose before it moved, out of many that jitter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drake_screw.errors import counted
from drake_screw.recordings.frames import ALWAYS
from drake_screw.screws import (
    pose,
    quaternion_from_rotation,
    quaternion_from_rotation_vector,
    rotation_angle,
    rotation_from_quaternion,
    rotation_vector_from_quaternion,
)
from drake_screw.typing import Array

MOVED = 0.02
"""m from where it stood, beyond which an object has moved; below it is jitter."""
TURNED = 0.2
"""rad, likewise."""
SCATTER = 3.0
"""times the median distance from where it stood first, in the first `SPAN`: jitter, too."""
NEAR = 0.2
"""m from the hand, within which an object may be hidden from a camera, or touched."""
SPAN = 0.5
"""s in which most of the poses have to be elsewhere if the object has moved."""
SOON = 5
"""Poses in a row, most of which have to be, too, from the first on that counts."""
JITTER = 1e-3
"""m by which half of the poses may be off without a note."""
SAME = 1e-5
"""m and rad, within which half of the poses are all but equal."""
FEW = 3
"""Poses, of which less are no sample to take a median of."""


@dataclass(frozen=True, eq=False)
class Resting:
    """Where an object stood, X_WO (4, 4), how that was found, and what is to be noted."""

    X: Array
    how: str
    notes: tuple[str, ...] = ()


def at_rest(name: str, t: Array, X_WO: Array, hand_t: Array, p_WE: Array) -> Resting:
    """Where an object stood before it moved, if it did.

    The pose is the median of those before the hand came near (within `NEAR`), or if there are but
    a `FEW` of them, of all before the object moved. It has moved when most of the poses told within
    `SPAN` are more than `MOVED` or `TURNED` from where it stood first, or more than `SCATTER` times
    as far as they scatter then; single ones that are far off do not count.

    Args:
        name: of the object.
        t: (m,) s since the recording's first sample, increasing; `ALWAYS` where it is static.
        X_WO: (m, 4, 4).
        hand_t: (n,) s, of the recording's samples.
        p_WE: (n, 3) m, where the hand was then.
    """
    if t[0] == ALWAYS:
        return Resting(X_WO[0], "a static transform")
    kept, how = _during(t, float(hand_t.max(initial=0.0)))
    t, X_WO = np.maximum(t[kept], 0.0), X_WO[kept]
    if len(t) == 1:
        return Resting(X_WO[0], how)
    since, notes = _moved(name, t, X_WO)
    standing = X_WO[:since]
    X = median_pose(standing)
    close = np.linalg.norm(p_WE - X[:3, 3], axis=-1) < NEAR
    near = float(hand_t[np.argmax(close)]) if close.any() else np.inf
    before = int(np.count_nonzero(t[:since] < near))
    until = "before it moved" if since < len(t) else "all along"
    if FEW <= before < since:
        standing = standing[:before]
        X = median_pose(standing)
        until = f"until the hand came within {NEAR:g} m of it at {near:.2f} s"
    if len(standing) == 1:
        return Resting(X, f"the only pose {until}", notes)
    off = float(np.median(np.linalg.norm(standing[:, :3, 3] - X[:3, 3], axis=-1)))
    turn = float(np.median(rotation_angle(X, standing)))
    how = f"the median of {counted(len(standing), 'pose')} {until}"
    spread = f"half of them within {off * 1e3:.1f} mm and {turn:.3f} rad of it"
    if max(off, turn) < SAME:
        spread = "most of them the same"
    if off > JITTER:
        notes = (*notes, f"the {name} is taken to be at {how}, {spread}")
    return Resting(X, f"{how}, {spread}", notes)


def median_pose(X: Array) -> Array:
    """The pose (4, 4) whose position and rotation are the medians of those of X (m, 4, 4).

    Of rotations, the one from which the rotation vectors to all have median 0.
    """
    R = X[0, :3, :3]
    for _ in range(20):
        to_each = np.swapaxes(R[None], -1, -2) @ X[:, :3, :3]
        w = np.median(rotation_vector_from_quaternion(quaternion_from_rotation(to_each)), axis=0)
        R = R @ rotation_from_quaternion(quaternion_from_rotation_vector(w))
        if np.abs(w).max() < 1e-12:
            break
    return np.asarray(pose(R, np.median(X[:, :3, 3], axis=0)))


def _during(t: Array, end: float) -> tuple[slice, str]:
    """Which poses count: those during the recording and the last one before; else the first after.

    That an object was there before is known from the last time that it was told.
    """
    first = max(int(np.searchsorted(t, 0.0, side="right")) - 1, 0)
    last = max(int(np.searchsorted(t, end, side="right")), first + 1)
    at = float(t[first])
    if last - first > 1 or 0.0 <= at <= end:
        how = f"the only pose, at {at:.2f} s"
    elif at < 0.0:
        how = f"the last pose before the recording, {-at:.2f} s before its start"
    else:
        how = f"the first pose after the recording, {at - end:.2f} s after its end"
    return slice(first, last), how


def _moved(name: str, t: Array, X_WO: Array) -> tuple[int, tuple[str, ...]]:
    """How many of the poses are those before it moved, and a note if it did."""
    begin = t <= t[0] + SPAN
    first = median_pose(X_WO[begin])
    away = np.linalg.norm(X_WO[:, :3, 3] - first[:3, 3], axis=-1)
    turned = rotation_angle(first, X_WO)
    far, askew = (
        max(least, SCATTER * float(np.median(each[begin])))
        for least, each in ((MOVED, away), (TURNED, turned))
    )
    off = (away > far) | (turned > askew)
    until = np.searchsorted(t, t + SPAN, side="right")
    count = until - np.arange(len(t))
    total = np.append(0, np.cumsum(off))
    soon = np.minimum(np.arange(len(t)) + SOON, until)
    most = (2 * (total[until] - total[:-1]) > count) & (
        2 * (total[soon] - total[:-1]) > soon - np.arange(len(t))
    )
    often = float(np.median(np.diff(t))) < SPAN / FEW
    since = np.flatnonzero(off & most & (count >= (FEW if often else 1)))
    since = since[since > 0]
    if not len(since):
        return len(t), ()
    i = int(since[0])
    by, turn = (
        float(np.quantile(each[i:][off[i:]], 0.95, method="lower")) for each in (away, turned)
    )
    how = f"moved by {by * 100:.1f} cm" if by > far else f"turned by {turn:.2f} rad"
    return i, (f"the {name} {how} at {t[i]:.2f} s; its pose is the one before that",)
