"""What an execution had to do for a certificate that rests on executions."""

from __future__ import annotations

from dataclasses import dataclass

from drake_screw.execution.allowed import Allowed
from drake_screw.execution.noise import Noise
from drake_screw.scenario.execution_block import ExecutionBlock


@dataclass(frozen=True)
class ExecutionTerms:
    """Of executions that count as successes; as text, sentences of the certificate.

    Attributes:
        allowed: what an execution might do.
        noise: what was not known exactly.
    """

    allowed: Allowed
    noise: Noise

    @classmethod
    def of(cls, block: ExecutionBlock) -> ExecutionTerms:
        """Those of a scenario."""
        values = dict(block)
        noise = Noise(**dict(values.pop("noise")))
        return cls(Allowed(**values), noise)

    def __str__(self) -> str:
        a = self.allowed
        touching = (
            f"the robot touches nothing with more than {a.contact_force:g} N"
            if a.contact_force > 0.0
            else "the robot touches nothing"
        )
        exact = "; ".join(self.noise.words)
        known = (
            f"What is not known exactly is drawn for each instance, with these standard "
            f"deviations: {exact}."
            if exact
            else "Objects are measured, and the arm's joints calibrated, exactly."
        )
        return (
            "That plan is executed, too, in a simulation with the dynamics of the robot's model "
            "and with objects free to move: it has to end as planned, within joint and velocity "
            f"limits; the end effector stays within "
            f"{1e3 * a.position:g} mm and {a.rotation:g} rad of where it ought to be, given where "
            f"the objects stand; {touching}; and no object is moved by more than "
            f"{1e3 * a.displacement:g} mm or turned by more than {a.turn:g} rad. {known}"
        )
