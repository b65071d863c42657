"""Guiding poses that keep what was shown: every sample near an object, in place and in turn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.compile_cache import cached_njit
from drake_screw.demonstrations.adjustment import adjusted
from drake_screw.demonstrations.fewest_screws import fewest_screws
from drake_screw.demonstrations.regions import Regions, regions_of_interest
from drake_screw.demonstrations.smoothing import smoothed
from drake_screw.screws import (
    inverse,
    quaternion_from_rotation,
    rotation_angle,
    translation_distance,
)
from drake_screw.typing import Array

SCATTER = 0.1
"""Of a tolerance: a recording of which half of the samples are farther off a smooth motion
scatters. Those of people on a Baxter are at 0.04 to 0.05; with 3 mrad of noise, at 0.2 to 0.4."""

_RESERVE = 0.98  # of the tolerances, so that a check by sampled screws finds them kept
_KEPT = 0.999  # of the tolerances, where sampled screws are what samples are held against
_NEARBY = 10  # samples from one cut to another
_COARSER = 2.0  # times the spacing of candidates, where guiding poses are moved afterwards


@dataclass(frozen=True)
class FaithfulConfig:
    """Tolerances of faithful segmentation.

    Attributes:
        spacing: m, and
        turn_spacing: rad; a path may be cut only at poses that differ by one of these.
        position_tolerance: m, largest distance of a sample from the screws.
        rotation_tolerance: rad, largest angle of a sample from them, at the same place of the
            screw.
        region_of_interest: times the smallest distance of end effector and object is near the
            object.
        reach: m; an object that the end effector does not come within is a bystander.

    Raises:
        ValueError: thinning would lose poses that are beyond the tolerances, or a tolerance is out
            of its range.
    """

    spacing: float = 0.004
    turn_spacing: float = 0.03
    position_tolerance: float = 0.010
    rotation_tolerance: float = 0.1
    region_of_interest: float = 1.5
    reach: float = 0.35

    def __post_init__(self) -> None:
        closest = _RESERVE * (1.0 - SCATTER)
        if not 0.0 < 2.0 * self.spacing <= closest * self.position_tolerance:
            raise ValueError("spacing must be positive and below 0.44 of position_tolerance")
        if not 0.0 < 2.0 * self.turn_spacing <= closest * self.rotation_tolerance:
            raise ValueError("turn_spacing must be positive and below 0.44 of rotation_tolerance")
        if self.rotation_tolerance > 1.0:
            raise ValueError("rotation_tolerance must be at most 1 rad")
        if self.region_of_interest < 1.0:
            raise ValueError("region_of_interest must be at least 1")

    def regions(self, X_WE: Array, X_WO: Array, named: Sequence[int] | None = None) -> Regions:
        """The visits of a path X_WE (m, 4, 4) to objects at X_WO (k, 4, 4); `named` if known."""
        return regions_of_interest(
            X_WE,
            X_WO,
            factor=self.region_of_interest,
            reach=self.reach,
            slack=self.position_tolerance,
            named=named,
        )


def faithful_segments(X_WE: Array, config: FaithfulConfig) -> NDArray[np.int64]:
    """Indices of the poses of a path (m, 4, 4) between which constant screws lead.

    As few as there can be, if the path is cut at thinned poses only, so that each of the m poses is
    within both tolerances of the screws at one and the same parameter, in the order shown (see
    `screw_fit`). The first and the last pose are among them, unless the end effector stands still:
    then the first is the only one. Turning the path of poses back to front gives as many.

    A turn in place of 1.5 rad between two straight lines, and half a minute of standing still:

    >>> from drake_screw.screws import pose_from_planar
    >>> shown = np.zeros((3201, 3))
    >>> shown[:101, 0], shown[101:, 0] = np.linspace(0, 0.1, 101), 0.1
    >>> shown[101:151, 2], shown[151:, 2] = np.linspace(0, 1.5, 50), 1.5
    >>> shown[3151:, 1] = np.linspace(0, 0.05, 50)
    >>> cuts = faithful_segments(pose_from_planar(shown), FaithfulConfig())
    >>> len(cuts), bool(98 < cuts[1] < 104)
    (4, True)
    """
    candidates = _where_to_cut(X_WE, config)
    if len(candidates) == 1:
        return candidates
    return fewest_screws(
        X_WE,
        candidates,
        _RESERVE * config.position_tolerance,
        _RESERVE * config.rotation_tolerance,
    )


def scatters(X_WE: Array, X_smoothed: Array, config: FaithfulConfig) -> bool:
    """Whether half of the samples are off the smoothed path by `SCATTER` of a tolerance."""
    place = translation_distance(X_WE, X_smoothed) / config.position_tolerance
    turn = rotation_angle(X_WE, X_smoothed) / config.rotation_tolerance
    return bool(np.median(np.maximum(place, turn)) > SCATTER)


def _scattered_guides(
    X_WE: Array, X_smoothed: Array, config: FaithfulConfig
) -> tuple[Array, NDArray[np.int64]]:
    """Guiding poses (g, 4, 4) of samples X_WE that scatter, and the indices (g,) of the cuts.

    See `faithful_guiding_poses`.
    """
    tolerances = config.position_tolerance, config.rotation_tolerance
    candidates = _where_to_cut(X_smoothed, config, _COARSER)
    if len(candidates) == 1:
        candidates = _where_to_cut(X_smoothed, config)
    if len(candidates) == 1:
        return X_smoothed[candidates], candidates
    cuts = _smooth_segments(X_smoothed, candidates, config, _RESERVE)
    fewest = adjusted(X_smoothed[cuts], cuts, X_WE, *tolerances)
    if fewest.share <= _KEPT:
        return fewest.X_WE, cuts
    more = _smooth_segments(X_smoothed, candidates, config, _RESERVE * (1.0 - SCATTER))
    if len(more) == len(cuts):
        more = _cut_once_more(cuts, fewest.farthest)
    nearer = adjusted(X_smoothed[more], more, X_WE, *tolerances)
    return (nearer.X_WE, more) if nearer.share <= _KEPT else (fewest.X_WE, cuts)


def _smooth_segments(
    X_WE: Array, candidates: NDArray[np.int64], config: FaithfulConfig, share: float
) -> NDArray[np.int64]:
    """As `faithful_segments`, within a share of the tolerances; at other poses if it takes them."""
    tolerances = share * config.position_tolerance, share * config.rotation_tolerance
    cuts = fewest_screws(X_WE, candidates, *tolerances)
    return cuts if len(cuts) else fewest_screws(X_WE, _where_to_cut(X_WE, config), *tolerances)


def _cut_once_more(cuts: NDArray[np.int64], index: int) -> NDArray[np.int64]:
    """Cuts with one at an index more or, if there is one nearby, amid the screw that it is in."""
    if np.abs(cuts - index).min() < _NEARBY:
        after = int(np.clip(np.searchsorted(cuts, index, side="right"), 1, len(cuts) - 1))
        index = (cuts[after - 1] + cuts[after]) // 2
    return np.union1d(cuts, [index])


def _where_to_cut(X_WE: Array, config: FaithfulConfig, times: float = 1.0) -> NDArray[np.int64]:
    """Poses thinned from both ends, so that a path and its reverse may be cut at the same ones."""
    spacing = times * config.spacing, times * config.turn_spacing
    forward = thin(X_WE, *spacing)
    backward = len(X_WE) - 1 - thin(X_WE[::-1], *spacing)
    return forward if len(forward) == 1 else np.union1d(forward, backward)


def faithful_guiding_poses(
    X_WE: Array,
    X_WO: Array,
    config: FaithfulConfig,
    *,
    t: Array | None = None,
    named: Sequence[int] | None = None,
    regions: Regions | None = None,
) -> tuple[Array, NDArray[np.int64], NDArray[np.int64]]:
    """Guiding poses of a recorded end-effector path, each in the frame of the object it belongs to.

    Each visit to an object of the task (see `regions_of_interest`) has guiding poses of its own,
    from its first sample to its last. They are recorded poses, and the promise of
    `faithful_segments` is for the samples as recorded.

    A recording whose samples scatter about a smooth motion, by coarse rounding or noise, would get
    a screw more for every sample that is thrown far off. If times are given, it does not, where
    half of the samples of a visit are off by `SCATTER` of a tolerance (1 mm by default): it has as
    many screws as the smoothed motion needs, and its guiding poses, which begin as poses of the
    latter, are moved to where these screws keep as near to the samples as recorded as they can (see
    `adjustment`). Where that is not within the tolerances, it has a screw more, or as many as hold
    the smoothed motion more closely by `SCATTER`, if these keep the samples within the tolerances.
    If not even these do, there is no such promise: samples are thrown off by more than the
    tolerances, and `fidelity` says how far they are from the screws.

    Args:
        X_WE: (m, 4, 4) end-effector poses over time.
        X_WO: (k, 4, 4) object poses.
        config: tolerances.
        t: (m,) s.
        named: indices of the objects of the task, if they are known.
        regions: of the configuration, if they are at hand; `named` is not looked at then.

    Returns:
        X_OE (g, 4, 4); the object's index (g,); the index (g,) into the path. All empty if the end
        effector comes near no object of the task.
    """
    visits = (regions or config.regions(X_WE, X_WO, named)).visits
    X_smoothed = X_WE if t is None else smoothed(X_WE, t)
    shown, cuts = [np.zeros((0, 4, 4))], [np.zeros(0, dtype=np.int64)]
    for visit in visits:
        X, Z = X_WE[visit.start : visit.stop], X_smoothed[visit.start : visit.stop]
        if scatters(X, Z, config):
            guides, found = _scattered_guides(X, Z, config)
        else:
            found = faithful_segments(X, config)
            guides = X[found]
        cuts.append(visit.start + found)
        shown.append(guides)
    owner = np.repeat(
        np.array([v.object for v in visits], dtype=np.int64), [len(c) for c in cuts[1:]]
    )
    return inverse(X_WO[owner]) @ np.concatenate(shown), owner, np.concatenate(cuts)


def thin(X_WE: Array, spacing: float, turn_spacing: float) -> NDArray[np.int64]:
    """Indices of poses of a path that differ from the one kept before, by place or by turn.

    Args:
        X_WE: (m, 4, 4).
        spacing: m.
        turn_spacing: rad; whichever of the two is reached first. Infinite for place alone.

    Returns:
        (c,) the first pose, each that differs, and the last pose; the first alone if none differs.
    """
    q = quaternion_from_rotation(X_WE[:, :3, :3])
    kept = _thin(np.ascontiguousarray(X_WE[:, :3, 3]), q, spacing, turn_spacing)
    if len(kept) > 1 and kept[-1] != len(X_WE) - 1:
        kept = np.append(kept, len(X_WE) - 1)
    return kept


@cached_njit()
def _thin(p: Array, q: Array, spacing: float, turn_spacing: float) -> NDArray[np.int64]:
    least = np.cos(0.5 * turn_spacing) if turn_spacing < np.pi else -1.0
    kept = [0]
    for i in range(1, len(p)):
        k, square, cosine = kept[-1], 0.0, 0.0
        for c in range(3):
            square += (p[i, c] - p[k, c]) ** 2
        for c in range(4):
            cosine += q[i, c] * q[k, c]
        if square >= spacing**2 or abs(cosine) <= least:
            kept.append(i)
    return np.array(kept)
