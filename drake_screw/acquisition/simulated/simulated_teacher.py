"""The simulated teacher: demonstrates where it is asked to, as a person would, or says why not."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.acquisition.events import Suggestion
from drake_screw.acquisition.simulated.candidate_paths import CandidatePaths, follow_key_poses
from drake_screw.acquisition.simulated.human import RATE, timed, with_hand_noise
from drake_screw.acquisition.simulated.motions import (
    MOTIONS,
    HandPath,
    Motion,
    azimuth_deviations,
    hand_poses,
    tool_lengths,
    usual_azimuth,
)
from drake_screw.acquisition.simulated.stops import COMFORTABLE, MARGIN, ROUNDING, Stops
from drake_screw.acquisition.teacher import Lesson
from drake_screw.demonstrations import Recording
from drake_screw.demonstrations.recording import checked
from drake_screw.errors import ScenarioError, counted, unknown
from drake_screw.robot import Workcell
from drake_screw.tasks import WorkArea
from drake_screw.typing import Array

CANDIDATES = 64  # ways thought of at a time
ATTEMPTS = 3
COLLISION_STRIDE = 6  # one in so many points of a path is checked before it is performed
AZIMUTH_WEIGHT = 0.4  # rad of margin that people give up rather than come from a radian aside
TRAVEL_WEIGHT = 0.03  # rad of margin that people give up to save a radian of joint motion


@dataclass(frozen=True, eq=False)
class _Rehearsal:
    """Candidate ways as tried out, and how comfortable each was; -inf where it does not work."""

    keys: HandPath
    paths: CandidatePaths
    comfort: Array
    within: NDArray[np.bool_]


class SimulatedTeacher:
    """Leads the arm of a workcell as people do.

    For each request it thinks of many ways to do the motion at that place, with the variation that
    people show, follows each with the arm's kinematics, and gives the most comfortable one that
    collides with nothing: far from the joints' stops, with little motion, coming from the usual
    side, the tool held as usual. Where none works it thinks again, with the tool held longer. It
    does not ask the planner, nor knows what other places the demonstration will serve.

    The motion is that of the end effector relative to the first object, or to those that it names
    (`HandPath.at`), wherever they are; how they are turned makes no difference. It takes the end
    effector's z axis to point out of the tool. The table must be level.

    Args:
        workcell: the arm and what it may collide with.
        area: turns requests into object poses.
        motion: one of `MOTIONS`, or a function like those.
        free_axis: (3,) in the end effector's frame, about which it rolls as the joints have it;
            None where it is led as a whole.

    Raises:
        ScenarioError: no such motion, or it works on more objects than there are.
    """

    def __init__(
        self,
        workcell: Workcell,
        area: WorkArea,
        motion: str | Motion,
        free_axis: ArrayLike | None = None,
    ) -> None:
        if isinstance(motion, str) and motion not in MOTIONS:
            message, remedy = unknown("motion", motion, "the simulated teacher", MOTIONS)
            raise ScenarioError(message, remedy=remedy)
        self.workcell = workcell
        self.area = area
        self.motion = motion if isinstance(motion, str) else getattr(motion, "__name__", "motion")
        self._motion = MOTIONS[motion] if isinstance(motion, str) else motion
        least = 1 + max(self._motion(np.random.default_rng(0), np.zeros(1)).objects)
        if least > len(area.objects):
            raise ScenarioError(
                f"teacher.motion: '{self.motion}' works on {counted(least, 'object')}, and there "
                f"{'is' if len(area.objects) == 1 else 'are'} {len(area.objects)}",
                remedy="Add objects in the order in which the motion comes to them, or choose "
                "another motion.",
            )
        self._chain = workcell.arm.screw_chain()
        self._free_axis = None if free_axis is None else np.asarray(free_axis, dtype=float)
        self._stops = Stops.of(workcell.arm, workcell.start)

    def demonstrate(
        self,
        suggestion: Suggestion,
        *,
        number: int,
        used: tuple[Recording, ...],
        rng: np.random.Generator,
    ) -> Lesson:
        """A new recording at the suggested instance, a function of it and of `rng` alone.

        Where none of the ways that were thought of works, the remark says what was in the way.
        """
        X_WO = self.area.X_WO(suggestion.coordinates)
        x, y = X_WO[0, :2, 3]
        where = f"x={x:.2f}, y={y:.2f}"
        unreached = limited = 0
        touched: Counter[tuple[str, str]] = Counter()
        for attempt in range(ATTEMPTS):
            rehearsal = self._rehearse(X_WO, rng, stretched=attempt > 0)
            unreached += int(np.count_nonzero(~rehearsal.paths.arrived))
            limited += int(np.count_nonzero(rehearsal.paths.arrived & ~rehearsal.within))
            possible = np.flatnonzero(np.isfinite(rehearsal.comfort))
            for choice in possible[np.argsort(-rehearsal.comfort[possible])]:
                if hit := self._touching(rehearsal.paths.q[choice, ::COLLISION_STRIDE], X_WO):
                    touched[hit] += 1
                    continue
                q = self._perform(rehearsal, int(choice), rng)
                if not self._stops.kept(q):
                    limited += 1
                elif hit := self._touching(q, X_WO):
                    touched[hit] += 1
                else:
                    remark = f"simulated {self.motion} at {where}"
                    task = rehearsal.keys.objects
                    return Lesson(self._recording(q, X_WO, number, task), remark)
        return Lesson(
            None,
            f"no feasible demonstration at {where}: of {ATTEMPTS * CANDIDATES} ways "
            f"of {self.motion}, {unreached} are out of reach, {limited} meet a joint limit and "
            f"{touched.total()} collide{_most_often(touched)}",
        )

    def _touching(self, q: Array, X_WO: Array) -> tuple[str, str] | None:
        """Which bodies touch first along q (m, n); None if none do."""
        collides = self.workcell.collides(q, X_WO)
        if not collides.any():
            return None
        pairs = self.workcell.colliding_bodies(q[int(np.argmax(collides))], X_WO)
        return pairs[0] if pairs else ("the robot", "something")

    def _rehearse(self, X_WO: Array, rng: np.random.Generator, *, stretched: bool) -> _Rehearsal:
        rest, p_WO = self._chain.pose(self.workcell.start), X_WO[:, :3, 3]
        keys = self._motion(rng, tool_lengths(rng, CANDIDATES, stretched=stretched))
        aside, azimuth = np.zeros((2, CANDIDATES, len(p_WO)))
        for i in keys.objects:
            aside[:, i] = azimuth_deviations(rng, CANDIDATES)
            azimuth[:, i] = usual_azimuth(rest, p_WO[i]) + aside[:, i]
        X_WK = hand_poses(keys, azimuth, rest, p_WO)
        ends, axis = self._stops.ends, self._free_axis
        paths = follow_key_poses(self._chain, self.workcell.start, X_WK, ends, axis)
        margin = self._stops.margin(paths.q).min(axis=1)
        within = margin >= MARGIN - ROUNDING
        travel = np.linalg.norm(np.diff(paths.q, axis=1), axis=-1).sum(axis=1)
        comfort = (
            np.minimum(margin, COMFORTABLE)
            - keys.held
            - AZIMUTH_WEIGHT * (aside**2).sum(axis=1)
            - TRAVEL_WEIGHT * travel
        )
        comfort += rng.normal(0.0, 0.02, CANDIDATES)
        return _Rehearsal(keys, paths, np.where(paths.arrived & within, comfort, -np.inf), within)

    def _perform(self, rehearsal: _Rehearsal, choice: int, rng: np.random.Generator) -> Array:
        q = rehearsal.paths.q[choice]
        moving = timed(
            q,
            rehearsal.paths.segment,
            self._chain.pose(q),
            rehearsal.keys.pause,
            self.workcell.arm.velocity_limits,
            rng,
        )
        return with_hand_noise(self._chain, moving, rng)

    def _recording(self, q: Array, X_WO: Array, number: int, task: tuple[int, ...]) -> Recording:
        arm, objects = self.workcell.arm, self.area.objects
        recording = Recording(
            f"demo_{number + 1:02d}",
            arm.joint_names,
            np.arange(len(q)) / RATE,
            q,
            X_WO,
            task_objects=tuple(objects[i].name for i in task) if len(objects) > 1 else (),
        )
        return replace(checked(recording, arm.lower, arm.upper, units=arm.units), notes=())


def _most_often(touched: Counter[tuple[str, str]]) -> str:
    if not touched:
        return ""
    ((robot, other), count), *_ = touched.most_common(1)
    return f" ({robot} with {other} in {count} of them)"
