"""Runs of which something was lost: what came after it is dropped, and found again."""

from __future__ import annotations

import logging
from dataclasses import dataclass

from drake_screw.errors import DrakeScrewError
from drake_screw.runs.reader import DamagedRound, RunReader

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Damage:
    """How much of a run can be read.

    Attributes:
        rounds, demonstrations: how many of them, from the first.
        why: not the next.
    """

    rounds: int
    demonstrations: int
    why: str


def find_damage(reader: RunReader) -> Damage | None:
    """The first demonstration or round of a run that cannot be read; None if all can.

    Raises:
        RunDirectoryError: a round does not fit the scenario.
    """
    record = reader.directory.record
    found = Damage(len(record.rounds), len(record.demonstrations), "")
    for number, kept in enumerate(record.demonstrations):
        try:
            reader.recording(number)
        except DrakeScrewError as error:
            before = sum(entry.demonstrations <= number for entry in record.rounds)
            found = Damage(before, number, f"demonstration {kept.name} is damaged: {error.message}")
            break
    for round in range(found.rounds):
        try:
            reader.evaluated(round)
        except DamagedRound as error:
            return Damage(round, record.rounds[round].demonstrations, error.message)
    return found if found.why else None


def drop_damaged(reader: RunReader) -> None:
    """Forget the first round or demonstration that cannot be read, and what came after it.

    Draws are functions of their place, so that what is forgotten is found again when the run is
    carried on; a demonstration that a person gave is asked for again.

    Raises:
        RunDirectoryError: a round does not fit the scenario, or run.json cannot be written.
    """
    damage, directory = find_damage(reader), reader.directory
    if damage is None:
        return
    record = directory.record
    lost = [f"demonstration {k.name}" for k in record.demonstrations[damage.demonstrations :]]
    lost += [f"round {i + 1}" for i in range(damage.rounds, len(record.rounds))]
    said = f"{damage.why}; dropped, to be found again: {', '.join(lost)}"
    _log.warning("%s: %s", directory.path, said)
    directory.log(said)
    directory.save(
        rounds=record.rounds[: damage.rounds],
        demonstrations=record.demonstrations[: damage.demonstrations],
        certificate=None,
        finished=None,
    )
