"""The batch planner's machinery: code written for one arm, and the lanes that run on it."""

from drake_screw.planning.compiled.check import Check, Touches
from drake_screw.planning.compiled.kernel import Kernel, Order
from drake_screw.planning.compiled.lanes import Answers
from drake_screw.planning.compiled.step_code import Settings
from drake_screw.planning.compiled.trace import Trace, dense_output

__all__ = [
    "Answers",
    "Check",
    "Kernel",
    "Order",
    "Settings",
    "Touches",
    "Trace",
    "dense_output",
]
