"""Executing plans: time laws, the executor, simulation in Drake, and export."""

from drake_screw.execution.choosing import Choice, Chooser, PlanningOutcome
from drake_screw.execution.executor import Control, ScrewPlanExecutor
from drake_screw.execution.following import Following, Mode
from drake_screw.execution.joint_path import JointPathSource
from drake_screw.execution.monitoring import Tolerances
from drake_screw.execution.playback import recording_html
from drake_screw.execution.report import Contact, Deviation, ExecutionReport
from drake_screw.execution.screw_planner import ObjectPoses, ScrewPlanner
from drake_screw.execution.simulate import Execution, simulate
from drake_screw.execution.station import Station, build_station
from drake_screw.execution.status import ExecutionStatus, Phase
from drake_screw.execution.timing import TimedPlan, TimeLimits, time_plan

__all__ = [
    "Choice",
    "Chooser",
    "Contact",
    "Control",
    "Deviation",
    "Execution",
    "ExecutionReport",
    "ExecutionStatus",
    "Following",
    "JointPathSource",
    "Mode",
    "ObjectPoses",
    "Phase",
    "PlanningOutcome",
    "ScrewPlanExecutor",
    "ScrewPlanner",
    "Station",
    "TimeLimits",
    "TimedPlan",
    "Tolerances",
    "build_station",
    "recording_html",
    "simulate",
    "time_plan",
]
