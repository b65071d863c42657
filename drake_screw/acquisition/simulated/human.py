"""How people move over time: smooth reaches, stops, and the drift and tremor of a hand."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from pydrake.trajectories import PiecewisePolynomial

from drake_screw.acquisition.simulated.band_pass import filtered, second_order_sections
from drake_screw.acquisition.simulated.candidate_paths import damped_joint_motion
from drake_screw.robot import ScrewChain
from drake_screw.screws import rotation_angle, shift, translation_distance
from drake_screw.typing import Array

RATE = 100.0  # Hz
SHORTEST, LONGEST = 8.6, 20.0  # s
REACH_SPEED, TURN_SPEED = 0.22, 0.8  # m/s and rad/s, mean of a reach
PEAK = 1.875  # times its mean is the peak speed of a minimum-jerk reach
SPEED_FRACTION = 0.65  # of the joints' velocity limits is the most that people ask for


@dataclass(frozen=True)
class HandNoise:
    """Band-limited noise of a hand, which people do not mean to make.

    Attributes:
        band: Hz.
        position: m, root mean square of each coordinate.
        rotation: rad, likewise.
    """

    band: tuple[float, float]
    position: float
    rotation: float


# In the recordings the end effector moves by 0.6 mm (mean norm) in the band of 2 to 10 Hz.
DRIFT = HandNoise((0.05, 0.5), 0.0025, 0.010)
TREMOR = HandNoise((2.0, 10.0), 0.00035, 0.0015)


def minimum_jerk(s: Array) -> Array:
    """The smoothest reach from 0 to 1 (Flash and Hogan, J. Neuroscience, 1985); s in [0, 1]."""
    return s**3 * (10.0 - 15.0 * s + 6.0 * s * s)


def timed(
    q: Array,
    segment: Array,
    X_WE: Array,
    pauses: tuple[tuple[float, float], ...],
    speed_limits: Array,
    rng: np.random.Generator,
) -> Array:
    """A joint path given its timing, sampled at 100 Hz.

    Every segment is a reach of its own, after which the hand stops for a while. Now and then
    people stop on the way of the first, too.

    Args:
        q: (m, n) rad or m.
        segment: (m,) as in `candidate_paths.CandidatePaths`.
        X_WE: (m, 4, 4) the end effector along the path.
        pauses: shortest and longest stop after each segment, s.
        speed_limits: (n,) rad/s or m/s.
        rng: for tempo, stops, and the length of pauses.

    Returns:
        q: (k, n), k / 100 s long.
    """
    ends = [0, *(int(np.flatnonzero(segment == i)[-1]) for i in range(len(pauses)))]
    stops = [rng.uniform(*pause) for pause in pauses]
    if rng.random() < 0.4:
        ends.insert(1, int(rng.uniform(0.4, 0.8) * ends[1]))
        stops.insert(0, rng.uniform(0.0, 0.5))
    reaches, least = [], []
    for first, last in pairwise(ends):
        X, steps = X_WE[first : last + 1], np.abs(np.diff(q[first : last + 1], axis=0))
        way, turn = translation_distance(X[1:], X[:-1]).sum(), rotation_angle(X[1:], X[:-1]).sum()
        reaches.append(rng.uniform(0.85, 1.2) * max(way / REACH_SPEED, turn / TURN_SPEED, 0.4))
        least.append(PEAK * len(steps) * float((steps / (SPEED_FRACTION * speed_limits)).max()))
    unhurried = sum(reaches) + sum(stops)
    total = np.clip(rng.uniform(0.85, 1.35) * unhurried, rng.uniform(1.0, 1.2) * SHORTEST, LONGEST)
    tempo = total / unhurried
    places = [np.zeros(1)]
    for i, stop in enumerate(stops):
        count = int(np.ceil(RATE * max(tempo * reaches[i], least[i])))
        part = minimum_jerk(np.arange(1, count + 1) / count)
        places.append(ends[i] + (ends[i + 1] - ends[i]) * part)
        places.append(np.full(round(RATE * tempo * stop), float(ends[i + 1])))
    path = PiecewisePolynomial.CubicShapePreserving(np.arange(float(len(q))), q.T)
    return np.array(path.vector_values(np.concatenate(places)).T)


def with_hand_noise(chain: ScrewChain, q: Array, rng: np.random.Generator) -> Array:
    """A joint path with the drift and tremor of the hand that leads it; its first point stays.

    Args:
        chain: the arm.
        q: (m, n) rad or m, at 100 Hz.
        rng: for drift and tremor.

    Returns:
        (m, n).
    """
    V_WE = np.zeros((len(q), 6))
    for part in (DRIFT, TREMOR):
        sections = second_order_sections(part.band, RATE)
        noise = filtered(sections, rng.standard_normal((len(q), 6)))
        noise /= noise.std(axis=0)
        V_WE += noise * np.repeat([part.rotation, part.position], 3)
    V_WE *= minimum_jerk(np.clip(np.arange(len(q)) / RATE, 0.0, 1.0))[:, None]
    X_WE, J = chain.pose_and_jacobian(q)
    return q + damped_joint_motion(J, shift(V_WE, -X_WE[:, :3, 3]))
