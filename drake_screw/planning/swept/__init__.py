"""Whether paths touch anything, for all of each path: distances of convex shapes, and travel."""

from drake_screw.planning.swept.checker import SweptChecker, Touched, lines, straight_steps

__all__ = ["SweptChecker", "Touched", "lines", "straight_steps"]
