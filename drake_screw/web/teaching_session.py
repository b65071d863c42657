"""One request for a demonstration on the teaching page, from the suggestion to the recording."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from drake_screw.acquisition import Suggestion
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import FaithfulConfig, Recording
from drake_screw.demonstrations.part import part_of
from drake_screw.demonstrations.recording import checked
from drake_screw.errors import DrakeScrewError
from drake_screw.runs.narration import place
from drake_screw.screws import quaternion_from_rotation
from drake_screw.screws.endless import drawn_range
from drake_screw.typing import Array
from drake_screw.visualization.inspector import Inspector
from drake_screw.visualization.look_scene import clear_path, draw_path
from drake_screw.visualization.palette import INK
from drake_screw.web.led_arm import PERIOD, LedArm
from drake_screw.web.offer import Offer, as_state, offer

AT_LIMIT = 0.01
"""rad or m. A joint that is nearer to a limit holds the arm back."""
DEGREE = np.pi / 180.0
POSE_SLIDERS = (
    ("x", "m", 1.0),
    ("y", "m", 1.0),
    ("z", "m", 1.0),
    ("tilt about its x", "°", DEGREE),
    ("tilt about its y", "°", DEGREE),
    ("roll about its z", "°", DEGREE),
)
"""Name, unit, and the unit in m or rad of each slider of the end effector's pose."""
FARTHEST = 10.0
"""m or rad. No step is longer."""


class TeachingSession:
    """One request, from the suggestion to the accepted recording.

    Args:
        setup: of the run.
        inspector: draws what a recording would do.
        suggestion: where the demonstration is wanted.
        number: of the demonstration, from 0.

    Attributes:
        led: the arm, as the person leads it: of several the one nearest to the object.
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
        self.over = False
        self.accepted: Recording | None = None
        self._message = ""
        self.led: LedArm
        self._whole: Recording | None
        self._ends: tuple[float, float]
        self._asked: tuple[float, float] | None
        self._offer: Offer | None
        self._restart()

    @property
    def leading(self) -> bool:
        """Whether the arm follows the person, who has not recorded anything yet."""
        return self._whole is None

    @property
    def recording(self) -> bool:
        """Whether the arm's motion is being recorded."""
        return self.led.recording

    def handle(self, message: dict[str, Any]) -> None:
        """A message of the panel; one that means nothing changes nothing.

        Messages: ``{"do": "record"}`` (back, stop, accept, repeat, skip); while the arm is led
        ``{"pose": i, "value": v}`` (a slider of the end effector's pose, in its unit), ``{"hand":
        [x, y, z, w, i, j, k]}`` (the pose itself, m and a quaternion), ``{"jog": i, "value": v}``
        (a step along or about an axis, m or rad) and ``{"joint": j, "value": v}`` (rad or m);
        afterwards ``{"trim": [start, end]}``, s of the recording.
        """
        match message:
            case {"do": str(action)} if action in self._actions():
                getattr(self, f"_{action}")()
            case {"trim": [int() | float() as start, int() | float() as end]}:
                if self._whole is not None and isfinite(start) and isfinite(end):
                    start, end = np.clip((start, end), 0.0, self._whole.duration).tolist()
                    self._asked = (start, end)
            case {"pose": int(i), "value": int() | float() as value} if self.leading:
                if 0 <= i < len(POSE_SLIDERS) and isfinite(value):
                    self.led.want_part(i, value * POSE_SLIDERS[i][2])
            case {"hand": [*numbers]} if self.leading:
                if _is_pose(numbers):
                    self.led.want_pose(numbers[:3], numbers[3:])
            case {"jog": int(i), "value": int() | float() as value} if self.leading:
                if 0 <= i < len(POSE_SLIDERS) and abs(value) <= FARTHEST:
                    self.led.jog(i, value)
            case {"joint": int(joint), "value": int() | float() as value} if self.leading:
                if 0 <= joint < self._arm.n and isfinite(value):
                    self.led.want_joint(joint, value)

    def is_to_plan(self, message: dict[str, Any]) -> bool:
        """Whether a message ends a recording, which is then planned."""
        return message.get("do") == "stop" and "stop" in self._actions()

    def step(self) -> bool:
        """One period of the arm's motion; returns whether anything changed."""
        if self._whole is None:
            return self.led.step()
        if self._asked is None:
            return False
        self._at = 0 if self._asked[0] != self._ends[0] else -1
        self._ends, self._asked = self._asked, None
        try:
            self._cut(self._whole)
        except DrakeScrewError as error:
            self._offer, self._message = None, str(error)
            self._clear()
        return True

    @property
    def q(self) -> Array:
        """(n,) rad or m, where the arm is shown; of a recording at the end that was moved last."""
        if self._offer is None or self._offer.recording.joint_names != self._arm.joint_names:
            return self.led.q
        return np.asarray(self._offer.recording.q[self._at])

    def offer_folder(self, folder: Path) -> str:
        """Offer a recording from a folder; returns what became of it, in words."""
        try:
            self._take(self._setup.own_recorder.read(folder))
        except DrakeScrewError as error:
            self._message = str(error)
        else:
            self._message = f"{folder.name}: {self._message}"
        return self._message

    def state(self) -> dict[str, Any]:
        """What the panel shows."""
        led, arm, q = self.led, self._arm, self.q
        margin = arm.margin(q)
        least, greatest = drawn_range(arm.lower, arm.upper, self.start[None])
        asked = place(self._suggestion, self._suggestion.regions or self._setup.regions)
        sliders = zip(POSE_SLIDERS, led.low, led.high, led.wanted, strict=True)
        return {
            "title": f"{self._setup.scenario.name}: teach",
            "headline": f"demonstration {self._number + 1} is wanted at {asked}",
            "message": self._message or (self._held_back() if led.held_back else ""),
            "clock": f"recording, {led.recorded:.1f} s" if self.recording else "",
            "hint": _hint(self._setup),
            "can": self._actions(),
            "leading": self.leading,
            "hand": {
                "name": arm.end_effector,
                "is": _seven(arm.pose(q)),
                "wanted": _seven(led.X_WE_wanted),
            },
            "pose": [
                {
                    "name": name,
                    "low": round(float(low / size), 3),
                    "high": round(float(high / size), 3),
                    "value": round(float(value / size), 3),
                    "unit": unit,
                }
                for (name, unit, size), low, high, value in sliders
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
            "ends": self._ends,
            **as_state(self._offer, self._whole),
        }

    def _held_back(self) -> str:
        """Why the arm cannot follow."""
        names, margin = self._arm.joint_names, self._arm.margin(self.led.q)
        at_limit = [name for name, left in zip(names, margin, strict=True) if left < AT_LIMIT]
        if not at_limit:
            return "the arm cannot follow: it is stretched out"
        return f"the arm cannot follow: {', '.join(at_limit)} at the limit"

    def _actions(self) -> Sequence[str]:
        """The buttons that can be pressed; each has a method."""
        if not self.leading:
            return ["repeat"] if self._offer is None else ["accept", "repeat"]
        return ["back", "stop"] if self.recording else ["record", "skip"]

    def _restart(self) -> None:
        self.led = LedArm(self._arm, self.start, self._setup.area)
        self._whole = self._offer = self._asked = None
        self._ends, self._at = (0.0, 0.0), -1
        self._clear()

    def _clear(self) -> None:
        """Show the objects alone."""
        self._inspector.clear()
        clear_path(self._inspector.meshcat)
        self._inspector.show_instance(self._X_WO)

    def _record(self) -> None:
        self._message = ""
        self.led.record()

    def _back(self) -> None:
        self.led.take_back()

    def _stop(self) -> None:
        arm, q = self._arm, self.led.stop()
        t = PERIOD * np.arange(len(q))
        name = f"demo_{self._number + 1:02d}"
        try:
            recording = Recording(name, arm.joint_names, t, q, self._X_WO)
            self._take(checked(recording, arm.lower, arm.upper, units=arm.units))
        except DrakeScrewError as error:
            self._message = str(error)

    def _take(self, recording: Recording) -> None:
        """Offer the whole of a recording."""
        self._ends, self._at = (0.0, recording.duration), -1
        self._cut(recording)
        self._whole = recording

    def _cut(self, whole: Recording) -> None:
        """Offer the part of a recording between the ends, and draw it."""
        start, end = self._ends
        part = part_of(whole, start, end)
        found = offer(self._setup, self._X_WO, self._number, part, start if part.cut else 0.0)
        self._offer, self._message = found, found.words
        self._inspector.draw(found.tried)
        draw_path(self._inspector.meshcat, found.look, INK)

    def _accept(self) -> None:
        assert self._offer is not None
        self.accepted, self.over = self._offer.recording, True

    def _repeat(self) -> None:
        self._message = ""
        self._restart()

    def _skip(self) -> None:
        self.over = True


def _seven(X: Array) -> list[float]:
    """A pose (4, 4) as position in m and unit quaternion, w first."""
    return [round(float(v), 6) for v in (*X[:3, 3], *quaternion_from_rotation(X[:3, :3]))]


def _is_pose(numbers: Sequence[Any]) -> bool:
    """Whether a message's numbers are a position, and a quaternion that says how to turn."""
    plain = all(isinstance(v, int | float) and isfinite(v) for v in numbers)
    return plain and len(numbers) == 7 and 0.5 < float(np.linalg.norm(numbers[3:])) < 2.0


def _hint(setup: Setup) -> str:
    """What to mind while leading the arm, if anything."""
    config = setup.learning.segmentation
    if isinstance(config, FaithfulConfig):
        return ""
    return (
        f"Move the end effector by more than {1e3 * config.spacing:.0f} mm while it turns: a turn "
        "on the spot leaves no trace in a recording."
    )
