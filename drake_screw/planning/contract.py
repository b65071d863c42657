"""Numbers that define what a successful plan is, shared by all planners."""

from __future__ import annotations

POSITION_TOLERANCE = 1e-4
"""m. A segment ends at most this far from its guiding pose."""

ROTATION_TOLERANCE = 1e-3
"""rad. A segment ends at most this far turned from its guiding pose."""

LENGTH = 1.0
"""m. What counts as much as a radian when a hand's twist is given a size."""

RATE_LIMIT = 100.0
"""Joint motion for a unit of hand motion at which a pose is called unreachable.

Both are Euclidean norms: of joint rates, and of the hand's spatial velocity with lengths divided
by LENGTH. It bounds the inverse of the Jacobian's least singular value along the motion's twist.
"""
