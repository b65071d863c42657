"""One request at the desk of an interactive teacher, from the suggestion to the recording."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.acquisition import Suggestion
from drake_screw.acquisition.interactive import LedArm
from drake_screw.demonstrations import Recording, read_recording
from drake_screw.demonstrations.recording import checked
from drake_screw.errors import DrakeScrewError
from drake_screw.scenario.assemble import Setup
from drake_screw.scenario.narration import place
from drake_screw.screws import exp, log, pose
from drake_screw.typing import Array
from drake_screw.visualization.attempt import Attempt, attempt, describe_segment, headline, unit
from drake_screw.visualization.charts import STATUS_COLORS
from drake_screw.visualization.inspector import Inspector

PERIOD = 0.02
"""s. Between steps of the arm, and between samples of a recording."""
REACH = 0.6
"""m. How far the hand's sliders go to both sides of where it starts."""
HAND = ("x", "y", "z", "tilt about its x", "tilt about its y", "roll about its z")


class DeskLesson:
    """One request, from the suggestion to the accepted recording."""

    def __init__(
        self, setup: Setup, inspector: Inspector, suggestion: Suggestion, number: int
    ) -> None:
        self._setup, self._inspector, self._number = setup, inspector, number
        self._suggestion = suggestion
        self.X_WO = setup.area.X_WO(suggestion.x_y_yaw)
        self.over = False
        self.accepted: Recording | None = None
        self._message = ""
        self._X_WE = setup.workcell.arm.pose(setup.workcell.start)
        self._hand: Array = self._hand_of(self._X_WE)
        self._q_goal: Array | None = None
        self._samples: list[Array] | None = None
        self._offered: Recording | None = None
        self._segments: list[dict[str, Any]] = []
        self._restart()

    @property
    def leading(self) -> bool:
        """Whether the arm follows the sliders."""
        return self._offered is None

    @property
    def recording_now(self) -> bool:
        """Whether the arm's motion is being recorded."""
        return self._samples is not None

    def hear(self, message: dict[str, Any]) -> None:
        """A message of the panel; nonsense changes nothing."""
        match message:
            case {"do": str(action)} if action in self._can():
                getattr(self, f"_{action}")()
            case {"hand": int(axis), "value": int() | float() as value} if self.leading:
                if 0 <= axis < 6 and isfinite(value):
                    low, high = self._range
                    self._hand[axis] = np.clip(value, low[axis], high[axis])
                    self._q_goal = None
            case {"joint": int(joint), "value": int() | float() as value} if self.leading:
                if 0 <= joint < self.led.arm.n and isfinite(value):
                    goal = self.led.q.copy() if self._q_goal is None else self._q_goal
                    goal[joint] = value
                    self._q_goal = goal

    @property
    def _range(self) -> tuple[Array, Array]:
        """Ends of the hand's sliders."""
        center = self._hand_of(self._X_WE)
        half = np.array([REACH] * 3 + [np.pi] * 3)
        return center - half, center + half

    def step(self) -> bool:
        """One period of the arm's motion; returns whether it moved."""
        if not self.leading:
            return False
        if self._q_goal is not None:
            moved = self.led.lead_joints(self._q_goal)
            self._hand = self._hand_of(self.led.arm.pose(self.led.q))
        else:
            moved = self.led.lead_hand(self._pose_of(self._hand))
        if self._samples is not None:
            self._samples.append(self.led.q.copy())
        return moved

    def take(self, folder: Path) -> str:
        """Offer a recording from a folder; returns what became of it, for people."""
        arm, objects = self.led.arm, len(self._setup.objects)
        try:
            recording = read_recording(
                folder, arm.joint_names, arm.lower, arm.upper, objects=objects
            )
            self._offer(recording)
        except DrakeScrewError as error:
            self._message = str(error)
        else:
            self._message = f"{folder.name}: {self._message}"
        return self._message

    def state(self) -> dict[str, Any]:
        """What the panel shows."""
        arm, q = self.led.arm, self.led.q
        margin = arm.margin(q)
        low, high = self._range
        stuck = "the arm cannot follow: a joint is at its limit, or it is stretched out"
        asked = place(self._suggestion, self._suggestion.regions or self._setup.regions)
        spacing = 1e3 * self._setup.segmentation.spacing
        seconds = len(self._samples or ()) * PERIOD
        return {
            "title": f"{self._setup.scenario.name}: teach",
            "headline": f"demonstration {self._number + 1} is wanted at {asked}",
            "message": self._message or (stuck if self.led.stuck else ""),
            "clock": f"recording, {seconds:.1f} s" if self.recording_now else "",
            "hint": f"Move the hand by more than {spacing:.0f} mm while it turns: a turn on the "
            "spot leaves no trace in a recording.",
            "can": self._can(),
            "leading": self.leading,
            "hand": [
                {"name": n, "low": a, "high": b, "value": round(float(v), 5), "unit": u}
                for n, a, b, v, u in zip(
                    HAND, low, high, self._hand, ["m"] * 3 + ["rad"] * 3, strict=True
                )
            ],
            "joints": [
                {
                    "name": name,
                    "low": float(arm.lower[j]),
                    "high": float(arm.upper[j]),
                    "value": float(q[j]),
                    "margin": float(margin[j]),
                    "unit": unit(arm, j),
                }
                for j, name in enumerate(arm.joint_names)
            ],
            "segments": self._segments,
        }

    def _can(self) -> Sequence[str]:
        if not self.leading:
            return ["accept", "repeat"]
        return ["stop"] if self.recording_now else ["record", "skip"]

    def _restart(self) -> None:
        start = self._setup.workcell.start
        self.led = LedArm(self._setup.workcell.arm, start, PERIOD)
        self._hand = self._hand_of(self._X_WE)
        self._q_goal = self._samples = self._offered = None
        self._segments = []
        self._inspector.clear()
        self._inspector.show_instance(self.X_WO)

    def _hand_of(self, X_WE: Array) -> Array:
        """Position, and rotation vector in the hand's own frame from where it started."""
        turned = pose(self._X_WE[:3, :3].T @ X_WE[:3, :3], np.zeros(3))
        return np.concatenate([X_WE[:3, 3], log(turned)[:3]])

    def _pose_of(self, hand: Array) -> Array:
        turned = exp(np.concatenate([hand[3:], np.zeros(3)]))[:3, :3]
        return pose(self._X_WE[:3, :3] @ turned, hand[:3])

    def _record(self) -> None:
        self._message, self._samples = "", [self.led.q.copy()]

    def _stop(self) -> None:
        q = np.array(self._samples)
        self._samples = None
        arm = self.led.arm
        recording = Recording(
            f"demo_{self._number + 1:02d}",
            arm.joint_names,
            PERIOD * np.arange(len(q)),
            q,
            self.X_WO,
        )
        try:
            self._offer(checked(recording, arm.lower, arm.upper))
        except DrakeScrewError as error:
            self._message = str(error)

    def _offer(self, recording: Recording) -> None:
        """Cut a recording into screws and plan the suggested instance with it."""
        demonstration = self._setup.learn(recording)
        workcell = self._setup.workcell
        plan = self._setup.batch_planner.plan(demonstration, self.X_WO, workcell.start)
        tried = attempt(workcell.arm, self._number, demonstration, self.X_WO, plan)
        self._inspector.draw(tried)
        self._segments = _lines(tried)
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


def _lines(tried: Attempt) -> list[dict[str, Any]]:
    return [
        {"color": STATUS_COLORS[status], "words": describe_segment(tried, i)}
        for i, status in enumerate(tried.status)
    ]
