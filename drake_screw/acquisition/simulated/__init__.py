"""A simulated teacher: recordings of an arm as a person would lead it, new ones every time."""

from drake_screw.acquisition.simulated.motions import MOTIONS, HandPath, Motion
from drake_screw.acquisition.simulated.simulated_teacher import SimulatedTeacher

__all__ = ["MOTIONS", "HandPath", "Motion", "SimulatedTeacher"]
