"""A teacher that answers from a library of recordings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drake_screw.acquisition.events import Suggestion
from drake_screw.acquisition.teacher import Lesson
from drake_screw.demonstrations import Recording
from drake_screw.tasks import Regions


@dataclass(frozen=True)
class RecordedTeacher:
    """Gives the nearest unused recording of the suggested region, or else the nearest at all.

    Attributes:
        recordings: the library.
        regions: the partition that requests refer to, unless they bring their own.
    """

    recordings: tuple[Recording, ...]
    regions: Regions

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
            return Lesson(None, f"all {len(self.recordings)} recordings are used")
        places = self.regions.area.x_y_yaw(np.stack([r.X_WO for r in left]))
        away = np.linalg.norm(places[..., :2] - suggestion.x_y_yaw[..., :2], axis=-1).sum(axis=-1)
        same = (suggestion.regions or self.regions).index(places) == suggestion.region
        chosen = int(np.lexsort((away, ~same))[0])
        which = (
            f"the nearest unused recording of region {suggestion.region}"
            if same[chosen]
            else f"region {suggestion.region} has no unused recording; the nearest at all"
        )
        return Lesson(left[chosen], f"{which}, {away[chosen] * 100:.0f} cm from the suggestion")


def _key(recording: Recording) -> tuple[str, bytes]:
    return recording.name, np.round(recording.X_WO, 9).tobytes()
