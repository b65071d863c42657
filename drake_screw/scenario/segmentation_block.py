"""What a scenario file may say of how recordings are cut into constant screws."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from pydantic import Field, model_validator

from drake_screw.demonstrations import FaithfulConfig, SegmentationConfig
from drake_screw.scenario.block import Block, Problem
from drake_screw.scenario.values import METRES, OneOf, Positive

FAITHFUL, PUBLISHED = "faithful", "published"

DEFAULTS: Mapping[str, Mapping[str, float]] = {
    FAITHFUL: {
        "spacing": 0.004,
        "turn_spacing": 0.03,
        "position_tolerance": 0.01,
        "rotation_tolerance": 0.1,
        "region_of_interest": 1.5,
        "reach": 0.35,
    },
    PUBLISHED: {
        "spacing": 0.005,
        "position_tolerance": 0.015,
        "rotation_tolerance": 0.15,
        "min_progress": 0.001,
        "region_of_interest": 1.5,
    },
}
"""The keys that each method has, and their defaults."""


class SegmentationBlock(Block):
    method: Annotated[str, OneOf(tuple(DEFAULTS))] = FAITHFUL
    """faithful: the fewest screws that keep every sample near an object; published: Mahalingam and
    Chakraborty's, as in the paper"""
    spacing: Annotated[Positive | None, METRES] = None
    """smallest distance between poses at which the path may be cut; 0.004 where faithful, 0.005
    where published"""
    turn_spacing: Annotated[Positive | None, Field(json_schema_extra={"unit": "rad"})] = None
    """faithful: or the smallest turn between them; 0.03"""
    position_tolerance: Annotated[Positive | None, METRES] = None
    """largest distance of the recorded end effector from the screws; 0.01 where faithful, 0.015
    where published"""
    rotation_tolerance: Positive | None = None
    """faithful: largest angle of the recorded end effector from the screws, in rad; 0.1. published:
    largest chordal quaternion distance; 0.15"""
    min_progress: Positive | None = None
    """published: smallest advance of the screw parameter between successive poses; 0.001"""
    region_of_interest: Annotated[float, Field(ge=1)] | None = None
    """guiding poses lie within this many times the smallest distance of end effector and object;
    1.5"""
    reach: Annotated[Positive | None, METRES] = None
    """faithful: an object that the end effector does not come within is a bystander, unless
    `demonstrations.objects` names it; 0.35"""

    @model_validator(mode="before")
    @classmethod
    def _defaults_of_the_method(cls, data: Any) -> Any:
        data = {} if data is None else data
        if not isinstance(data, dict):
            return data
        given = {name: value for name, value in data.items() if value is not None}
        return {**DEFAULTS.get(str(given.get("method", FAITHFUL)), {}), **given}

    @property
    def config(self) -> SegmentationConfig | FaithfulConfig:
        """The same, for `demonstration_from_recording`."""
        own = {name: getattr(self, name) for name in DEFAULTS[self.method]}
        return FaithfulConfig(**own) if self.method == FAITHFUL else SegmentationConfig(**own)

    def broken_rules(self) -> Iterator[Problem]:
        own, foreign = DEFAULTS[self.method], PUBLISHED if self.method == FAITHFUL else FAITHFUL
        for name in DEFAULTS[foreign]:
            if name not in own and getattr(self, name) is not None:
                yield Problem(
                    (name,),
                    f"the method {self.method} has no such key",
                    f"Leave it out, or write `method: {foreign}`.",
                )
        try:
            _ = self.config
        except ValueError as error:
            yield Problem((), str(error), "Leave them out for their defaults.")
