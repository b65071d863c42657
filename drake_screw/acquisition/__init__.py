"""The self-evaluation loop and the teachers."""

from drake_screw.acquisition.asking import AskingRule
from drake_screw.acquisition.events import (
    DemonstrationAdded,
    DemonstrationRequested,
    Evaluation,
    Event,
    Finished,
    InstancesExecuted,
    RegionsEvaluated,
    RoundFinished,
    RoundStarted,
    Status,
    Suggestion,
)
from drake_screw.acquisition.grid_evaluator import Evaluator
from drake_screw.acquisition.loop import acquire
from drake_screw.acquisition.recorded_teacher import RecordedTeacher
from drake_screw.acquisition.suggestion import random_suggestion, suggest
from drake_screw.acquisition.teacher import Lesson, Teacher
from drake_screw.acquisition.tree_evaluator import TreeEvaluator
from drake_screw.acquisition.tries import Executed, Executing
from drake_screw.acquisition.usable_lessons import UsableLessons

__all__ = [
    "AskingRule",
    "DemonstrationAdded",
    "DemonstrationRequested",
    "Evaluation",
    "Evaluator",
    "Event",
    "Executed",
    "Executing",
    "Finished",
    "InstancesExecuted",
    "Lesson",
    "RecordedTeacher",
    "RegionsEvaluated",
    "RoundFinished",
    "RoundStarted",
    "Status",
    "Suggestion",
    "Teacher",
    "TreeEvaluator",
    "UsableLessons",
    "acquire",
    "random_suggestion",
    "suggest",
]
