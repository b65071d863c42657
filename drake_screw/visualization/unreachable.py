"""Why the end effector gets no farther along a screw, in numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drake_screw.planning import Plan
from drake_screw.planning.contract import RATE_LIMIT, motion_size
from drake_screw.planning.roll import along_roll_free, free_frame, turned_apart
from drake_screw.robot import Arm
from drake_screw.robot.wrist import Wrist
from drake_screw.screws import inverse, log, shift, translation_distance
from drake_screw.typing import Array

END_OF_REACH = 1.0 / RATE_LIMIT
"""End-effector motion for a unit of joint motion at which a pose is called unreachable."""

STRETCHED = 0.99
"""Of the arm's reach, from which on it is called stretched out."""

SLACK = 1e-3
"""m, by which a guiding pose must ask for more than the arm's reach to be called out of reach."""


@dataclass(frozen=True, eq=False)
class Unreachable:
    """A plan that ended as unreachable, looked at.

    Where the roll about an axis is free, turns about it are left out of all of these.

    Attributes:
        singular: (m,) least singular value of J_WE along the plan, rad and m of the end effector's
            own origin for a unit of joint motion.
        gain: (m,) the same in the direction of the screw, |V| / |J^+ V| in the planner's measure
            of motion; NaN along a free approach, which follows no screw.
        missing: part of the screw's motion that the joints do not have where the plan ended, 0 to
            1; NaN if that was in a free approach.
        travel, turn: m and rad from where the plan ended to the guiding pose of its segment.
        wrist: shoulder, wrist and reach; None of an arm that has no such points.
        distance: (m,) m from shoulder to wrist along the plan; empty without `wrist`.
        needed: m from shoulder to wrist at the guiding pose, at the least if the roll is free; NaN
            without `wrist`.
        p_WC: (2, 3) m, the wrist where the plan ended, and at the guiding pose as recorded; NaN
            without `wrist`.
    """

    singular: Array
    gain: Array
    missing: float
    travel: float
    turn: float
    wrist: Wrist | None
    distance: Array
    needed: float
    p_WC: Array

    @property
    def words(self) -> str:
        """What is missing, and what the arm lacks, in one sentence."""
        return f"{self._missing}: {self._why}"

    @property
    def out_of_reach(self) -> bool:
        """Whether the guiding pose asks for a wrist farther or nearer than the arm can bring it."""
        if self.wrist is None:
            return False
        return not self.wrist.least - SLACK <= self.needed <= self.wrist.most + SLACK

    @property
    def stretched(self) -> bool:
        """Whether the arm was stretched out where the plan ended."""
        return self.wrist is not None and bool(self.distance[-1] > STRETCHED * self.wrist.most)

    @property
    def _missing(self) -> str:
        return (
            f"{_rounded(100.0 * self.travel)} cm and {_rounded(np.degrees(self.turn))}° are missing"
        )

    @property
    def _why(self) -> str:
        if self.wrist is not None:
            most, least = self.wrist.most, self.wrist.least
            if self.out_of_reach and self.needed > most:
                return (
                    f"the guiding pose needs the wrist {self.needed:.3f} m from the shoulder, and "
                    f"the arm reaches {most:.3f} m"
                )
            if self.out_of_reach:
                return (
                    f"the guiding pose needs the wrist {self.needed:.3f} m from the shoulder, and "
                    f"the arm gets no nearer than {least:.3f} m"
                )
            if self.stretched:
                return (
                    f"the arm is stretched out, its wrist {self.distance[-1]:.3f} m from the "
                    f"shoulder of at most {most:.3f} m"
                )
        if self.missing > END_OF_REACH:
            return f"the arm does not have {self.missing:.0%} of the screw's motion here"
        gain = self.singular[-1] if np.isnan(self.gain[-1]) else self.gain[-1]
        return (
            "the arm is near a singular pose, where its joints move "
            f"{1.0 / max(gain, 1e-6):.3g} times as much as the end effector"
        )


def explain(arm: Arm, plan: Plan, starts: Array) -> Unreachable:
    """Look at a plan that ended as unreachable.

    Args:
        arm: that was planned for.
        plan: what came of it.
        starts: (g, 4, 4) X_WE where each screw segment starts.
    """
    V_W = log(plan.guides @ inverse(starts))
    singular, gain, lacking = np.empty(len(plan.q)), np.full(len(plan.q), np.nan), np.nan
    X_WE = np.empty((len(plan.q), 4, 4))
    for i, (q, segment) in enumerate(zip(plan.q, plan.segment, strict=True)):
        X_WE[i], J = arm.pose_and_jacobian(q)
        P = _followed(X_WE[i], plan.free_axis)
        singular[i] = np.linalg.svd(P @ J, compute_uv=False).min()
        V = P @ shift(V_W[segment], X_WE[i, :3, 3])
        if (segment == 0 and plan.approach) or np.linalg.norm(V) < 1e-9:
            lacking = np.nan
            continue
        v = np.linalg.lstsq(P @ J, V, rcond=None)[0]
        gain[i] = motion_size(P.T @ V) / max(float(np.linalg.norm(v)), 1e-12)
        lacking = float(motion_size(P.T @ (V - P @ J @ v)) / motion_size(P.T @ V))
    G, last, wrist = plan.guides[int(plan.outcome.segment)], X_WE[-1], arm.wrist
    return Unreachable(
        singular,
        gain,
        lacking,
        float(translation_distance(last, G)),
        float(turned_apart(last, G, plan.free_axis)),
        wrist,
        np.empty(0) if wrist is None else wrist.distance(X_WE),
        np.nan if wrist is None else _needed(wrist, G, plan.free_axis),
        np.full((2, 3), np.nan) if wrist is None else wrist.centre(np.stack([last, G])),
    )


def _followed(X_WE: Array, free_axis: Array | None) -> Array:
    """(6, 6) or, without turns about the free axis, (5, 6): takes twists to what is followed."""
    return np.eye(6) if free_axis is None else along_roll_free(X_WE @ free_frame(free_axis))


def _needed(wrist: Wrist, G: Array, free_axis: Array | None) -> float:
    """Distance from shoulder to wrist at a guiding pose, the least of all rolls that are free."""
    if free_axis is None:
        return float(wrist.distance(G))
    p_ES = G[:3, :3].T @ (wrist.p_WS - G[:3, 3])
    high, out = (
        (float(p @ free_axis), float(np.linalg.norm(p - free_axis * (p @ free_axis))))
        for p in (p_ES, wrist.p_EC)
    )
    return float(np.hypot(high[0] - out[0], high[1] - out[1]))


def _rounded(value: float) -> str:
    """With two decimals below 1, else one."""
    return f"{value:.2f}" if value < 0.995 else f"{value:.1f}"
