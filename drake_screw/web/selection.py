"""What the inspector shows of a run, and how a message of its panel changes that."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from drake_screw.runs.reader import RunReader


@dataclass(frozen=True)
class Selection:
    """One attempt of a run, or less; all are counted from 0.

    Attributes:
        round: of the run.
        region: to whose instances the panel's buttons keep; None for those of all regions.
        instance: a row of the round's instances; None if the round has none.
        demonstration: the one tried there; None if the round has none.
        against: another one, shown beside it; None for none.
    """

    round: int
    region: int | None
    instance: int | None
    demonstration: int | None
    against: int | None = None

    @property
    def drawn(self) -> frozenset[int]:
        """The demonstrations that are looked at."""
        return frozenset(d for d in (self.demonstration, self.against) if d is not None)


def select(reader: RunReader, round: int, instance: int | None = None) -> Selection:
    """A round and an instance of it with its best attempt.

    Args:
        reader: the run.
        round: counted from 0.
        instance: a row of the round's instances; if None the suggested one, or the earliest
            failing, or any.

    Raises:
        ScenarioError: there is no such instance.
    """
    instance = reader.check_instance(round, instance)
    best = None if instance is None else reader.best(round, instance)
    return Selection(round, None, instance, best)


def after_message(reader: RunReader, selection: Selection, message: dict[str, Any]) -> Selection:
    """The selection after a message of the panel; one that means nothing changes nothing.

    Messages: ``{"round": r}``, ``{"region": j or null}``, ``{"step": "next"}`` (previous, earliest,
    suggested), ``{"at": [x, y]}`` in m (the nearest instance), ``{"demonstration": d}``,
    ``{"against": d or null}``.
    """
    match message:
        case {"round": int(round)} if 0 <= round < reader.rounds:
            return select(reader, round)
        case {"region": int() | None as region}:
            listed = reader.catalogue(selection.round).of_region(region)
            if len(listed) > 0:
                moved = replace(selection, region=region)
                return _at_place(reader, moved, int(listed[0]))
        case {"step": str(step)} if step in steps(reader, selection):
            return _at_place(reader, selection, steps(reader, selection)[step])
        case {"at": [int() | float() as x, int() | float() as y]}:
            place = reader.catalogue(selection.round).nearest_to(float(x), float(y))
            if place is not None:
                return _at_place(reader, replace(selection, region=None), place)
        case {"demonstration": int(number)} if selection.instance is not None:
            if 0 <= number < len(reader.event(selection.round).demonstrations):
                swapped = number == selection.against
                against = selection.demonstration if swapped else selection.against
                return replace(selection, demonstration=number, against=against)
        case {"against": None}:
            return replace(selection, against=None)
        case {"against": int(number)} if number != selection.demonstration:
            if 0 <= number < len(reader.event(selection.round).demonstrations):
                return replace(selection, against=number)
    return selection


def steps(reader: RunReader, selection: Selection) -> dict[str, int]:
    """Where each of the panel's buttons leads, as places in the round's catalogue."""
    book = reader.catalogue(selection.round)
    listed = book.of_region(selection.region)
    found: dict[str, int] = {}
    here = None if selection.instance is None else book.find(selection.instance)
    if here is not None and len(listed):
        before, after = listed[listed < here], listed[listed > here]
        if len(before):
            found["previous"] = int(before[-1])
        if len(after):
            found["next"] = int(after[0])
    if len(listed) and listed[0] < book.failing:
        found["earliest"] = int(listed[0])
    suggested = book.suggested()
    if suggested is not None and selection.region in (None, book.region[suggested]):
        found["suggested"] = suggested
    return found


def _at_place(reader: RunReader, selection: Selection, place: int) -> Selection:
    """The same round and region at another place of the catalogue, with its best attempt."""
    instance = int(reader.catalogue(selection.round).instance[place])
    best = reader.best(selection.round, instance)
    against = None if best == selection.against else selection.against
    return replace(selection, instance=instance, demonstration=best, against=against)
