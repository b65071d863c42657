"""Recordings trimmed at their ends."""

from __future__ import annotations

from dataclasses import replace

from drake_screw.demonstrations.recording import Recording
from drake_screw.errors import RecordingError, counted

_SLACK = 1e-9  # s, of stamps that were rounded


def part_of(recording: Recording, start: float, end: float) -> Recording:
    """What was recorded from `start` to `end`, in s; time begins at 0 again.

    Raises:
        RecordingError: those are fewer than two samples.
    """
    kept = (recording.t >= start - _SLACK) & (recording.t <= end + _SLACK)
    if kept.all():
        return recording
    if kept.sum() < 2:
        raise RecordingError(
            f"{counted(int(kept.sum()), 'sample')} from {start:.2f} s to {end:.2f} s",
            remedy="Keep more of the recording; it needs at least 2.",
            file=recording.source,
        )
    t = recording.t[kept]
    note = f"kept {t[0]:.2f} s to {t[-1]:.2f} s of {recording.duration:.2f} s"
    return replace(
        recording,
        t=t - t[0],
        q=recording.q[kept],
        X_WE=None if recording.X_WE is None else recording.X_WE[kept],
        notes=(*recording.notes, note),
        cut=True,
    )
