"""What comes of recordings for the arm that is planned for, tried out by planning."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drake_screw.assembly.arms_recorder import AnyRecorder
from drake_screw.assembly.recorder import Learning
from drake_screw.demonstrations import Demonstration, NoMotionKept, Recording
from drake_screw.planning import Planner
from drake_screw.typing import Array


@dataclass(frozen=True)
class TriedRecordings:
    """What a teacher finds out about recordings by planning with them; see `TriedOut`.

    Attributes:
        recorder: of the robot they were made on.
        learning: how they become demonstrations.
        planner: of the arm that is planned for.
        start: (n,) rad or m, where its plans start; of several arms one after the other.
    """

    recorder: AnyRecorder
    learning: Learning
    planner: Planner
    start: Array
    _learned: dict[tuple[Path | None, str], Demonstration | None] = field(
        default_factory=dict, repr=False
    )

    def seen(self, recording: Recording) -> Array:
        """See `Recorder.seen`."""
        return self.recorder.seen(recording)

    def works(self, recordings: Sequence[Recording], coordinates: Array) -> NDArray[np.bool_]:
        """(M, R) whether each of R gives a plan at task instances (M, k, c).

        One of which no motion would be kept gives none.
        """
        learned = [self._learn(recording) for recording in recordings]
        known = [demonstration for demonstration in learned if demonstration is not None]
        works = np.zeros((len(coordinates), len(learned)), dtype=bool)
        works[:, [demonstration is not None for demonstration in learned]] = (
            self.planner.all_outcomes(
                known, self.recorder.area.X_WO(coordinates), self.start
            ).success
        )
        return works

    def _learn(self, recording: Recording) -> Demonstration | None:
        key = _key(recording)
        if key not in self._learned:
            try:
                self._learned[key] = self.recorder.learn(recording, self.learning)
            except NoMotionKept:
                self._learned[key] = None
        return self._learned[key]


def _key(recording: Recording) -> tuple[Path | None, str]:
    return recording.source, recording.name
