"""One request for a demonstration on the teaching page, from the suggestion to the recording."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.acquisition import Suggestion
from drake_screw.acquisition.guided_arm import GuidedArm
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import FaithfulConfig, Recording
from drake_screw.demonstrations.recording import checked
from drake_screw.errors import DrakeScrewError
from drake_screw.planning import Cause
from drake_screw.runs.narration import place
from drake_screw.screws import exp, log, pose
from drake_screw.screws.endless import drawn_range
from drake_screw.typing import Array
from drake_screw.visualization.attempt import (
    Attempt,
    attempt,
    collided,
    describe_segment,
    headline,
)
from drake_screw.visualization.inspector import Inspector
from drake_screw.visualization.palette import STATUS_COLORS

PERIOD = 0.02
"""s. Between steps of the arm, and between samples of a recording."""
REACH = 0.6
"""m. How far the sliders of the end effector's position go to both sides of where it starts."""
POSE_SLIDERS = (
    ("x", "m"),
    ("y", "m"),
    ("z", "m"),
    ("tilt about its x", "rad"),
    ("tilt about its y", "rad"),
    ("roll about its z", "rad"),
)


class TeachingSession:
    """One request, from the suggestion to the accepted recording.

    Args:
        setup: of the run.
        inspector: draws what a recording would do.
        suggestion: where the demonstration is wanted.
        number: of the demonstration, from 0.

    Attributes:
        guided: the arm, as the person leads it: of several the one nearest to the object.
        start: (n,) rad or m, where it starts.
        over: whether the person has decided.
        accepted: the recording they accepted, if they did.
    """

    def __init__(
        self, setup: Setup, inspector: Inspector, suggestion: Suggestion, number: int
    ) -> None:
        self._setup, self._inspector, self._number = setup, inspector, number
        self._suggestion = suggestion
        self._X_WO = setup.area.X_WO(suggestion.coordinates)
        one = setup.nearest_arm(suggestion.coordinates)
        self._arm, self.start = one.arm, one.start
        self._X_WE_start = one.arm.pose(one.start)
        self.over = False
        self.accepted: Recording | None = None
        self._message = ""
        self._sliders: Array
        self._q_wanted: Array | None
        self._samples: list[Array] | None
        self._offered: Recording | None
        self._segments: list[dict[str, Any]]
        self._restart()

    @property
    def leading(self) -> bool:
        """Whether the arm follows the sliders."""
        return self._offered is None

    @property
    def recording(self) -> bool:
        """Whether the arm's motion is being recorded."""
        return self._samples is not None

    def handle(self, message: dict[str, Any]) -> None:
        """A message of the panel; one that means nothing changes nothing.

        Messages: ``{"do": "record"}`` (stop, accept, repeat, skip), ``{"pose": i, "value": v}``
        (a slider of the end effector's pose), ``{"joint": j, "value": v}``; m or rad.
        """
        match message:
            case {"do": str(action)} if action in self._actions():
                getattr(self, f"_{action}")()
            case {"pose": int(i), "value": int() | float() as value} if self.leading:
                if 0 <= i < len(POSE_SLIDERS) and isfinite(value):
                    low, high = self._slider_range
                    self._sliders[i] = np.clip(value, low[i], high[i])
                    self._q_wanted = None
            case {"joint": int(joint), "value": int() | float() as value} if self.leading:
                if 0 <= joint < self.guided.arm.n and isfinite(value):
                    wanted = self.guided.q.copy() if self._q_wanted is None else self._q_wanted
                    wanted[joint] = value
                    self._q_wanted = wanted

    def step(self) -> bool:
        """One period of the arm's motion; returns whether it moved."""
        if not self.leading:
            return False
        if self._q_wanted is not None:
            moved = self.guided.guide_joints(self._q_wanted)
            self._sliders = self._slider_values(self.guided.arm.pose(self.guided.q))
        else:
            moved = self.guided.guide_end_effector(self._pose(self._sliders))
        if self._samples is not None:
            self._samples.append(self.guided.q.copy())
        return moved

    def offer_folder(self, folder: Path) -> str:
        """Offer a recording from a folder; returns what became of it, in words."""
        try:
            self._offer(self._setup.own_recorder.read(folder))
        except DrakeScrewError as error:
            self._message = str(error)
        else:
            self._message = f"{folder.name}: {self._message}"
        return self._message

    def state(self) -> dict[str, Any]:
        """What the panel shows."""
        arm, q = self.guided.arm, self.guided.q
        margin = arm.margin(q)
        least, greatest = drawn_range(arm.lower, arm.upper, self.start[None])
        low, high = self._slider_range
        stuck = "the arm cannot follow: a joint is at its limit, or it is stretched out"
        asked = place(self._suggestion, self._suggestion.regions or self._setup.regions)
        seconds = len(self._samples or ()) * PERIOD
        return {
            "title": f"{self._setup.scenario.name}: teach",
            "headline": f"demonstration {self._number + 1} is wanted at {asked}",
            "message": self._message or (stuck if self.guided.stuck else ""),
            "clock": f"recording, {seconds:.1f} s" if self.recording else "",
            "hint": _hint(self._setup),
            "can": self._actions(),
            "leading": self.leading,
            "pose": [
                {"name": n, "low": a, "high": b, "value": round(float(v), 5), "unit": u}
                for (n, u), a, b, v in zip(POSE_SLIDERS, low, high, self._sliders, strict=True)
            ],
            "joints": [
                {
                    "name": name,
                    "low": float(least[j]),
                    "high": float(greatest[j]),
                    "value": float(q[j]),
                    "margin": float(margin[j]) if isfinite(margin[j]) else None,
                    "unit": arm.units[j],
                }
                for j, name in enumerate(arm.joint_names)
            ],
            "segments": self._segments,
        }

    def _actions(self) -> Sequence[str]:
        """The buttons that can be pressed; each has a method."""
        if not self.leading:
            return ["accept", "repeat"]
        return ["stop"] if self.recording else ["record", "skip"]

    def _restart(self) -> None:
        self.guided = GuidedArm(self._arm, self.start, PERIOD)
        self._sliders = self._slider_values(self._X_WE_start)
        self._q_wanted = self._samples = self._offered = None
        self._segments = []
        self._inspector.clear()
        self._inspector.show_instance(self._X_WO)

    @property
    def _slider_range(self) -> tuple[Array, Array]:
        """(6,), (6,) m and rad, the ends of the sliders of the pose."""
        middle = self._slider_values(self._X_WE_start)
        half = np.array([REACH] * 3 + [np.pi] * 3)
        return middle - half, middle + half

    def _slider_values(self, X_WE: Array) -> Array:
        """(6,) p_WE in m, and the rotation vector in rad from the start's E, in that frame."""
        turned = pose(self._X_WE_start[:3, :3].T @ X_WE[:3, :3], np.zeros(3))
        return np.concatenate([X_WE[:3, 3], log(turned)[:3]])

    def _pose(self, values: Array) -> Array:
        """X_WE (4, 4) that the sliders stand for; the inverse of `_slider_values`."""
        turned = exp(np.concatenate([values[3:], np.zeros(3)]))[:3, :3]
        return pose(self._X_WE_start[:3, :3] @ turned, values[:3])

    def _record(self) -> None:
        self._message, self._samples = "", [self.guided.q.copy()]

    def _stop(self) -> None:
        q = np.array(self._samples)
        self._samples = None
        arm = self.guided.arm
        recording = Recording(
            f"demo_{self._number + 1:02d}",
            arm.joint_names,
            PERIOD * np.arange(len(q)),
            q,
            self._X_WO,
        )
        try:
            self._offer(checked(recording, arm.lower, arm.upper, units=arm.units))
        except DrakeScrewError as error:
            self._message = str(error)

    def _offer(self, recording: Recording) -> None:
        """Cut a recording into screws and plan the suggested instance with it."""
        demonstration = self._setup.learn(recording)
        setup, X_WO = self._setup, self._X_WO
        found = setup.planner.all_outcomes([demonstration], X_WO[None], setup.start)[0, 0]
        plan, one = setup.judged_plan(demonstration, X_WO, found), setup.arm_of(found)
        tried = attempt(one.arm, self._number, demonstration, X_WO, plan, setup.arm_name(found))
        if found.cause == Cause.COLLISION:
            tried = collided(tried, found, one.workcell, setup.scenario.planner.clearance)
        self._inspector.draw(tried)
        self._segments = _segment_lines(tried)
        self._message = (
            f"{len(tried.guides)} guiding pose{'' if len(tried.guides) == 1 else 's'} found; "
            f"planned at the suggested place it {headline(tried)}"
        )
        self._offered = recording

    def _accept(self) -> None:
        self.accepted, self.over = self._offered, True

    def _repeat(self) -> None:
        self._message = ""
        self._restart()

    def _skip(self) -> None:
        self.over = True


def _segment_lines(tried: Attempt) -> list[dict[str, Any]]:
    return [
        {"color": STATUS_COLORS[status], "words": describe_segment(tried, i)}
        for i, status in enumerate(tried.status)
    ]


def _hint(setup: Setup) -> str:
    """What to mind while leading the arm, if anything."""
    config = setup.learning.segmentation
    if isinstance(config, FaithfulConfig):
        return ""
    return (
        f"Move the end effector by more than {1e3 * config.spacing:.0f} mm while it turns: a turn "
        "on the spot leaves no trace in a recording."
    )
