"""What a selection of recordings reports to its listener, in the order in which it happens."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from drake_screw.acquisition import InstancesExecuted, RegionsEvaluated
from drake_screw.bandits import Verdict
from drake_screw.runs.selection import Attempt
from drake_screw.steps import Step
from drake_screw.tasks import Regions


@dataclass(frozen=True, eq=False)
class Tried:
    """An attempt to certify a set has ended: number, from 1, and the verdict on its regions."""

    number: int
    attempt: Attempt
    verdict: Verdict
    regions: Regions


Listener = Callable[[Step | RegionsEvaluated | InstancesExecuted | Tried], None]
"""Is called with every step, with each batch of instances to certify, and with each attempt."""
