"""An attempt in Meshcat: its screws, its frames, the arm along its plan, and where it failed.

Under ``/attempts/01`` and so on, one for each demonstration drawn: ``segments/01``, ... (the hand's
way), ``axes/01``, ... (the screws), ``frames`` (the guiding poses), ``ghost`` (the arm where the
plan failed) and ``dial`` (the range of the joint at its limit, with a needle). Under ``/instance``
the objects. The robot itself is the one of `Scene`, at ``/workcell``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Meshcat

from drake_screw.robot import ObjectConfig, Workcell
from drake_screw.screws import sclerp_position
from drake_screw.typing import Array
from drake_screw.visualization import meshes, screw_shapes
from drake_screw.visualization.attempt import AHEAD, FAILED, Attempt
from drake_screw.visualization.drawing import draw, draw_frames
from drake_screw.visualization.linkage import Linkage
from drake_screw.visualization.palette import INK, PAPER, STATUS_COLORS

BOWL = "#f4c95d"
AXIS = "#5b3fa8"
GHOST_OPACITY, AHEAD_OPACITY = 0.22, 0.35
SAMPLES = 120
DIAL = (0.110, 0.145)
RING = 0.160
VIEW = (1.25, -0.85, 0.75)


@dataclass(frozen=True, eq=False)
class Drawn:
    """An attempt in the scene tree.

    Attributes:
        attempt: what was drawn.
        path: where.
        samples: (m,) the points of the plan that the arm can be shown at.
        moving: paths of what moves along the plan, with X_WL (m, 4, 4) of each.
    """

    attempt: Attempt
    path: str
    samples: Array
    moving: dict[str, Array]


class Inspector:
    """Draws attempts into a Meshcat that shows a `Scene`.

    Args:
        meshcat: drawn into.
        workcell: of the scenario.
        objects: how the objects look.
    """

    def __init__(
        self, meshcat: Meshcat, workcell: Workcell, objects: Sequence[ObjectConfig]
    ) -> None:
        self.meshcat = meshcat
        self.linkage = Linkage(workcell)
        self._objects = tuple(objects)
        self.clear()

    def clear(self) -> None:
        """Remove all attempts and the instance."""
        self.meshcat.Delete("/attempts")
        self.meshcat.Delete("/instance")

    def show_instance(self, X_WO: Array) -> None:
        """Draw the objects at X_WO (k, 4, 4) in place of those before."""
        self.meshcat.Delete("/instance")
        for item, X in zip(self._objects, X_WO, strict=True):
            bowl = meshes.bowl(item.radius, item.height).moved(X)
            draw(self.meshcat, f"/instance/{item.name}", bowl, BOWL)

    def aim(self, X_WO: Array) -> None:
        """Point the camera at the objects at X_WO (k, 4, 4), with the arm in the picture."""
        shoulder = self.linkage.joint_frames(0, np.zeros((1, self.linkage.arm.n)))[0, :3, 3]
        target = 0.4 * shoulder + 0.6 * X_WO[:, :3, 3].mean(axis=0)
        self.meshcat.SetCameraPose(target + np.array(VIEW), target)

    def draw(self, attempt: Attempt) -> Drawn:
        """Draw an attempt in place of an earlier one with the same demonstration."""
        path = f"/attempts/{attempt.number + 1:02d}"
        self.meshcat.Delete(path)
        for segment, status in enumerate(attempt.status):
            self._draw_segment(f"{path}/segments/{segment + 1:02d}", attempt, segment, status)
            self._draw_axis(f"{path}/axes/{segment + 1:02d}", attempt, segment)
        draw_frames(self.meshcat, f"{path}/frames", attempt.guides, size=0.045)
        samples = attempt.samples(SAMPLES)
        q = attempt.plan.q[samples]
        X_WL = self.linkage.poses(q)
        moving = {f"/workcell/{name}": X_WL[:, i] for i, name in enumerate(self.linkage.names)}
        if not attempt.plan.success:
            last, color = attempt.plan.q[-1], STATUS_COLORS[FAILED]
            self.linkage.draw_copy(self.meshcat, f"{path}/ghost", last, color, GHOST_OPACITY)
        if attempt.failed_joint is not None:
            moving |= self._draw_dial(f"{path}/dial", attempt, attempt.failed_joint, q)
            X_WJ = self.linkage.joint_frames(attempt.failed_joint, attempt.plan.q[-1:])[0]
            ring = meshes.ring(RING, 0.012).moved(X_WJ)
            draw(self.meshcat, f"{path}/ghost/joint", ring, STATUS_COLORS[FAILED])
        return Drawn(attempt, path, samples, moving)

    def _draw_segment(self, path: str, attempt: Attempt, segment: int, status: str) -> None:
        """The hand's way along one screw; of the failing one the part that was done is thicker."""
        color = STATUS_COLORS[status]
        fraction = float(attempt.plan.outcome.fraction) if status == FAILED else 1.0
        ends = {"way": (0.0, fraction), "rest": (fraction, 1.0)}
        for name, (first, last) in ends.items():
            track = self._track(attempt, segment, first, last)
            if len(track) < 2:
                continue
            thin = name == "rest" or status == AHEAD
            line = meshes.tube(track, 0.006 if thin else 0.012, sides=8)
            draw(self.meshcat, f"{path}/{name}", line, color, AHEAD_OPACITY if thin else 1.0)

    def _track(self, attempt: Attempt, segment: int, first: float, last: float) -> Array:
        s = np.linspace(first, last, 41)
        p_WE = sclerp_position(attempt.starts[segment], attempt.guides[segment], s)
        keep = np.append(True, np.linalg.norm(np.diff(p_WE, axis=0), axis=1) > 1e-6)
        return p_WE[keep] if last > first else p_WE[:0]

    def _draw_axis(self, path: str, attempt: Attempt, segment: int) -> None:
        """The axis with a helix around it that shows angle, sense and pitch of the screw.

        A segment that looks straight gets an arrow beside the hand's way instead.
        """
        screw = attempt.screws
        axis, point = screw.axis[segment], screw.point[segment]
        p_A, p_B = attempt.starts[segment, :3, 3], attempt.guides[segment, :3, 3]
        if attempt.straight(segment):
            lift = np.array([0.0, 0.0, 0.03])
            if np.linalg.norm(p_B - p_A) > 0.01:
                line = screw_shapes.arrow(p_A + lift, p_B + lift, 0.005)
                draw(self.meshcat, f"{path}/direction", line, AXIS)
            return
        translation = float(screw.translation[segment])
        begin = point + axis * (axis @ (p_A - point))
        low, high = min(translation, 0.0), max(translation, 0.0)
        line = screw_shapes.arrow(begin + (low - 0.11) * axis, begin + (high + 0.13) * axis, 0.006)
        draw(self.meshcat, f"{path}/axis", line, AXIS)
        across = p_A - begin
        length = float(np.linalg.norm(across))
        first = across / length if length > 1e-6 else screw_shapes.along(axis)[:, 0]
        angle = float(screw.angle[segment])
        helix = screw_shapes.turning(axis, begin, first, angle, translation, 0.006)
        status = attempt.status[segment]
        draw(self.meshcat, f"{path}/turn", helix, STATUS_COLORS[status])
        if length > screw_shapes.RADIUS:
            spoke = meshes.tube([begin, p_A], 0.002)
            draw(self.meshcat, f"{path}/spoke", spoke, AXIS, 0.4)

    def _draw_dial(self, path: str, attempt: Attempt, joint: int, q: Array) -> dict[str, Array]:
        """The range of a joint as a dial around it, its limits, and a needle where it stands."""
        arm = attempt.arm
        X_WJ = self.linkage.joint_frames(joint, q)
        color = STATUS_COLORS[FAILED]
        if arm.units[joint] != "rad":
            mark = meshes.ring(DIAL[1], 0.014)
            draw(self.meshcat, f"{path}/mark", mark, color)
            return {f"{path}/mark": X_WJ}
        inner, outer = DIAL
        lower, upper = float(arm.lower[joint]), float(arm.upper[joint])
        last = float(attempt.plan.q[-1, joint])
        limit = upper if abs(last - upper) < abs(last - lower) else lower
        scale = screw_shapes.sector(inner, outer, lower, upper, 0.006)
        stop = screw_shapes.sector(inner - 0.01, outer + 0.02, limit - 0.05, limit + 0.05, 0.016)
        needle = screw_shapes.sector(inner - 0.03, outer + 0.01, -0.03, 0.03, 0.010)
        draw(self.meshcat, f"{path}/scale", scale, PAPER, 0.85)
        draw(self.meshcat, f"{path}/limit", stop, color)
        draw(self.meshcat, f"{path}/needle", needle, INK)
        turn = np.tile(np.eye(4), (len(q), 1, 1))
        c, s = np.cos(q[:, joint]), np.sin(q[:, joint])
        turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1] = c, -s, s, c
        return {
            f"{path}/scale": X_WJ,
            f"{path}/limit": X_WJ,
            f"{path}/needle": X_WJ @ turn,
        }
