"""The work area, and the task instances in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drake_screw.screws import inverse, pose, pose_from_planar
from drake_screw.tasks.object_area import ObjectArea
from drake_screw.typing import Array

AXES = ("x", "y", "yaw", "z", "roll", "pitch")
"""The coordinates of an object, in the order of the columns. A work area in which z, roll and pitch
of every object are fixed has the first three only."""

PLANAR = 3
"""Columns of such a work area."""

YAW, ROLL, PITCH = 2, 4, 5

ANGLES = ("yaw", "roll", "pitch")

Overlap = Callable[[Array], NDArray[np.bool_]]
"""X_WO (N, k, 4, 4) to (N,): whether two of the objects are in one another."""


FARTHEST = 1000.0
"""m or rad: no coordinate of an instance is greater, whatever its sign."""


@dataclass(frozen=True)
class WorkArea:
    """The box of object poses that a task must work in, one `ObjectArea` for each object.

    Coordinates of a task instance are (k, c): a row for each object, columns in the order of
    `axes`. They are the object's pose in the world, or in the frame of the object it stands on.

    Attributes:
        objects: the k objects.
        overlap: tells instances that are no instances, since objects overlap in them; None where
            all are.
    """

    objects: tuple[ObjectArea, ...]
    overlap: Overlap | None = None

    @cached_property
    def axes(self) -> tuple[str, ...]:
        """Names of the c columns: x, y, yaw, and where others vary of any object, all of AXES."""
        return AXES if any(o.beyond_planar for o in self.objects) else AXES[:PLANAR]

    @property
    def lower(self) -> Array:
        """(k, c) least coordinates of each object."""
        return self._ends[0][:, : len(self.axes)].copy()

    @property
    def upper(self) -> Array:
        """(k, c) greatest coordinates of each object."""
        return self._ends[1][:, : len(self.axes)].copy()

    @property
    def middle(self) -> Array:
        """(k, c) in the middle of the box; where objects must not overlap, they still may there."""
        return self.curved((self.flat(self.lower) + self.flat(self.upper)) / 2.0)

    @property
    def free(self) -> NDArray[np.bool_]:
        """(k, c) which coordinates may vary; a unit box over the area has an axis for each."""
        return self.upper > self.lower

    @property
    def columns(self) -> tuple[tuple[int, int], ...]:
        """Object and axis, by number, of what files have: x, y, yaw, and what else varies."""
        free = self.free
        free[:, :PLANAR] = True
        return tuple((int(i), int(j)) for i, j in np.argwhere(free))

    @property
    def z(self) -> Array:
        """(k,) m, height of each object's frame, the least where it varies."""
        return self._ends[0][:, PLANAR].copy()

    @cached_property
    def _ends(self) -> Array:
        """(2, k, 6) least and greatest coordinates, by all axes."""
        return np.array([[o.least for o in self.objects], [o.greatest for o in self.objects]])

    def flat(self, coordinates: ArrayLike) -> Array:
        """Coordinates in which instances are uniform in a box; (..., k, c) to (..., k, c).

        For an orientation that may be any the pitch's sine takes its place: in roll, pitch and yaw
        the uniform (Haar) measure of SO(3) is cos(pitch) d(roll) d(pitch) d(yaw) (Chirikjian,
        "Stochastic Models, Information Theory, and Lie Groups", vol. 2, 2012, section 10.6).
        All others are as they are.
        """
        flat = np.array(coordinates, dtype=float)
        if self._any.any():
            flat[..., self._any, PITCH] = np.sin(flat[..., self._any, PITCH])
        return flat

    def curved(self, flat: ArrayLike) -> Array:
        """The coordinates again, from those of `flat`; (..., k, c) to (..., k, c)."""
        coordinates = np.array(flat, dtype=float)
        if self._any.any():
            sine = np.clip(coordinates[..., self._any, PITCH], -1.0, 1.0)
            coordinates[..., self._any, PITCH] = np.arcsin(sine)
        return coordinates

    @cached_property
    def _any(self) -> NDArray[np.bool_]:
        return np.array([o.any_orientation for o in self.objects])

    def X_WO(self, coordinates: ArrayLike) -> Array:
        """Object poses of task instances.

        Args:
            coordinates: (..., k, c) m and rad.

        Returns:
            (..., k, 4, 4).

        >>> area = WorkArea((ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), z=-0.1),))
        >>> area.X_WO([[0.9, 0.3, 0.0]])[0, :3, 3].tolist()
        [0.9, 0.3, -0.1]
        """
        whole = self._whole(coordinates)
        X = pose_from_planar(whole[..., :PLANAR], whole[..., PLANAR])
        for i in np.flatnonzero(self._tilts).tolist():
            from scipy.spatial.transform import Rotation  # takes long to import

            R = Rotation.from_euler("ZYX", whole[..., i, [YAW, PITCH, ROLL]].reshape(-1, 3))
            X[..., i, :3, :3] = R.as_matrix().reshape(*X.shape[:-3], 3, 3)
        for i, parent in self._standing:
            X[..., i, :, :] = X[..., parent, :, :] @ X[..., i, :, :]
        return X

    @cached_property
    def _tilts(self) -> NDArray[np.bool_]:
        return (self._ends[:, :, ROLL:] != 0.0).any(axis=(0, 2))

    @cached_property
    def _standing(self) -> tuple[tuple[int, int], ...]:
        """Objects and what they stand on, from the bottom up."""
        names = [o.name for o in self.objects]
        parent = {i: names.index(o.on) for i, o in enumerate(self.objects) if o.on is not None}

        def depth(i: int) -> int:
            return 1 + depth(parent[i]) if i in parent else 0

        return tuple((i, parent[i]) for i in sorted(parent, key=depth))

    @property
    def related(self) -> frozenset[tuple[int, int]]:
        """Pairs of objects one of which stands on the other, or on what stands on it."""
        above = dict(self._standing)
        found = set()
        for i, parent in self._standing:
            below: int | None = parent
            while below is not None:
                found.add((min(i, below), max(i, below)))
                below = above.get(below)
        return frozenset(found)

    def settled(self, i: int) -> bool:
        """Whether object i has one pose in the world: it does not vary, nor what it stands on."""
        above = dict(self._standing)
        return not self.objects[i].varies and (i not in above or self.settled(above[i]))

    def _whole(self, coordinates: ArrayLike) -> Array:
        """(..., k, 6): with what is fixed of all objects."""
        given = np.asarray(coordinates, dtype=float)
        if given.shape[-1] == len(AXES):
            return given
        fixed = np.broadcast_to(self._ends[0][:, PLANAR:], (*given.shape[:-1], PLANAR))
        return np.concatenate([given, fixed], axis=-1)

    def coordinates(self, X_WO: ArrayLike) -> Array:
        """The coordinates that `X_WO` of this area takes; (..., k, 4, 4) to (..., k, c).

        Of yaws, and of rolls, that differ by whole turns it is the one nearest to the middle of the
        area. Where z, roll and pitch are fixed, they are passed over.
        """
        X_WO = np.asarray(X_WO, dtype=float)
        X = X_WO.copy()
        for i, parent in self._standing:
            X[..., i, :, :] = inverse(X_WO[..., parent, :, :]) @ X_WO[..., i, :, :]
        columns = [X[..., 0, 3], X[..., 1, 3], self._unwound(YAW, _yaw(X))]
        if len(self.axes) > PLANAR:
            R = X[..., :3, :3]
            roll = np.arctan2(R[..., 2, 1], R[..., 2, 2])
            pitch = np.arctan2(-R[..., 2, 0], np.hypot(R[..., 0, 0], R[..., 1, 0]))
            columns += [X[..., 2, 3], self._unwound(ROLL, roll), pitch]
        return np.stack(columns, axis=-1)

    def _unwound(self, axis: int, angle: Array) -> Array:
        middle = self._ends[:, :, axis].sum(axis=0) / 2.0
        unwound: Array = angle - 2.0 * np.pi * np.round((angle - middle) / (2.0 * np.pi))
        return unwound

    def X_WP(self, i: int) -> Array:
        """(4, 4) the frame that an object's coordinates are seen from.

        That of another object is where it is in the middle of the area.
        """
        parent = dict(self._standing).get(i)
        if parent is None:
            return pose(np.eye(3), np.zeros(3))
        X: Array = self.X_WO(self.middle)[parent]
        return X

    def complete(self, instances: ArrayLike) -> Array:
        """Task instances with all their coordinates.

        Args:
            instances: (N, k, c) in m and rad, or the first two, x and y, or three, x, y and yaw,
                where the area fixes the others; the axis k may be left out for a single object.

        Returns:
            (N, k, c).

        Raises:
            ValueError: another shape, a number beyond `FARTHEST`, or nothing is given of an axis
                that varies.

        >>> area = WorkArea((ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), z=-0.1),))
        >>> area.complete([[0.9, 0.3], [1.0, 0.4]]).tolist()
        [[[0.9, 0.3, 0.0]], [[1.0, 0.4, 0.0]]]
        """
        given = np.asarray(instances, dtype=float)
        k, c = len(self.objects), len(self.axes)
        if k == 1 and given.ndim == 2:
            given = given[:, None]
        if given.ndim != 3 or given.shape[1] != k or given.shape[2] not in (2, PLANAR, c):
            raise ValueError(f"instances have shape {np.shape(instances)}, expected (N, {k}, {c})")
        if not (np.abs(given) <= FARTHEST).all():
            raise ValueError(f"instances must be numbers from -{FARTHEST:g} to {FARTHEST:g}")
        for i, j in np.argwhere(self.free):
            if j >= given.shape[2]:
                name = self.objects[i].name
                raise ValueError(f"the {self.axes[j]} of '{name}' varies, and is missing")
        whole = np.tile(self.lower, (len(given), 1, 1))
        whole[..., : given.shape[2]] = given
        return whole

    def contains(self, coordinates: ArrayLike, *, tolerance: float = 1e-9) -> Array:
        """Whether each instance lies in the area; (..., k, c) to (...) bool."""
        given = np.asarray(coordinates, dtype=float)
        inside = (given >= self.lower - tolerance) & (given <= self.upper + tolerance)
        return np.asarray(np.all(inside, axis=(-2, -1)) & ~self.overlaps(given))

    def overlaps(self, coordinates: ArrayLike) -> NDArray[np.bool_]:
        """Whether objects overlap that must not; (..., k, c) to (...) bool."""
        given = np.asarray(coordinates, dtype=float)
        if self.overlap is None:
            return np.zeros(given.shape[:-2], dtype=bool)
        X_WO = self.X_WO(given)
        found = self.overlap(X_WO.reshape(-1, *X_WO.shape[-3:]))
        return np.asarray(found, dtype=bool).reshape(given.shape[:-2])

    def away(self, here: ArrayLike, there: ArrayLike) -> Array:
        """How far the objects of instances are from those of others, added up.

        Args:
            here, there: (..., k, c), broadcast together.

        Returns:
            (...) m, along x and y, and z where it is a coordinate; turns do not count.
        """
        metric = [axis in ("x", "y", "z") for axis in self.axes]
        apart = (np.asarray(here, dtype=float) - np.asarray(there, dtype=float))[..., metric]
        return np.asarray(np.linalg.norm(apart, axis=-1).sum(axis=-1))

    def words(self, i: int, coordinates: ArrayLike, *, turned: bool = False) -> str:
        """Where object i of an instance (k, c) is: x, y, and what else varies.

        Args:
            i: which object.
            coordinates: of the instance.
            turned: whether a fixed yaw is told, too, unless it is 0.
        """
        row = np.asarray(coordinates, dtype=float)[i]
        told = [
            f"{axis} {value:.2f} rad" if axis in ANGLES else f"{axis} {value:.3f} m"
            for j, (axis, value) in enumerate(zip(self.axes, row.tolist(), strict=True))
            if axis in ("x", "y") or self.free[i, j] or (turned and axis == "yaw" and value)
        ]
        return ", ".join(told)

    def apart(self, overlap: Overlap) -> WorkArea:
        """The same, without the instances in which objects overlap."""
        return replace(self, overlap=overlap)


def _yaw(X: Array) -> Array:
    return np.asarray(np.arctan2(X[..., 1, 0], X[..., 0, 0]))
