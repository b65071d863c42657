"""What people do with an arm at a bowl, or a cup and a bowl, as key poses of its end effector.

The numbers follow 32 kinesthetic demonstrations on a Baxter, 16 of each motion, spread evenly over
a work area of 0.37 m by 1.02 m: where the end effector is, how it is turned and how much that
varies at the guiding poses found in them, rounded; and estimates for what guiding poses do not show
(the arc of the roll, how long people stop). Of `fetching` and pouring there are no recordings: what
it does at the cup is estimated, what it does at the bowl is as in pouring.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from drake_screw.screws import pose
from drake_screw.typing import Array

DEGREE = np.pi / 180.0


@dataclass(frozen=True)
class Variation:
    """How a quantity varies from one demonstration to the next: normal, within bounds."""

    mean: float
    deviation: float
    lower: float = -np.inf
    upper: float = np.inf

    def draw(self, rng: np.random.Generator, count: int) -> Array:
        """(count,) values."""
        return np.clip(rng.normal(self.mean, self.deviation, count), self.lower, self.upper)


@dataclass(frozen=True)
class HandPath:
    """Key poses of the end effector, each relative to an object and the direction of approach.

    Arrays are (c, g), for c candidates and g key poses, or broadcast to it.

    Attributes:
        behind: m, from the end effector forward to the object's axis, along the approach.
        left: m, of the object's axis, seen along the approach.
        height: m, above the object's origin.
        pitch: rad, of the end effector's z axis below the horizon.
        roll: rad, about the end effector's z axis, from how it is held at the start.
        pause: (g,) s, the shortest and the longest time that people stop at each key pose.
        held: (c,) m, by how much the tool is held longer than usual.
        at: (g,) which object each key pose belongs to; all to the first where left out.
    """

    behind: Array
    left: Array
    height: Array
    pitch: Array
    roll: Array
    pause: tuple[tuple[float, float], ...]
    held: Array
    at: tuple[int, ...] = ()

    @property
    def objects(self) -> tuple[int, ...]:
        """Those that key poses belong to, by number."""
        return tuple(sorted(set(self.at))) or (0,)


def pouring(rng: np.random.Generator, held: Array) -> HandPath:
    """Key poses of pouring, the tool held (c,) m longer than usual.

    Come in level and beside the bowl, roll about the spout, hold, roll back, withdraw.
    """
    draw = _drawer(rng, len(held))
    turn = rng.choice([-1.0, 1.0], len(held))
    behind, beside, height = (
        draw(0.104, 0.015, 0.07, 0.15) + held,
        draw(0.082, 0.013, 0.05, 0.11),
        draw(0.137, 0.014, 0.11, 0.18),
    )
    tilt = draw(95, 10, 65, 108) * DEGREE
    level = draw(3, 5, -8, 12) * DEGREE
    pitch = draw(9, 4, 1, 19) * DEGREE
    arc = draw(0.045, 0.008, 0.03, 0.065)
    away, aside, up = draw(0.040, 0.02, 0, 0.09), draw(0.03, 0.02, 0, 0.08), draw(0.02, 0.01, 0)
    nearer, lower = draw(0.010, 0.008), draw(0.004, 0.008)
    leave, rise = draw(0.04, 0.02, 0.01, 0.09), draw(0.035, 0.015, 0.01, 0.07)
    back = draw(8, 8, -5, 20) * DEGREE
    return HandPath(
        behind=_rows(behind + away, behind + nearer, behind, behind + nearer / 2, behind + leave),
        left=turn[:, None]
        * _rows(beside + arc + aside, beside + arc, beside, beside + arc, beside + arc),
        height=_rows(height + up, height, height - lower, height, height + rise),
        pitch=_rows(pitch, pitch, pitch, pitch, pitch),
        roll=turn[:, None] * _rows(level, level, tilt, back, back),
        pause=((0.1, 0.6), (0.3, 1.2), (1.0, 3.0), (0.2, 0.8), (0.2, 0.5)),
        held=held,
    )


def scooping(rng: np.random.Generator, held: Array) -> HandPath:
    """Key poses of scooping, the tool held (c,) m longer than usual.

    Come in with the tool turned on its edge, dip, turn it level while moving on, and lift.
    """
    draw = _drawer(rng, len(held))
    turn = rng.choice([-1.0, 1.0], len(held))
    behind, left, height = (
        draw(0.205, 0.015, 0.17, 0.24) + held,
        draw(0.0, 0.012),
        draw(0.106, 0.014, 0.08, 0.14),
    )
    edge = draw(66, 8, 50, 82) * DEGREE
    entering = edge * draw(0.85, 0.1, 0.6, 1.0)
    final = draw(0, 8, -16, 16) * DEGREE
    pitch = draw(17, 5, 4, 28) * DEGREE
    away, down = draw(0.030, 0.015, 0, 0.07), draw(0.035, 0.005, 0.025, 0.05)
    stroke, sweep = draw(0.028, 0.008, 0.015, 0.045), draw(0.015, 0.008)
    leave, rise = draw(0.020, 0.015, -0.01, 0.06), draw(0.050, 0.008, 0.04, 0.07)
    level = pitch * draw(0.75, 0.15, 0.4, 1.0)
    return HandPath(
        behind=_rows(behind + away + stroke, behind + stroke, behind, behind + leave),
        left=turn[:, None] * _rows(left + sweep, left + sweep, left - sweep, left - sweep),
        height=_rows(height + down, height, height + 0.005, height + rise),
        pitch=_rows(pitch, pitch, pitch, level),
        roll=turn[:, None] * _rows(entering, edge, final, final),
        pause=((0.1, 0.8), (0.3, 1.0), (0.3, 1.0), (0.3, 0.6)),
        held=held,
    )


CUP = 0.085
"""m, from the end effector forward to the axis of a cup between its fingers, and how high above the
cup's bottom that is held: what a scenario has to say of `robot.tool`."""
GRIP = 0.075


def fetching(rng: np.random.Generator, held: Array) -> HandPath:
    """Key poses of fetching the first object, a cup, and pouring from it into the second, a bowl.

    Come in level from behind, close in on the cup, lift it straight up; then as in pouring. The cup
    is where the fingers are, so it is never held longer than usual.
    """
    draw = _drawer(rng, len(held))
    poured = pouring(rng, np.zeros_like(held))
    behind, high = draw(CUP, 0.001, CUP - 0.002, CUP + 0.002), draw(GRIP, 0.001, 0.072, 0.078)
    away, lift, none = draw(0.09, 0.015, 0.06, 0.13), draw(0.06, 0.006, 0.045, 0.075), 0.0 * held

    def joined(cup: tuple[Array, ...], bowl: Array) -> Array:
        return np.concatenate([_rows(*cup), np.broadcast_to(bowl, (len(held), 5))], axis=-1)

    return HandPath(
        behind=joined((behind + away, behind, behind), poured.behind),
        left=joined((none, none, none), poured.left),
        height=joined((high, high, high + lift), poured.height),
        pitch=joined((none, none, none), poured.pitch),
        roll=joined((none, none, none), poured.roll),
        pause=((0.1, 0.6), (0.8, 1.6), (0.1, 0.5), *poured.pause),
        held=none,
        at=(0, 0, 0, 1, 1, 1, 1, 1),
    )


Motion = Callable[[np.random.Generator, Array], HandPath]
"""(rng, held (c,) m) to c candidates of a motion, as `pouring` has them."""

MOTIONS: Mapping[str, Motion] = {
    "pouring": pouring,
    "scooping": scooping,
    "fetching": fetching,
}


def tool_lengths(rng: np.random.Generator, count: int, *, stretched: bool) -> Array:
    """By how much people hold the tool longer than usual; (count,) m.

    At most places by little. Where they cannot reach otherwise (`stretched`), by up to 0.14 m, as
    in the far corners of the recordings, where bowl and end effector are up to 0.28 m apart.
    """
    if stretched:
        return rng.uniform(0.05, 0.14, count)
    return np.minimum(rng.exponential(0.03, count), 0.12)


def usual_azimuth(X_WE: Array, p_WO: Array) -> float:
    """The direction from which people bring the end effector to an object, of its z axis about W's.

    They push it on the straight way from where it rests to the object, turned by an eighth of the
    way towards where it points at rest: 5 degrees on average over the recordings.

    Args:
        X_WE: (4, 4) the end effector at rest.
        p_WO: (3,) m.

    Returns:
        Azimuth in rad.
    """
    to_object = p_WO - X_WE[:3, 3]
    bearing = np.arctan2(to_object[1], to_object[0])
    heading = np.arctan2(X_WE[1, 2], X_WE[0, 2])
    return float(bearing + 0.12 * np.angle(np.exp(1j * (heading - bearing))))


def azimuth_deviations(rng: np.random.Generator, count: int) -> Array:
    """How far from the usual azimuth people come; (count,) rad.

    The standard deviation is 6 degrees in the recordings of scooping and 10 in those of pouring. A
    quarter is spread over 60 degrees to both sides, for places where the usual way does not work.
    """
    usual = Variation(0.0, 9 * DEGREE, -25 * DEGREE, 25 * DEGREE).draw(rng, count)
    unusual = rng.uniform(-60 * DEGREE, 60 * DEGREE, count)
    return np.where(rng.random(count) < 0.75, usual, unusual)


def hand_poses(path: HandPath, azimuth: Array, X_WE: Array, p_WO: Array) -> Array:
    """Key poses in the world.

    Args:
        path: c candidates of g key poses.
        azimuth: (c,) rad, direction of approach, or (c, k) of that to each object.
        X_WE: (4, 4) the end effector at rest, from which rolls are counted.
        p_WO: (3,) m, the object, or (k, 3) of each.

    Returns:
        X_WE: (c, g, 4, 4).
    """
    azimuth, p_WO = np.asarray(azimuth), np.asarray(p_WO)
    if azimuth.ndim == 1:
        azimuth, p_WO = azimuth[:, None], p_WO[None]
    at = list(path.at) or [0] * path.behind.shape[-1]
    azimuth, p_WO = azimuth[:, at], p_WO[at]
    c, s, zero = np.cos(azimuth), np.sin(azimuth), np.zeros_like(azimuth)
    forward = np.stack([c, s, zero], axis=-1)
    leftward = np.stack([-s, c, zero], axis=-1)
    up = np.array([0.0, 0.0, 1.0])
    p = p_WO + path.left[..., None] * leftward - path.behind[..., None] * forward
    R = _frame(azimuth, path.pitch, path.roll + _roll(X_WE[:3, :3]))
    return pose(R, p + path.height[..., None] * up)


def _frame(azimuth: Array, pitch: Array, roll: Array) -> Array:
    """Rotation with its z axis along azimuth and pitch, its x axis turned about it from up."""
    azimuth, pitch, roll = np.broadcast_arrays(azimuth, pitch, roll)
    level = np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros_like(azimuth)], axis=-1)
    right = np.stack([np.sin(azimuth), -np.cos(azimuth), np.zeros_like(azimuth)], axis=-1)
    up = np.array([0.0, 0.0, 1.0])
    cos, sin = np.cos(pitch)[..., None], np.sin(pitch)[..., None]
    z, over = cos * level - sin * up, sin * level + cos * up
    x = np.cos(roll)[..., None] * over + np.sin(roll)[..., None] * right
    return np.stack([x, np.cross(z, x), z], axis=-1)


def _roll(R: Array) -> float:
    """The roll of `_frame` that a rotation has; 0 where its z axis is upright."""
    z, up = R[:, 2], np.array([0.0, 0.0, 1.0])
    right = np.cross(z, up)
    return float(np.arctan2(R[:, 0] @ right, R[:, 0] @ (up - z * z[2])))


def _drawer(rng: np.random.Generator, count: int) -> Callable[..., Array]:
    return lambda *variation: Variation(*variation).draw(rng, count)


def _rows(*columns: Array) -> Array:
    return np.stack(columns, axis=-1)
