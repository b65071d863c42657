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
        body: name of the object, or "tool"; "left tool" where the tools of several arms differ.
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
        held_by_hand = self.body == TOOL or self.body.endswith(f" {TOOL}")
        what = "the end effector" if held_by_hand else "what is done to it"
        return (
            f"The {self.body} is taken to be {held} about its {self.axis} axis; {what} may be "
            f"turned with it {turned}."
        )


def freedoms(scenario: Scenario) -> tuple[Freedom, ...]:
    """Those of the objects, in their order, and of the tools."""
    tried, arms = scenario.planner.turns, scenario.robot.each_arm
    held = [None if arm.tool is None else arm.tool.symmetry for arm in arms]
    bodies = [(o.name, o.symmetry) for o in scenario.objects]
    if all(symmetry == held[0] for symmetry in held):
        bodies.append((TOOL, held[0]))
    else:
        named = zip(arms, held, strict=True)
        bodies += [(f"{arm.name} {TOOL}", symmetry) for arm, symmetry in named]
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


def tool_touches(scenario: Scenario) -> tuple[str, ...]:
    """What the things in the hands may touch, each once."""
    tools = (arm.tool for arm in scenario.robot.each_arm)
    names = (name for tool in tools if tool is not None for name in tool.touches)
    return tuple(dict.fromkeys(names))
