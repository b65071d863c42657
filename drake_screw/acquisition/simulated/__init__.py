"""A simulated teacher: recordings of an arm as a person would lead it, new ones every time."""

from drake_screw.acquisition.simulated.motions import MOTIONS
from drake_screw.acquisition.simulated.teacher import SimulatedTeacher

__all__ = ["MOTIONS", "SimulatedTeacher"]
