"""What an inspector looks at, and how its buttons move on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from drake_screw.runs.reader import RunReader


@dataclass(frozen=True)
class Choice:
    """What is looked at: indices from 0, `place` in the round's catalogue or None for another."""

    round: int
    region: int | None
    instance: int | None
    demonstration: int | None


def choose(reader: RunReader, round: int, instance: int | None = None) -> Choice:
    """A round and an instance of it (a row of its instances, or None: where to begin)."""
    instance = reader.check_instance(round, instance)
    best = None if instance is None else reader.best(round, instance)
    return Choice(round, None, instance, best)


def changed(reader: RunReader, choice: Choice, message: dict[str, Any]) -> Choice:
    """What is looked at after a message of the panel; nonsense changes nothing.

    Messages: ``{"round": r}``, ``{"region": j or null}``, ``{"step": "next"}`` (previous, earliest,
    suggested), ``{"at": [x, y]}`` (the nearest instance), ``{"demonstration": d}``.
    """
    match message:
        case {"round": int(round)} if 0 <= round < reader.rounds:
            return choose(reader, round)
        case {"region": int() | None as region}:
            listed = reader.catalogue(choice.round).of_region(region)
            if len(listed) == 0:
                return choice
            moved = Choice(choice.round, region, choice.instance, choice.demonstration)
            return _at(reader, moved, int(listed[0]))
        case {"step": str(step)} if step in steps(reader, choice):
            return _at(reader, choice, steps(reader, choice)[step])
        case {"at": [int() | float() as x, int() | float() as y]}:
            book = reader.catalogue(choice.round)
            place = book.nearest_to(float(x), float(y))
            free = Choice(choice.round, None, choice.instance, choice.demonstration)
            return choice if place is None else _at(reader, free, place)
        case {"demonstration": int(number)} if choice.instance is not None:
            if 0 <= number < len(reader.event(choice.round).demonstrations):
                return Choice(choice.round, choice.region, choice.instance, number)
    return choice


def steps(reader: RunReader, choice: Choice) -> dict[str, int]:
    """Where each of the panel's buttons leads, as places in the round's catalogue."""
    book = reader.catalogue(choice.round)
    listed = book.of_region(choice.region)
    found: dict[str, int] = {}
    here = None if choice.instance is None else book.find(choice.instance)
    if here is not None and len(listed):
        before, after = listed[listed < here], listed[listed > here]
        if len(before):
            found["previous"] = int(before[-1])
        if len(after):
            found["next"] = int(after[0])
    if len(listed) and listed[0] < book.failing:
        found["earliest"] = int(listed[0])
    suggested = book.suggested()
    if suggested is not None and choice.region in (None, book.region[suggested]):
        found["suggested"] = suggested
    return found


def which(reader: RunReader, choice: Choice) -> str:
    """An instance's number, its region, and its place among those that fail."""
    assert choice.instance is not None
    book = reader.catalogue(choice.round)
    event = reader.event(choice.round)
    region = int(event.evaluation.region[choice.instance])
    words = f"instance {choice.instance:,} of {len(event.evaluation.x_y_yaw):,}, region {region}"
    place = book.find(choice.instance)
    if place is not None and place < book.failing:
        order = book.of_region(choice.region)
        failing = order[order < book.failing]
        where = "" if choice.region is None else " in this region"
        words += f"; failing, {int((failing < place).sum()) + 1:,} of {len(failing):,}{where}"
    elif event.evaluation.outcomes[choice.instance].success.any():
        words += "; succeeds"
    if place is not None and place == book.suggested():
        words += "; the suggested place for the next demonstration"
    return words


def _at(reader: RunReader, choice: Choice, place: int) -> Choice:
    instance = int(reader.catalogue(choice.round).instance[place])
    best = reader.best(choice.round, instance)
    return Choice(choice.round, choice.region, instance, best)
