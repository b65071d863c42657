"""What every batch planner is asked: whether it can be answered, and what needs no planning."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from drake_screw.demonstrations import Demonstration
from drake_screw.planning.outcomes import Cause, Outcomes
from drake_screw.robot import ScrewChain
from drake_screw.screws import translation_distance
from drake_screw.typing import Array


def check_question(
    chain: ScrewChain, demonstrations: Sequence[Demonstration], X_WO: Array, q_start: Array
) -> None:
    """Refuses what cannot be planned.

    Args:
        chain: the arm.
        demonstrations: to plan with.
        X_WO: (N, k, 4, 4) object poses of the instances.
        q_start: (n,) rad or m.

    Raises:
        ValueError: a number is not finite or an array has the wrong shape; a demonstration has no
            guiding poses, or names an object that X_WO lacks.
    """
    if q_start.shape != (chain.n,) or not np.isfinite(q_start).all():
        raise ValueError(f"q_start must be {chain.n} finite numbers, it is {q_start}")
    if X_WO.ndim != 4 or X_WO.shape[2:] != (4, 4):
        raise ValueError(f"X_WO has shape {X_WO.shape}, expected (N, k, 4, 4)")
    if not np.isfinite(X_WO.sum()):
        bad = int(np.argmax(~np.isfinite(X_WO).all(axis=(1, 2, 3))))
        raise ValueError(f"object poses X_WO of instance {bad} are not finite:\n{X_WO[bad]}")
    for d in demonstrations:
        if len(d.X_OE) == 0 or d.objects.max() >= X_WO.shape[1]:
            raise ValueError(
                f"demonstration '{d.name}' has {len(d.X_OE)} guiding poses for the objects "
                f"{sorted(set(d.objects.tolist()))}; X_WO has {X_WO.shape[1]} objects"
            )
        if not np.isfinite(d.X_OE).all():
            raise ValueError(f"demonstration '{d.name}' has guiding poses that are not finite")


def check_choice(
    which: NDArray[np.int64], variant: NDArray[np.int64], N: int, counts: NDArray[np.int64]
) -> None:
    """Refuses what is no demonstration, or no variant of it.

    Args:
        which, variant: (N,) of the demonstration and of its variant.
        N: instances.
        counts: (D,) variants of each demonstration.

    Raises:
        ValueError: an index is out of range, or there are not N of them.
    """
    D = len(counts)
    if which.shape != (N,) or ((which < 0) | (which >= D)).any():
        raise ValueError(f"which must be {N} indices from 0 to {D - 1}, it is {which}")
    if ((variant < 0) | (variant >= counts[which])).any():
        raise ValueError(f"variant must be one of those that there are, it is {variant}")


def nearest_first(demonstrations: Sequence[Demonstration], X_WO: Array) -> NDArray[np.int64]:
    """(N, D) demonstrations by how far their objects stood from X_WO (N, k, 4, 4), summed up."""
    away = [translation_distance(X_WO, d.X_WO).sum(axis=-1) for d in demonstrations]
    return np.argsort(np.stack(away, axis=-1), axis=-1, kind="stable")


def failed_start(chain: ScrewChain, q_start: Array, shape: tuple[int, ...]) -> Outcomes | None:
    """Outcomes of a start (n,) that is not strictly inside the limits; None of one that is."""
    margin = chain.margin(q_start)
    if (margin > 0.0).all():
        return None
    return Outcomes(
        np.full(shape, Cause.JOINT_LIMIT, dtype=np.uint8),
        np.zeros(shape, dtype=np.int16),
        np.full(shape, int(np.argmin(margin)), dtype=np.int8),
        np.zeros(shape, dtype=np.float32),
        np.zeros(shape, dtype=np.int16),
    )
