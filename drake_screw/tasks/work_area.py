"""The work area, and the task instances in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.screws import pose_from_planar
from drake_screw.typing import Array

AXES = ("x", "y", "yaw")


@dataclass(frozen=True)
class ObjectArea:
    """Where one object may stand.

    Attributes:
        name: of the object.
        lower, upper: x, y in m and yaw in rad; equal where the coordinate is fixed.
        z: m, height of the object's frame.
    """

    name: str
    lower: tuple[float, float, float]
    upper: tuple[float, float, float]
    z: float


@dataclass(frozen=True)
class WorkArea:
    """The box of object poses that a task must work in, one `ObjectArea` for each object."""

    objects: tuple[ObjectArea, ...]

    @property
    def lower(self) -> Array:
        """(k, 3) least x, y, yaw of each object."""
        return np.array([o.lower for o in self.objects])

    @property
    def upper(self) -> Array:
        """(k, 3) greatest x, y, yaw of each object."""
        return np.array([o.upper for o in self.objects])

    @property
    def z(self) -> Array:
        """(k,) m, height of each object's frame."""
        return np.array([o.z for o in self.objects])

    def X_WO(self, x_y_yaw: ArrayLike) -> Array:
        """Object poses of task instances.

        Args:
            x_y_yaw: (..., k, 3) m, m, rad.

        Returns:
            (..., k, 4, 4).

        >>> area = WorkArea((ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), z=-0.1),))
        >>> area.X_WO([[0.9, 0.3, 0.0]])[0, :3, 3].tolist()
        [0.9, 0.3, -0.1]
        """
        return pose_from_planar(x_y_yaw, self.z)

    def x_y_yaw(self, X_WO: ArrayLike) -> Array:
        """The coordinates that `X_WO` of this area takes; (..., k, 4, 4) to (..., k, 3).

        Of yaws that differ by whole turns it is the one nearest to the middle of the area.
        """
        X_WO = np.asarray(X_WO, dtype=float)
        yaw = np.arctan2(X_WO[..., 1, 0], X_WO[..., 0, 0])
        middle = (self.lower[:, 2] + self.upper[:, 2]) / 2.0
        yaw = yaw - 2.0 * np.pi * np.round((yaw - middle) / (2.0 * np.pi))
        return np.stack([X_WO[..., 0, 3], X_WO[..., 1, 3], yaw], axis=-1)

    @property
    def turning(self) -> tuple[str, ...]:
        """Names of the objects whose yaw varies."""
        return tuple(o.name for o in self.objects if o.lower[2] < o.upper[2])

    def complete(self, instances: ArrayLike) -> Array:
        """Task instances with all their coordinates.

        Args:
            instances: (N, k, 3) x, y in m and yaw in rad, or (N, k, 2) without yaw where the area
                fixes it; the axis k may be left out for a single object.

        Returns:
            (N, k, 3).

        Raises:
            ValueError: another shape, a number that is not finite, or no yaw where it varies.

        >>> area = WorkArea((ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), z=-0.1),))
        >>> area.complete([[0.9, 0.3], [1.0, 0.4]]).tolist()
        [[[0.9, 0.3, 0.0]], [[1.0, 0.4, 0.0]]]
        """
        given = np.asarray(instances, dtype=float)
        k = len(self.objects)
        if k == 1 and given.ndim == 2:
            given = given[:, None]
        if given.ndim != 3 or given.shape[1] != k or given.shape[2] not in (2, 3):
            raise ValueError(f"instances have shape {np.shape(instances)}, expected (N, {k}, 3)")
        if not np.isfinite(given).all():
            raise ValueError("instances must be finite numbers")
        if given.shape[2] == 2 and self.turning:
            raise ValueError(f"the yaw of '{self.turning[0]}' varies, and is missing")
        x_y_yaw = np.tile(self.lower, (len(given), 1, 1))
        x_y_yaw[..., : given.shape[2]] = given
        return x_y_yaw

    def contains(self, x_y_yaw: ArrayLike, *, tolerance: float = 1e-9) -> Array:
        """Whether each instance lies in the area; (..., k, 3) to (...) bool."""
        x_y_yaw = np.asarray(x_y_yaw, dtype=float)
        inside = (x_y_yaw >= self.lower - tolerance) & (x_y_yaw <= self.upper + tolerance)
        return np.all(inside, axis=(-2, -1))
