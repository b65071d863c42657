"""Where the shapes of an arm are at a configuration, and how far they may be nearby."""

from __future__ import annotations

import math

from numba import uintp

from drake_screw.planning.compiled.functions import COS, SIN
from drake_screw.planning.compiled.inner import inlined

PI = math.pi


@inlined
def place_arm(cell, room):  # type: ignore[no-untyped-def]
    """Joint frames and axes at `room.q`: E_k = exp(S_1 q_1) ... exp(S_k q_k).

    For a unit twist S = [w; v] and an angle q, exp(S q) turns by R = I + sin q [w] +
    (1 - cos q) [w]^2 and shifts by (I q + (1 - cos q) [w] + (q - sin q) [w]^2) v (Lynch and Park,
    Modern Robotics, eq. 3.88); a prismatic joint, w = 0, shifts by q v.
    """
    room.clock[0] += 1
    E, axes = room.E, room.axes
    for k in range(len(room.q)):
        # Of the angle's half within a quarter turn of a whole number of half turns.
        half = 0.5 * room.q[k]
        half -= PI * math.floor(half * (1.0 / PI) + 0.5)
        square = half * half
        sine, cosine = SIN[6], COS[7]
        for i in range(5, -1, -1):
            sine = sine * square + SIN[i]
        for i in range(6, -1, -1):
            cosine = cosine * square + COS[i]
        sine *= half
        room.sines[k], room.cosines[k] = 2.0 * sine * cosine, 1.0 - 2.0 * sine * sine
    for k in range(len(room.q)):
        x, y, z = cell.screws[k, 0], cell.screws[k, 1], cell.screws[k, 2]
        a, b, c = cell.screws[k, 3], cell.screws[k, 4], cell.screws[k, 5]
        q = room.q[k]
        if x * x + y * y + z * z < 0.5:
            for i in range(3):
                for j in range(3):
                    E[k + 1, i, j] = E[k, i, j]
                axes[k, i] = 0.0
                axes[k, 3 + i] = E[k, i, 0] * a + E[k, i, 1] * b + E[k, i, 2] * c
                E[k + 1, i, 3] = E[k, i, 3] + axes[k, 3 + i] * q
            continue
        s, o = room.sines[k], 1.0 - room.cosines[k]
        # w x v, and w x (w x v) = w (w . v) - v
        d, e, f = y * c - z * b, z * a - x * c, x * b - y * a
        pitch = x * a + y * b + z * c
        t = q - s
        px = a * q + o * d + t * (x * pitch - a)
        py = b * q + o * e + t * (y * pitch - b)
        pz = c * q + o * f + t * (z * pitch - c)
        r00, r01, r02 = 1.0 - o * (y * y + z * z), o * x * y - s * z, o * x * z + s * y
        r10, r11, r12 = o * x * y + s * z, 1.0 - o * (x * x + z * z), o * y * z - s * x
        r20, r21, r22 = o * x * z - s * y, o * y * z + s * x, 1.0 - o * (x * x + y * y)
        for i in range(3):
            l, m, n = E[k, i, 0], E[k, i, 1], E[k, i, 2]
            E[k + 1, i, 0] = l * r00 + m * r10 + n * r20
            E[k + 1, i, 1] = l * r01 + m * r11 + n * r21
            E[k + 1, i, 2] = l * r02 + m * r12 + n * r22
            E[k + 1, i, 3] = l * px + m * py + n * pz + E[k, i, 3]
            axes[k, i] = l * x + m * y + n * z
            axes[k, 3 + i] = l * a + m * b + n * c
        u, v, w = axes[k, 0], axes[k, 1], axes[k, 2]
        axes[k, 3] += E[k, 1, 3] * w - E[k, 2, 3] * v
        axes[k, 4] += E[k, 2, 3] * u - E[k, 0, 3] * w
        axes[k, 5] += E[k, 0, 3] * v - E[k, 1, 3] * u


@inlined
def place_balls(cell, room):  # type: ignore[no-untyped-def]
    """Where the balls around the arm's shapes are at `room.q`, and how far they may be nearby.

    Let joints move one after the other from the base on. A joint's turn by dq takes a point along
    an arc, at most |dq| times its distance from the axis; and that distance is what it was at q,
    for whatever moved before has moved point and axis alike. So no point of a shape is farther
    from where it was than the sum over the joints (as Schwarzer, Saha and Latombe bound it,
    "Adaptive dynamic collision checking for single and multiple articulated robots in complex
    environments", 2005). Seen from a link on the way the joints before it do not count.
    """
    E, p, way, travel = room.E, room.centers, room.way, room.travel
    M = uintp(p.shape[1])
    for m in range(M):
        last = uintp(cell.moved_joint[m] + 1)
        x, y, z = cell.centers[0, m], cell.centers[1, m], cell.centers[2, m]
        for i in range(3):
            p[i, m] = E[last, i, 0] * x + E[last, i, 1] * y + E[last, i, 2] * z + E[last, i, 3]
        way[m] = 0.0
    for k in range(len(room.q) - 1, -1, -1):
        u, v, w = room.axes[k, 0], room.axes[k, 1], room.axes[k, 2]
        a, b, c = room.axes[k, 3], room.axes[k, 4], room.axes[k, 5]
        turns = 1.0 if u * u + v * v + w * w > 0.5 else 0.0
        dq, row = room.dq[k], uintp(k) * M
        for m in range(uintp(cell.begin[k]), M):
            x, y, z = p[0, m], p[1, m], p[2, m]
            d = a + v * z - w * y
            e = b + w * x - u * z
            f = c + u * y - v * x
            way[m] += dq * (math.sqrt(d * d + e * e + f * f) + turns * cell.moved_reach[m])
            travel[row + m] = way[m]


@inlined
def place_shape(cell, room, s):  # type: ignore[no-untyped-def]
    """Pose of a shape of the arm at `room.q`, if it is not known already."""
    if room.stamp[s] == room.clock[0]:
        return
    room.stamp[s] = room.clock[0]
    last = uintp(cell.joint[s] + 1)
    E, G, X = room.E, cell.X_WG, room.X_WG
    for i in range(3):
        l, m, n = E[last, i, 0], E[last, i, 1], E[last, i, 2]
        for j in range(4):
            X[s, i, j] = l * G[s, 0, j] + m * G[s, 1, j] + n * G[s, 2, j]
        X[s, i, 3] += E[last, i, 3]


@inlined
def place_object_shapes(cell, room, X_WO):  # type: ignore[no-untyped-def]
    """Poses of the objects' shapes; X_WO (k, 4, 4)."""
    G, X = cell.X_WG, room.X_WG
    for s in range(len(cell.joint)):
        o = cell.object[s]
        if o < 0:
            continue
        for i in range(3):
            for j in range(4):
                value = X_WO[o, i, 3] if j == 3 else 0.0
                for a in range(3):
                    value += X_WO[o, i, a] * G[s, a, j]
                X[s, i, j] = value
