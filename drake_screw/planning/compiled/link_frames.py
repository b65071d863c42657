"""Frames on the axes of a serial arm that make its kinematics cheap to evaluate.

On every joint axis sits an origin o_i, and two frames with their z axes along the joint axis: P_i
on the parent link and C_i on the child link. They coincide but for a turn about z (revolute joint,
by q_i plus a constant) or a shift along z (prismatic joint, by q_i, and a constant turn). The
x axes of C_{i-1} and P_i both point along the common normal of axes i-1 and i, so that the constant
step between these frames turns about x alone, as in the convention of Denavit and Hartenberg
(1955). Unlike theirs, the origins need not be the feet of the common normals, which run away as
axes get parallel: counted from the middle link to both sides, o_i is the point of its axis nearest
to its neighbour's origin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drake_screw.screws import adjoint, exp

SNAP = 1e-13
"""Constants this close to 0, 1 or -1 are taken to be just that (radians, metres)."""


@dataclass(frozen=True)
class LinkFrames:
    """Constants of an arm in link frames. M, the frame of the middle link, is P_m.

    Attributes:
        revolute: (n,) whether each joint turns; the others slide.
        turn: (n,) angle in rad from P_i to C_i about z at q_i = 0.
        tilt: (n-1, 2) cos and sin of the angle from C_i to P_{i+1} about their common x axis.
        shift: (n-1, 3) o_{i+1} - o_i in m, in C_i if i < m, else in P_{i+1}.
        middle: m, the joint whose parent side is the middle link.
        X_WB: (4, 4) pose of the base frame B = P_0 in the world.
        X_CE: (4, 4) pose of the end effector E in the last child frame C_{n-1}.
        redundant: some joints only repeat what others do, wherever the arm is.
    """

    revolute: NDArray[np.bool_]
    turn: NDArray[np.float64]
    tilt: NDArray[np.float64]
    shift: NDArray[np.float64]
    middle: int
    X_WB: NDArray[np.float64]
    X_CE: NDArray[np.float64]
    redundant: bool


def link_frames(screws: NDArray[np.float64], home: NDArray[np.float64]) -> LinkFrames:
    """The link frames of a chain given as a product of exponentials.

    Args:
        screws: (n, 6) unit screws [w; v] of the joints in W at q = 0, revolute (|w| = 1, no pitch)
            or prismatic (w = 0, |v| = 1).
        home: (4, 4) pose X_WE at q = 0.
    """
    w, v = screws[:, :3], screws[:, 3:]
    n = len(screws)
    middle = n // 2
    revolute = np.linalg.norm(w, axis=1) > 0.5
    z = np.where(revolute[:, None], w, v)
    z = z / np.linalg.norm(z, axis=1, keepdims=True)
    origin = _origins(z, np.cross(w, v), revolute, middle)
    x_parent = np.array([_normal(z[max(i - 1, 0)], z[i]) for i in range(n)])
    x_child = np.vstack([x_parent[1:], _normal(z[-1], home[:3, 2])])
    x_parent[0] = x_child[0]
    turn = np.arctan2(np.vecdot(np.cross(x_parent, x_child), z), np.vecdot(x_parent, x_child))
    tilt = np.stack(
        [np.vecdot(z[:-1], z[1:]), np.vecdot(np.cross(z[:-1], z[1:]), x_child[:-1])], axis=-1
    )
    shift = np.empty((n - 1, 3))
    for i in range(n - 1):
        R_WF = _frame(x_child[i], z[i]) if i < middle else _frame(x_parent[i + 1], z[i + 1])
        shift[i] = R_WF.T @ (origin[i + 1] - origin[i])
    X_WB, X_WC = np.eye(4), np.eye(4)
    X_WB[:3, :3], X_WB[:3, 3] = _frame(x_parent[0], z[0]), origin[0]
    X_WC[:3, :3], X_WC[:3, 3] = _frame(x_child[-1], z[-1]), origin[-1]
    return LinkFrames(
        revolute,
        _snap(turn),
        _snap(tilt),
        _snap(shift),
        middle,
        X_WB,
        np.linalg.inv(X_WC) @ home,
        _redundant(screws),
    )


def _redundant(screws: NDArray[np.float64]) -> bool:
    """Whether the Jacobian lacks rank at each of a few random configurations."""
    for q in np.random.default_rng(0).uniform(-1.0, 1.0, (4, len(screws))):
        X, columns = np.eye(4), []
        for S, angle in zip(screws, q, strict=True):
            columns.append(adjoint(X) @ S)
            X = X @ exp(S * angle)
        if np.linalg.matrix_rank(np.array(columns), tol=1e-9) == min(6, len(screws)):
            return False
    return True


def _origins(
    z: NDArray[np.float64], point: NDArray[np.float64], revolute: NDArray[np.bool_], middle: int
) -> NDArray[np.float64]:
    """A point on each axis; a prismatic joint, which has none of its own, takes its neighbour's."""
    origin = point.copy()
    outward = [(i, i - 1) for i in range(middle + 1, len(z))]
    inward = [(i, i + 1) for i in range(middle - 1, -1, -1)]
    if middle:
        origin[middle] = _nearest_to_line(point, z, middle, middle - 1, revolute)
    for i, neighbour in outward + inward:
        away = origin[neighbour] - point[i]
        origin[i] = point[i] + z[i] * (z[i] @ away) if revolute[i] else origin[neighbour]
    return origin


def _nearest_to_line(
    point: NDArray[np.float64], z: NDArray[np.float64], i: int, j: int, revolute: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """The point of axis i nearest to axis j, or to W's origin where they are near parallel."""
    sine2 = 1.0 - (z[i] @ z[j]) ** 2
    if not (revolute[i] and revolute[j]) or sine2 < 0.01:
        return point[i]
    away = point[j] - point[i]
    return point[i] + z[i] * (away @ (z[i] - (z[i] @ z[j]) * z[j]) / sine2)


def _normal(z1: NDArray[np.float64], z2: NDArray[np.float64]) -> NDArray[np.float64]:
    """A unit vector at right angles to both."""
    normal = np.cross(z1, z2)
    if np.linalg.norm(normal) < SNAP:
        normal = np.cross(z1, np.eye(3)[np.argmin(np.abs(z1))])
    return normal / np.linalg.norm(normal)


def _frame(x: NDArray[np.float64], z: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.stack([x, np.cross(z, x), z], axis=-1)


def _snap(values: NDArray[np.float64]) -> NDArray[np.float64]:
    rounded = np.round(values)
    near = (np.abs(values - rounded) < SNAP) & (np.abs(rounded) <= 1.0)
    return np.where(near, rounded, values)
