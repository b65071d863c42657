"""The batch planner's compiled kernel: the joint path, instance by instance.

dq/ds = J(q)^+ V is integrated by the Dormand-Prince 5(4) pair (Dormand and Prince, 1980) with steps
that follow its error estimate; limits are watched between steps on its fourth-order interpolant.
"""

from __future__ import annotations

import numba as nb
import numpy as np
from scipy.integrate import RK45

from drake_screw.planning.contract import (
    LENGTH,
    POSITION_TOLERANCE,
    ROTATION_TOLERANCE,
)
from drake_screw.planning.outcomes import Cause

SUCCESS, JOINT_LIMIT = int(Cause.SUCCESS), int(Cause.JOINT_LIMIT)
UNREACHABLE, NOT_TRIED = int(Cause.UNREACHABLE), int(Cause.NOT_TRIED)

_A = np.zeros((7, 6))
_A[:6, :5], _A[6] = RK45.A, RK45.B
_E, _P = np.asarray(RK45.E), np.asarray(RK45.P)
_SAMPLES = 8
_MIN_STEP = 1e-5
_MAX_MOTION = 0.5


@nb.njit(cache=True, error_model="numpy")
def _joint_transform(S, angle, T):
    """T <- T exp(S angle), for a joint's unit screw S; T is 3x4."""
    wx, wy, wz = S[0] * angle, S[1] * angle, S[2] * angle
    vx, vy, vz = S[3] * angle, S[4] * angle, S[5] * angle
    revolute = S[0] * S[0] + S[1] * S[1] + S[2] * S[2] > 0.5
    a, b, c = 1.0, 0.5, 1.0 / 6.0
    if revolute and abs(angle) > 1e-4:
        a = np.sin(angle) / angle
        b = (1.0 - np.cos(angle)) / (angle * angle)
        c = (1.0 - a) / (angle * angle)
    t2 = angle * angle if revolute else 0.0
    R = (
        (1.0 - b * (t2 - wx * wx), b * wx * wy - a * wz, b * wx * wz + a * wy),
        (b * wx * wy + a * wz, 1.0 - b * (t2 - wy * wy), b * wy * wz - a * wx),
        (b * wx * wz - a * wy, b * wy * wz + a * wx, 1.0 - b * (t2 - wz * wz)),
    )
    cx, cy, cz = wy * vz - wz * vy, wz * vx - wx * vz, wx * vy - wy * vx
    dx, dy, dz = wy * cz - wz * cy, wz * cx - wx * cz, wx * cy - wy * cx
    p = (vx + b * cx + c * dx, vy + b * cy + c * dy, vz + b * cz + c * dz)
    for i in range(3):
        t0, t1, t2_ = T[i, 0], T[i, 1], T[i, 2]
        for j in range(3):
            T[i, j] = t0 * R[0][j] + t1 * R[1][j] + t2_ * R[2][j]
        T[i, 3] += t0 * p[0] + t1 * p[1] + t2_ * p[2]


@nb.njit(cache=True, error_model="numpy")
def hand_pose(screws, home, q, X):
    """X (3x4) <- X_WE(q)."""
    T = np.zeros((3, 4))
    for i in range(3):
        T[i, i] = 1.0
    for j in range(len(q)):
        _joint_transform(screws[j], q[j], T)
    for i in range(3):
        for k in range(4):
            X[i, k] = T[i, 0] * home[0, k] + T[i, 1] * home[1, k] + T[i, 2] * home[2, k]
        X[i, 3] += T[i, 3]


@nb.njit(cache=True, error_model="numpy")
def joint_rates(screws, q, V, J, M, rate):
    """rate <- J(q)^+ V by the normal equations; False where they are singular.

    J (6, n), M (6, 6) are scratch. With fewer than six joints it is the least-squares rate.
    """
    n = len(q)
    T = np.zeros((3, 4))
    for i in range(3):
        T[i, i] = 1.0
    for j in range(n):
        S = screws[j]
        for i in range(3):
            J[i, j] = T[i, 0] * S[0] + T[i, 1] * S[1] + T[i, 2] * S[2]
            J[3 + i, j] = T[i, 0] * S[3] + T[i, 1] * S[4] + T[i, 2] * S[5]
        J[3, j] += T[1, 3] * J[2, j] - T[2, 3] * J[1, j]
        J[4, j] += T[2, 3] * J[0, j] - T[0, 3] * J[2, j]
        J[5, j] += T[0, 3] * J[1, j] - T[1, 3] * J[0, j]
        _joint_transform(S, q[j], T)
    wide = n >= 6
    m = 6 if wide else n
    y = np.empty(m)
    for i in range(m):
        for k in range(i + 1):
            total = 0.0
            if wide:
                for j in range(n):
                    total += J[i, j] * J[k, j]
            else:
                for j in range(6):
                    total += J[j, i] * J[j, k]
            M[i, k] = total
        if wide:
            y[i] = V[i]
        else:
            y[i] = 0.0
            for j in range(6):
                y[i] += J[j, i] * V[j]
    for i in range(m):
        for k in range(i + 1):
            total = M[i, k]
            for j in range(k):
                total -= M[i, j] * M[k, j]
            if i > k:
                M[i, k] = total / M[k, k]
            elif total <= 1e-14:
                return False
            else:
                M[i, i] = np.sqrt(total)
    for i in range(m):
        for k in range(i):
            y[i] -= M[i, k] * y[k]
        y[i] /= M[i, i]
    for i in range(m - 1, -1, -1):
        for k in range(i + 1, m):
            y[i] -= M[k, i] * y[k]
        y[i] /= M[i, i]
    for j in range(n):
        if wide:
            rate[j] = 0.0
            for i in range(6):
                rate[j] += J[i, j] * y[i]
        else:
            rate[j] = y[j]
    return True


@nb.njit(cache=True, error_model="numpy")
def twist_to(X, G, V):
    """V <- log(G X^-1), about W's origin, for 3x4 poses; the short way round.

    Returns the rotation angle and the speed of the hand's origin, both over unit time.
    """
    R = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            R[i, j] = G[i, 0] * X[j, 0] + G[i, 1] * X[j, 1] + G[i, 2] * X[j, 2]
    tr = R[0, 0] + R[1, 1] + R[2, 2]
    w, x, y, z = 1.0, 0.0, 0.0, 0.0
    if tr > 0.0:
        w = 1.0 + tr
        x, y, z = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    elif R[0, 0] >= R[1, 1] and R[0, 0] >= R[2, 2]:
        x = 1.0 + 2.0 * R[0, 0] - tr
        w, y, z = R[2, 1] - R[1, 2], R[0, 1] + R[1, 0], R[0, 2] + R[2, 0]
    elif R[1, 1] >= R[2, 2]:
        y = 1.0 + 2.0 * R[1, 1] - tr
        w, x, z = R[0, 2] - R[2, 0], R[0, 1] + R[1, 0], R[1, 2] + R[2, 1]
    else:
        z = 1.0 + 2.0 * R[2, 2] - tr
        w, x, y = R[1, 0] - R[0, 1], R[0, 2] + R[2, 0], R[1, 2] + R[2, 1]
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    size = np.sqrt(x * x + y * y + z * z)
    angle = 2.0 * np.arctan2(size, w)
    scale = angle / size if size > 0.0 else 0.0
    wx, wy, wz = scale * x, scale * y, scale * z
    # as seen from the hand: the same rotation, and the way its origin has to go
    dx, dy, dz = G[0, 3] - X[0, 3], G[1, 3] - X[1, 3], G[2, 3] - X[2, 3]
    half = angle / 2.0
    c = 1.0 / 12.0
    if angle > 0.05:
        c = (1.0 - half / np.tan(half)) / (angle * angle)
    else:
        c += angle * angle / 720.0
    cx, cy, cz = wy * dz - wz * dy, wz * dx - wx * dz, wx * dy - wy * dx
    vx = dx - 0.5 * cx + c * (wy * cz - wz * cy)
    vy = dy - 0.5 * cy + c * (wz * cx - wx * cz)
    vz = dz - 0.5 * cz + c * (wx * cy - wy * cx)
    V[0], V[1], V[2] = wx, wy, wz
    V[3] = vx - (wy * X[2, 3] - wz * X[1, 3])
    V[4] = vy - (wz * X[0, 3] - wx * X[2, 3])
    V[5] = vz - (wx * X[1, 3] - wy * X[0, 3])
    return angle, np.sqrt(vx * vx + vy * vy + vz * vz)


@nb.njit(cache=True, error_model="numpy")
def _first_crossing(q, h, K, moved, lower, upper):
    """First joint to reach a limit inside a step, and when; joint -1 if none does.

    Joints that the step's rates cannot carry to a limit are passed over.
    """
    first, joint = 2.0, -1
    for j in range(len(q)):
        fastest = max(abs(K[0, j]), abs(K[6, j]))
        room = min(min(q[j], moved[j]) - lower[j], upper[j] - max(q[j], moved[j]))
        if room > h * fastest:
            continue
        before = min(q[j] - lower[j], upper[j] - q[j])
        for i in range(1, _SAMPLES + 1):
            x = i / _SAMPLES
            value = 0.0
            for r in range(7):
                value += K[r, j] * (_P[r, 0] + x * (_P[r, 1] + x * (_P[r, 2] + x * _P[r, 3])))
            value = q[j] + h * x * value if i < _SAMPLES else moved[j]
            after = min(value - lower[j], upper[j] - value)
            if after <= 0.0:
                when = x - after / (after - before) / _SAMPLES if before > 0.0 else 0.0
                if when < first:
                    first, joint = when, j
                break
            before = after
    return joint, min(max(first, 0.0), 1.0)


@nb.njit(cache=True, error_model="numpy")
def plan(screws, home, lower, upper, guides, q_start, tolerance, rate_limit):
    """One plan. Returns cause, segment, joint, fraction and the number of evaluations of J^+ V."""
    n = len(q_start)
    q, moved, trial = q_start.copy(), np.empty(n), np.empty(n)
    K, J, M = np.empty((7, n)), np.empty((6, n)), np.empty((6, 6))
    X, V = np.empty((3, 4)), np.empty(6)
    evaluations = 0
    h = 0.1
    for segment in range(len(guides)):
        G = guides[segment]
        hand_pose(screws, home, q, X)
        angle, travel = twist_to(X, G, V)
        size = np.sqrt(angle * angle + (travel / LENGTH) ** 2)
        s = 0.0
        h = min(1.0, 0.2 / max(size, 1e-9)) if segment == 0 else min(1.0, 0.3 / max(size, 1e-9))
        fresh = True
        while s < 1.0:
            h = min(h, 1.0 - s)
            if fresh:
                evaluations += 1
                if not joint_rates(screws, q, V, J, M, K[0]):
                    return UNREACHABLE, segment, -1, s, evaluations
                fastest = 0.0
                for j in range(n):
                    fastest += K[0, j] * K[0, j]
                if np.sqrt(fastest) > rate_limit * size:
                    return UNREACHABLE, segment, -1, s, evaluations
            fresh = False
            fine = True
            for r in range(1, 7):
                for j in range(n):
                    total = 0.0
                    for k in range(r):
                        total += _A[r, k] * K[k, j]
                    trial[j] = q[j] + h * total
                evaluations += 1
                if not joint_rates(screws, trial, V, J, M, K[r]):
                    fine = False
                    break
            error, motion = 0.0, 0.0
            if fine:
                for j in range(n):
                    moved[j] = trial[j]
                    total = 0.0
                    for r in range(7):
                        total += _E[r] * K[r, j]
                    error = max(error, abs(h * total))
                    motion = max(motion, abs(moved[j] - q[j]))
            if not fine or not error <= tolerance or motion > _MAX_MOTION:
                shrink = 0.2
                if fine and error < np.inf and error > tolerance:
                    shrink = max(0.2, 0.9 * (tolerance / error) ** 0.2)
                elif fine and motion > _MAX_MOTION:
                    shrink = max(0.2, 0.9 * _MAX_MOTION / motion)
                h *= shrink
                if h < _MIN_STEP:
                    return UNREACHABLE, segment, -1, s, evaluations
                continue
            joint, when = _first_crossing(q, h, K, moved, lower, upper)
            if joint >= 0:
                return JOINT_LIMIT, segment, joint, s + when * h, evaluations
            s = 1.0 if s + h > 1.0 - 1e-12 else s + h
            fastest = 0.0
            for j in range(n):
                q[j] = moved[j]
                K[0, j] = K[6, j]
                fastest += K[0, j] * K[0, j]
            if np.sqrt(fastest) > rate_limit * size:
                return UNREACHABLE, segment, -1, s, evaluations
            h *= min(5.0, 0.9 * (tolerance / max(error, 1e-300)) ** 0.2)
        for correction in range(4):
            hand_pose(screws, home, q, X)
            angle, travel = twist_to(X, G, V)
            if angle <= ROTATION_TOLERANCE / 10 and travel <= POSITION_TOLERANCE / 10:
                break
            evaluations += 1
            if correction == 3 or not joint_rates(screws, q, V, J, M, K[0]):
                return UNREACHABLE, segment, -1, 1.0, evaluations
            for j in range(n):
                q[j] += K[0, j]
        for j in range(n):
            if q[j] <= lower[j] or q[j] >= upper[j]:
                return JOINT_LIMIT, segment, j, 1.0, evaluations
    return SUCCESS, -1, -1, 1.0, evaluations


@nb.njit(cache=True, parallel=True, error_model="numpy")
def plan_all(
    screws, home, lower, upper, X_OE, owner, counts, X_WO, q_start, tolerance, rate_limit, order, stop_early,
    cause, segment, joint, fraction, evaluations,
):  # fmt: skip
    """Plan N instances with D demonstrations; with `stop_early`, until the first success of each.

    X_OE (D, g, 4, 4), owner (D, g), counts (D,), X_WO (N, k, 4, 4), q_start (n,), order (N, D);
    the results are (N, D) and filled in.
    """
    for i in nb.prange(len(X_WO)):
        for place in range(order.shape[1]):
            d = order[i, place]
            guides = np.empty((counts[d], 3, 4))
            for g in range(counts[d]):
                X = X_WO[i, owner[d, g]]
                for a in range(3):
                    for b in range(4):
                        guides[g, a, b] = (
                            X[a, 0] * X_OE[d, g, 0, b]
                            + X[a, 1] * X_OE[d, g, 1, b]
                            + X[a, 2] * X_OE[d, g, 2, b]
                        )
                    guides[g, a, 3] += X[a, 3]
            result = plan(screws, home, lower, upper, guides, q_start, tolerance, rate_limit)
            cause[i, d], segment[i, d], joint[i, d] = result[0], result[1], result[2]
            fraction[i, d], evaluations[i, d] = result[3], result[4]
            if stop_early and result[0] == SUCCESS:
                break
