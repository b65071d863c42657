"""The frames of a bag: poses over time of one frame seen from another, and chains of them."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping as Dict
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

from drake_screw.errors import RecordingError, nearest, suggestion
from drake_screw.screws import (
    inverse,
    pose,
    quaternion_from_rotation_vector,
    quaternion_multiply,
    rotation_from_quaternion,
    rotation_vector_from_quaternion,
)
from drake_screw.screws.rotations import quaternion_conjugate
from drake_screw.typing import Array

ALWAYS = -np.inf
"""Time of a pose that holds all along."""
_LISTED = 40


def plain_frame(name: str) -> str:
    """A frame's name without the slash before it that tf's first version has."""
    return name.lstrip("/")


@dataclass(frozen=True, eq=False)
class Track:
    """Poses X_PC over time of a frame C seen from its parent P.

    Attributes:
        t: (m,) s, increasing; one `ALWAYS` where the pose is static.
        p: (m, 3) m.
        q: (m, 4) unit quaternions w, x, y, z.
    """

    t: Array
    p: Array
    q: Array

    @staticmethod
    def of(t: Array, p: Array, q: Array, *, static: bool) -> Track | None:
        """Of samples in any order; those that are no poses (a lost marker) are left out.

        Of a static pose the last sample counts. None where no sample is left.
        """
        length = np.linalg.norm(q, axis=-1)
        good = np.isfinite(p).all(axis=-1) & np.isfinite(length) & (np.abs(length - 1.0) < 0.1)
        t, p, q = t[good], p[good], q[good] / length[good, None]
        if not len(t):
            return None
        if static:
            return Track(np.array([ALWAYS]), p[-1:], q[-1:])
        order = np.argsort(t, kind="stable")
        t, p, q = t[order], p[order], q[order]
        new = np.append(True, np.diff(t) > 0.0)
        return Track(t[new], p[new], q[new])

    @property
    def static(self) -> bool:
        """Whether it is one pose for all times."""
        return bool(self.t[0] == ALWAYS)

    def at(self, t: Array) -> Array:
        """X_PC (n, 4, 4) at times (n,): between samples linear, and held before and after them."""
        if len(self.t) == 1:
            one = pose(rotation_from_quaternion(self.q[0]), self.p[0])
            return np.broadcast_to(one, (len(t), 4, 4))
        i = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, len(self.t) - 2)
        s = np.clip((t - self.t[i]) / (self.t[i + 1] - self.t[i]), 0.0, 1.0)[:, None]
        step = quaternion_multiply(quaternion_conjugate(self.q[i]), self.q[i + 1])
        turn = quaternion_from_rotation_vector(s * rotation_vector_from_quaternion(step))
        R = rotation_from_quaternion(quaternion_multiply(self.q[i], turn))
        return np.asarray(pose(R, (1.0 - s) * self.p[i] + s * self.p[i + 1]))


_Link = tuple[Track, bool, str]
"""A track, whether it is followed from parent to child, and the frame that it leads to."""


@dataclass(frozen=True, eq=False)
class Seen:
    """Poses X_BO (m, 4, 4) of a frame at times t (m,), seen from the robot's base, and how."""

    t: Array
    X: Array
    how: str


@dataclass(frozen=True, eq=False)
class Frames:
    """Transforms between frames, on the clock of the recording's table.

    Attributes:
        tracks: by the names of parent and child. A topic of poses is a child called like itself.
        topics: the child frame that a topic of transforms tells of.
    """

    tracks: Dict[tuple[str, str], Track] = field(default_factory=dict)
    topics: Dict[str, str] = field(default_factory=dict)

    @property
    def names(self) -> tuple[str, ...]:
        """Of the frames and topics whose poses are told, or that others are seen from."""
        return tuple(dict.fromkeys([*self.topics, *(n for pair in self.tracks for n in pair if n)]))

    def base(self, name: str) -> str:
        """What the robot's base is called here, by its name in the model, which may be scoped."""
        name = plain_frame(name)
        return name if name in self.names else name.split("::")[-1]

    def has(self, name: str) -> bool:
        """Whether there is a pose of that frame or topic."""
        return self._node(name) is not None

    def seen(self, name: str, base: str, *, named: bool = False, file: Path | None = None) -> Seen:
        """A frame or topic seen from the robot's base, through all frames between the two.

        Times are those at which the last link towards it that is not static was told; the others
        are interpolated. A pose in a frame without a name counts as seen from the base.

        Args:
            name: of a frame or topic.
            base: the frame of the robot's base.
            named: whether the user said so himself.
            file: named in errors.

        Raises:
            RecordingError: there is no such frame or topic, or no chain of transforms.
        """
        node = self._node(name)
        if node is None:
            raise RecordingError(
                f"no topic or frame '{name}' with poses",
                remedy=suggestion(name, self.names, "Topics and frames"),
                file=file,
            )
        base = self.base(base)
        chain = self._chain(base, node)
        if chain is None:
            raise self._no_chain(base, node, named=named, file=file)
        root, links = chain
        moving = [track for track, _, _ in links if not track.static]
        t = moving[-1].t if moving else np.array([ALWAYS])
        X = _along(links, t)
        between = [at for _, _, at in links[:-1]]
        how = f"seen from '{base}'"
        if root != base:
            how = f"seen from a frame without a name, taken for '{base}'"
        return Seen(t, X, how + (f" by way of {', '.join(between)}" if between else ""))

    def between(self, base: str, frame: str, t: Array) -> Array:
        """X_BF (m, 4, 4) of a frame at times t (m,).

        Raises:
            LookupError: no chain of transforms leads from one to the other.
        """
        chain = self._chain(base, frame)
        if chain is None or chain[0] != base:
            raise LookupError(frame)
        return _along(chain[1], t)

    def _node(self, name: str) -> str | None:
        children = {child for pair in self.tracks for child in pair}
        for node in (self.topics.get(name, name), plain_frame(name)):
            if node in children:
                return node
        return None

    def _chain(self, base: str, node: str) -> tuple[str, list[_Link]] | None:
        """The shortest chain from the base, or from a frame without a name, if there is any.

        Returns:
            Where it begins, and its links.
        """
        beside: dict[str, list[tuple[str, Track, bool]]] = {}
        for (parent, child), track in self.tracks.items():
            beside.setdefault(parent, []).append((child, track, True))
            beside.setdefault(child, []).append((parent, track, False))
        before: dict[str, tuple[str, Track, bool] | None] = {base: None, "": None}
        waiting = deque(before)
        while waiting and node not in before:
            here = waiting.popleft()
            for there, track, forward in beside.get(here, []):
                if there not in before:
                    before[there] = (here, track, forward)
                    waiting.append(there)
        if node not in before:
            return None
        chain: list[_Link] = []
        at, step = node, before[node]
        while step is not None:
            chain.append((step[1], step[2], at))
            at, step = step[0], before[step[0]]
        return at, chain[::-1]

    def _no_chain(self, base: str, node: str, *, named: bool, file: Path | None) -> RecordingError:
        parents = {child: parent for parent, child in self.tracks}
        way = [node]
        while way[-1] in parents and parents[way[-1]] not in way:
            way.append(parents[way[-1]])
        frames = sorted({n for pair in self.tracks for n in pair if n and not n.startswith("/")})
        listed = ", ".join(frames[:_LISTED]) + (", ..." if len(frames) > _LISTED else "")
        seen = ", ".join(f"'{a}' is seen from '{b}'" for a, b in pairwise(way))
        if base in frames:
            top = base
            passed = {base}
            while top in parents and parents[top] not in passed:
                top = parents[top]
                passed.add(top)
            missing = f"nothing says where '{way[-1]}' is, seen from '{top}'"
            missing += f", which '{base}' hangs from" if top != base else ""
            remedy = "Record that transform, too (/tf and /tf_static)."
        else:
            missing = f"no frame of the bag is called '{base}'"
            remedy = (
                f"Say base_frame: {way[-1]} (or as the bag calls the robot's base) in "
                "recording.yaml."
            )
            if named:
                guess = nearest(base, frames)
                remedy = "That is what base_frame says in recording.yaml."
                remedy += f" Did you mean '{guess}'?" if guess else ""
        return RecordingError(
            f"no chain of transforms from the robot's base '{base}' to '{node}': "
            f"{seen + '; ' if seen else ''}{missing}",
            remedy=f"{remedy} Or say where the object was with --object. Frames: {listed}",
            file=file,
        )


def _along(links: Sequence[_Link], t: Array) -> Array:
    """Poses (m, 4, 4) at times t (m,) of what a chain leads to, seen from where it begins."""
    X = np.broadcast_to(np.eye(4), (len(t), 4, 4))
    for track, forward, _ in links:
        step = track.at(t)
        X = X @ (step if forward else inverse(step))
    return X
