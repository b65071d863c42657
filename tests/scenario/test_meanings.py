"""Meanings of keys, read from the docstrings of fields."""

from __future__ import annotations

from drake_screw.recordings.mapping import Mapping
from drake_screw.scenario.meanings import meanings
from drake_screw.scenario.schema import Scenario
from drake_screw.scenario.shape_blocks import ObstacleBlock, ShapeBlock


def test_every_field_of_a_block_has_a_meaning_on_one_line() -> None:
    for block in (Scenario, Mapping):
        assert meanings(block).keys() == block.model_fields.keys()
        assert all(text and "\n" not in text for text in meanings(block).values())


def test_a_block_has_the_meanings_of_those_it_derives_from() -> None:
    assert meanings(ShapeBlock).items() <= meanings(ObstacleBlock).items()
