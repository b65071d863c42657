"""The batch planner's machinery: code written for one arm, and the lanes that run on it."""

from drake_screw.planning.compiled.kernel import Kernel, Order
from drake_screw.planning.compiled.step_code import Settings

__all__ = ["Kernel", "Order", "Settings"]
