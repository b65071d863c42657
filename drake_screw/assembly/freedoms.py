"""Symmetries that a scenario declares, and that a certificate of it counts on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from drake_screw.planning.symmetry import TOOL
from drake_screw.scenario.schema import Scenario


@dataclass(frozen=True, kw_only=True)
class Freedom:
    """A symmetry that is taken for granted.

    Attributes:
        body: name of the object, or "tool".
        axis: of its frame, about which it may be turned: "x", "y" or "z".
        turns: how many turns in a full one are taken to be the same; "any" for a body of
            revolution.
        tried: how many of them are tried.
    """

    body: str
    axis: Literal["x", "y", "z"]
    turns: int | Literal["any"]
    tried: int

    def __str__(self) -> str:
        if self.turns == "any":
            held = "a body of revolution"
            turned = f"by any angle, of which {self.tried} are tried"
        else:
            held = f"the same after each of {self.turns} equal turns"
            turned = "by any of them"
        what = "the end effector" if self.body == TOOL else "what is done to it"
        return (
            f"The {self.body} is taken to be {held} about its {self.axis} axis; {what} may be "
            f"turned with it {turned}."
        )


def freedoms(scenario: Scenario) -> tuple[Freedom, ...]:
    """Those of the objects, in their order, and of the tool."""
    tool, tried = scenario.robot.tool, scenario.planner.turns
    bodies = [(o.name, o.symmetry) for o in scenario.objects]
    bodies += [(TOOL, None if tool is None else tool.symmetry)]
    return tuple(
        Freedom(
            body=body,
            axis=block.axis,
            turns=block.turns,
            tried=tried if block.turns == "any" else block.turns,
        )
        for body, block in bodies
        if block is not None
    )
