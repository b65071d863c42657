"""An attempt in Meshcat: its screws, its frames, the arm along its plan, and where it failed.

Under ``/attempts/01`` and so on, one for each demonstration drawn: ``segments/01``, ... (the end
effector's path), ``axes/01``, ... (the screws), ``frames`` (the guiding poses), ``turned`` (how
symmetric objects are turned), ``ghost`` (the arm where the plan failed, and under
``ghost/touching`` the bodies that touch there) and ``dial`` (the range of the joint at its limit,
with a needle). Under ``/copies/01`` and so on the arm once more, translucent, to be shown beside
another attempt. Under ``/instance`` the objects. The robot itself is the one of `Scene`, at
``/workcell``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import Meshcat

from drake_screw.robot import Arm, ObjectConfig, Workcell
from drake_screw.tasks import Symmetry
from drake_screw.typing import Array
from drake_screw.visualization import meshes, screw_shapes
from drake_screw.visualization.attempt import AHEAD, DONE, FAILED, Attempt
from drake_screw.visualization.drawing import draw, draw_frames
from drake_screw.visualization.linkage import Linkage
from drake_screw.visualization.palette import INK, PAPER, STATUS_COLORS
from drake_screw.visualization.reach_drawing import draw_reach
from drake_screw.visualization.rim_marks import mark_angles
from drake_screw.visualization.screw_drawing import draw_screw

BOWL = "#f4c95d"
COPY, COPY_OPACITY = "#0072b2", 0.45
GHOST_OPACITY, AHEAD_OPACITY, TOUCHING_OPACITY = 0.22, 0.35, 0.6
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
        copied: links of ``/workcell`` that are drawn once more, under the same names.
    """

    attempt: Attempt
    path: str
    samples: Array
    moving: dict[str, Array]
    copied: tuple[str, ...] = ()


class Inspector:
    """Draws attempts into a Meshcat that shows a `Scene`.

    Args:
        meshcat: drawn into.
        workcells: of each arm that is planned for.
        objects: how the objects look.
        symmetries: of each object; none has any where left out.
    """

    def __init__(
        self,
        meshcat: Meshcat,
        workcells: Sequence[Workcell],
        objects: Sequence[ObjectConfig],
        symmetries: Sequence[Symmetry | None] = (),
    ) -> None:
        self.meshcat = meshcat
        self._workcells = tuple(workcells)
        self._linkages = tuple(Linkage(workcell) for workcell in workcells)
        self._objects = tuple(objects)
        self._symmetries = tuple(symmetries) or (None,) * len(self._objects)
        self.clear()

    def clear(self) -> None:
        """Remove all attempts and the instance."""
        self.meshcat.Delete("/attempts")
        self.meshcat.Delete("/copies")
        self.meshcat.Delete("/instance")

    def show_instance(self, X_WO: Array) -> None:
        """Draw the objects at X_WO (k, 4, 4) in place of those before, marked on their rims."""
        self.meshcat.Delete("/instance")
        for item, symmetry, X in zip(self._objects, self._symmetries, X_WO, strict=True):
            bowl = meshes.bowl(item.radius, item.height).moved(X)
            draw(self.meshcat, f"/instance/{item.name}", bowl, BOWL)
            angles, lift = mark_angles(symmetry), np.eye(4)
            lift[2, 3] = item.height
            if angles is not None:
                marks = [
                    screw_shapes.sector(item.radius - 0.012, item.radius + 0.012, a, b, 0.008)
                    for a, b in zip(angles - 0.08, angles + 0.08, strict=True)
                ]
                mark = meshes.join(marks).moved(X @ lift)
                draw(self.meshcat, f"/instance/{item.name}/turn", mark, INK)

    def aim(self, X_WO: Array) -> None:
        """Point the camera at the objects at X_WO (k, 4, 4), with the arm in the picture."""
        linkage = self._linkages[0]
        shoulder = linkage.joint_frames(0, np.zeros((1, linkage.arm.n)))[0, :3, 3]
        target = 0.4 * shoulder + 0.6 * X_WO[:, :3, 3].mean(axis=0)
        self.meshcat.SetCameraPose(target + np.array(VIEW), target)

    def pose(self, arm: Arm, q: Array) -> None:
        """Show an arm at q (n,) rad or m, and the others at rest."""
        for path, X_WL in self._poses(arm, q[None]).items():
            self.meshcat.SetTransform(path, X_WL[0])

    def _poses(self, arm: Arm, q: Array) -> dict[str, Array]:
        """X_WL (m, 4, 4) of all arms' links by their paths, one arm at q (m, n), others at rest."""
        found: dict[str, Array] = {}
        for workcell, linkage in zip(self._workcells, self._linkages, strict=True):
            moves = linkage.arm.joint_names == arm.joint_names
            X_WL = linkage.poses(q if moves else workcell.start[None])
            X_WL = np.broadcast_to(X_WL, (len(q), *X_WL.shape[1:]))
            found |= {f"/workcell/{name}": X_WL[:, i] for i, name in enumerate(linkage.names)}
        return found

    def _number(self, arm: Arm) -> int:
        names = [linkage.arm.joint_names for linkage in self._linkages]
        return names.index(arm.joint_names)

    def draw(self, attempt: Attempt, *, copy: bool = False) -> Drawn:
        """Draw an attempt in place of an earlier one with the same demonstration.

        Args:
            attempt: what to draw.
            copy: draw the arm once more, hidden, to be shown beside another attempt.
        """
        path = f"/attempts/{attempt.number + 1:02d}"
        self.meshcat.Delete(path)
        for segment, status in enumerate(attempt.status):
            self._draw_segment(f"{path}/segments/{segment + 1:02d}", attempt, segment, status)
            X_WA, X_WB = attempt.starts[segment], attempt.guides[segment]
            if segment > 0 or not attempt.plan.approach:
                axis, color = f"{path}/axes/{segment + 1:02d}", STATUS_COLORS[status]
                draw_screw(self.meshcat, axis, X_WA, X_WB, color)
        draw_frames(self.meshcat, f"{path}/frames", attempt.guides, size=0.045)
        self._draw_turns(f"{path}/turned", attempt)
        samples = attempt.samples(SAMPLES)
        q = attempt.plan.q[samples]
        moved = self._number(attempt.arm)
        linkage, workcell = self._linkages[moved], self._workcells[moved]
        moving = self._poses(attempt.arm, q)
        if not attempt.plan.success:
            last, color = attempt.plan.q[-1], STATUS_COLORS[FAILED]
            linkage.draw_copy(self.meshcat, f"{path}/ghost", last, color, GHOST_OPACITY)
            positions = workcell.positions(last, attempt.X_WO)
            touching = [name for pair in attempt.bodies for name in pair]
            place = f"{path}/ghost/touching"
            linkage.draw_bodies(self.meshcat, place, touching, positions, color, TOUCHING_OPACITY)
        if attempt.unreachable is not None:
            draw_reach(self.meshcat, f"{path}/ghost/reach", attempt.unreachable)
        if attempt.failed_joint is not None:
            moving |= self._draw_dial(f"{path}/dial", attempt, attempt.failed_joint, q)
            X_WJ = linkage.joint_frames(attempt.failed_joint, attempt.plan.q[-1:])[0]
            ring = meshes.ring(RING, 0.012).moved(X_WJ)
            draw(self.meshcat, f"{path}/ghost/joint", ring, STATUS_COLORS[FAILED])
        if copy:
            place = f"/copies/{attempt.number + 1:02d}"
            linkage.draw_copy(self.meshcat, place, q[0], COPY, COPY_OPACITY)
            self.meshcat.SetProperty(place, "visible", False)
        return Drawn(attempt, path, samples, moving, linkage.names if copy else ())

    def _draw_turns(self, path: str, attempt: Attempt) -> None:
        """Around every symmetric object an arc from where it stood to where it is turned to."""
        looks = {item.name: item for item in self._objects}
        for turn in attempt.turned:
            item = looks.get(turn.body)
            if item is None:
                continue
            rim, lift = item.radius + 0.006, np.eye(4)
            lift[2, 3] = item.height
            first, last = sorted((-turn.angle, 0.0))
            color = STATUS_COLORS[DONE if attempt.plan.success else FAILED]
            arc = screw_shapes.sector(rim, rim + 0.012, first - 0.01, last + 0.01, 0.004)
            draw(self.meshcat, f"{path}/{turn.body}/arc", arc.moved(turn.X_FT @ lift), color, 0.7)
            mark = screw_shapes.sector(rim - 0.012, rim + 0.03, -0.05, 0.05, 0.008)
            draw(self.meshcat, f"{path}/{turn.body}/mark", mark.moved(turn.X_FT @ lift), color)

    def _draw_segment(self, path: str, attempt: Attempt, segment: int, status: str) -> None:
        """The path along one screw; of the failing one the part that was done is thicker."""
        color = STATUS_COLORS[status]
        fraction = float(attempt.plan.outcome.fraction) if status == FAILED else 1.0
        ends = {"way": (0.0, fraction), "rest": (fraction, 1.0)}
        for name, (first, last) in ends.items():
            track = attempt.path(segment, first, last)
            if len(track) < 2:
                continue
            thin = name == "rest" or status == AHEAD
            line = meshes.tube(track, 0.006 if thin else 0.012, sides=8)
            draw(self.meshcat, f"{path}/{name}", line, color, AHEAD_OPACITY if thin else 1.0)

    def _draw_dial(self, path: str, attempt: Attempt, joint: int, q: Array) -> dict[str, Array]:
        """The range of a joint as a dial around it, its limits, and a needle where it stands."""
        arm = attempt.arm
        X_WJ = self._linkages[self._number(arm)].joint_frames(joint, q)
        color = STATUS_COLORS[FAILED]
        if arm.units[joint] != "rad" or arm.endless[joint]:
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
