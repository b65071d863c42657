"""Plans from demonstrations: outcomes, the reference planner, the batch planner."""

from drake_screw.planning.batch import BatchPlanner
from drake_screw.planning.outcomes import Cause, Outcomes, Plan, concatenate
from drake_screw.planning.planner import Planner
from drake_screw.planning.reference import ReferencePlanner
from drake_screw.planning.symmetry import Symmetries, Turned

__all__ = [
    "BatchPlanner",
    "Cause",
    "Outcomes",
    "Plan",
    "Planner",
    "ReferencePlanner",
    "Symmetries",
    "Turned",
    "concatenate",
]
