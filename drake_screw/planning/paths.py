"""Joint paths between the steps of the batch planner: the plans that it decided on.

A step of Dormand and Prince's pair is continued to a polynomial of fourth order between its ends
(Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section II.6).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drake_screw.planning.compiled import Trace, dense_output
from drake_screw.planning.outcomes import Cause, Outcomes, Plan
from drake_screw.typing import Array

SPACING = 0.1
"""rad (or m), joint motion, summed up over the joints, between two points of a path at most."""

FEWEST = 4
"""Parts of a step at least; the points between them determine its polynomial."""


def joint_paths(
    outcomes: Outcomes,
    trace: Trace,
    q_start: Array,
    limits: Array,
    guides: Sequence[Array],
    angles: Array,
    free_axis: Array | None = None,
) -> tuple[Plan, ...]:
    """Sample the paths of plans.

    A path ends where its plan does, at a joint limit exactly on it. Between its points it is cut to
    the limits, of which the polynomial knows less than the planner.

    Args:
        outcomes: (N,) of the plans.
        trace: of their steps.
        q_start: (N, n) rad or m, where each starts.
        limits: (2, n) lower and upper joint limits.
        guides, angles: of each plan, as it has them.
        free_axis: of all plans, as they have it.
    """
    parts = _parts(trace)
    step = np.repeat(np.arange(len(parts)), parts)
    number = 1 + np.arange(len(step)) - np.repeat(np.cumsum(parts) - parts, parts)
    u = trace.part[step] * number / parts[step]
    q = np.clip(dense_output(trace.q[step], u), *limits)
    s = trace.s[step, 0] + u * (trace.s[step, 1] - trace.s[step, 0])
    first = np.concatenate([[0], np.cumsum(parts)])[trace.first]
    plans = []
    for i, outcome in enumerate(outcomes[j] for j in range(len(trace.first) - 1)):
        own = slice(first[i], first[i + 1])
        path = np.concatenate([q_start[i : i + 1], q[own]])
        if outcome.cause == Cause.JOINT_LIMIT:
            joint = int(outcome.joint)
            nearer = np.abs(limits[:, joint] - path[-1, joint]).argmin()
            path[-1, joint] = limits[nearer, joint]
        segment = np.concatenate([[0], trace.segment[step[own]]])
        along = np.concatenate([[0.0], s[own]])
        what = outcome, guides[i], angles[i]
        plans.append(Plan(path, segment, along, *what, free_axis=free_axis))
    return tuple(plans)


def _parts(trace: Trace) -> Array:
    """Into how many parts each step is divided; none if nothing of it is used."""
    q0, q1, d0, d1, _ = np.moveaxis(trace.q, 1, 0)
    motion = np.max([np.abs(q1 - q0), np.abs(d0), np.abs(d1)], axis=0).sum(axis=-1)
    fewest = np.where(trace.s[:, 0] < trace.s[:, 1], FEWEST, 1)
    parts = np.maximum(np.ceil(trace.part * motion / SPACING), fewest)
    return np.where(trace.part > 0.0, parts, 0.0).astype(np.int64)
