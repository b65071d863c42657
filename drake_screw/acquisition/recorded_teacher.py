"""A teacher that answers from a library of recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from drake_screw.acquisition.events import Suggestion
from drake_screw.acquisition.teacher import Lesson
from drake_screw.demonstrations import Recording
from drake_screw.tasks import Regions
from drake_screw.typing import Array


class TriedOut(Protocol):
    """What a teacher can find out about recordings by planning with them."""

    def seen(self, recording: Recording) -> Array:
        """Where its objects stood, X_WO (k, 4, 4), in the world that requests refer to."""
        ...

    def works(self, recordings: Sequence[Recording], coordinates: Array) -> NDArray[np.bool_]:
        """Whether each of R gives a plan, with the arm that is planned for.

        Args:
            recordings: R of them.
            coordinates: (M, k, c) task instances.

        Returns:
            (M, R).
        """
        ...


@dataclass(frozen=True)
class RecordedTeacher:
    """Gives the nearest unused recording of the suggested region, or else the nearest at all.

    A demonstration given where it is asked for works there. Of another robot's recordings that
    cannot be taken for granted, wherever the objects stood. So instead of those of the suggested
    region, the ones that do work at the suggested place come first.

    Or it tries them out, and gives the one with which most of the instances succeed that fail so
    far, all over the work area; of several the nearest. Where a suggestion has no such instances
    with it, or none of them succeeds with any, it is the nearest after all.

    Attributes:
        recordings: the library; a place outside the work area belongs to the nearest region.
        regions: the partition that requests refer to, unless they bring their own.
        foreign: what is known of recordings made on another robot; None where they were not.
        covering: what it tries them out by; None where it does not.
    """

    recordings: tuple[Recording, ...]
    regions: Regions
    foreign: TriedOut | None = None
    covering: TriedOut | None = None

    def demonstrate(
        self,
        suggestion: Suggestion,
        *,
        number: int,
        used: tuple[Recording, ...],
        rng: np.random.Generator,
    ) -> Lesson:
        """See `Teacher.demonstrate`; nothing is left to chance here."""
        spent = {_key(r) for r in used}
        left = [r for r in self.recordings if _key(r) not in spent]
        if not left:
            n = len(self.recordings)
            used_up = "the only recording is" if n == 1 else f"all {n} recordings are"
            return Lesson(None, f"{used_up} used")
        there = [r.X_WO if self.foreign is None else self.foreign.seen(r) for r in left]
        places = self.regions.area.coordinates(np.stack(there))
        away = self.regions.area.away(places, suggestion.coordinates)
        gained = self._gained(left, used, suggestion)
        if gained.any():
            chosen = int(np.lexsort((away, -gained))[0])
            return Lesson(
                left[chosen],
                f"the unused recording that solves most of what fails, {gained[chosen]:.0%} of "
                f"it; {away[chosen] * 100:.0f} cm from the suggestion",
            )
        if self.foreign is None:
            fits = (suggestion.regions or self.regions).index(places) == suggestion.region
            one, none = (
                f"the nearest unused recording of region {suggestion.region}",
                f"region {suggestion.region} has no unused recording; the nearest at all",
            )
        else:
            fits = self.foreign.works(left, suggestion.coordinates[None])[0]
            one, none = (
                "of the unused recordings that work there, the nearest",
                "no unused recording works there; the nearest at all",
            )
        chosen = int(np.lexsort((away, ~fits))[0])
        which = one if fits[chosen] else none
        return Lesson(left[chosen], f"{which}, {away[chosen] * 100:.0f} cm from the suggestion")

    def _gained(
        self, left: Sequence[Recording], used: Sequence[Recording], suggestion: Suggestion
    ) -> Array:
        """(R,) part of what fails that succeeds with each recording; 0 where it is not asked."""
        failing = suggestion.failing
        if self.covering is None or failing is None or len(failing) == 0:
            return np.zeros(len(left))
        works = self.covering.works([*left, *used], failing)
        fails = ~works[:, len(left) :].any(axis=1)
        return np.count_nonzero(works[fails, : len(left)], axis=0) / max(np.count_nonzero(fails), 1)


def _key(recording: Recording) -> tuple[str, bytes]:
    return recording.name, np.round(recording.X_WO, 9).tobytes()
