"""A recording on the teaching page, before it is accepted: what is kept of it, and its plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup, escape

from drake_screw.assembly.attempting import judged_attempt
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Look, Recording
from drake_screw.demonstrations.fidelity import Fidelity
from drake_screw.errors import counted
from drake_screw.typing import Array
from drake_screw.visualization.attempt import (
    DONE,
    FAILED,
    Attempt,
    describe_segment,
    headline,
)
from drake_screw.visualization.look_figures import object_color
from drake_screw.visualization.palette import STATUS_COLORS

_HEIGHT, _TOLERANCE = 60.0, 40.0  # units of the chart, and of them for a tolerance


@dataclass(frozen=True, eq=False)
class Offer:
    """A recording, or a part of it, that could be accepted.

    Attributes:
        recording: what would be.
        start: s, where it starts in the whole recording.
        look: what is learned from it.
        tried: that, at the place that was asked for.
    """

    recording: Recording
    start: float
    look: Look
    tried: Attempt

    @property
    def words(self) -> str:
        """What became of it."""
        found = counted(len(self.tried.guides), "guiding pose")
        return f"{found} found; planned at the suggested place it {headline(self.tried)}"

    @property
    def segments(self) -> list[dict[str, str]]:
        """A line for each screw segment of the plan."""
        return [
            {"color": STATUS_COLORS[status], "words": describe_segment(self.tried, i)}
            for i, status in enumerate(self.tried.status)
        ]

    @property
    def kept(self) -> list[dict[str, str]]:
        """A line for each object of the task: how faithfully what was shown near it is kept."""
        return [
            {
                "color": STATUS_COLORS[DONE if self._within(near) else FAILED],
                "words": f"{near}; {near.time:.0%} of the time",
            }
            for near in self.tried.demonstration.fidelity
        ]

    def _within(self, near: Fidelity) -> bool:
        """Whether what is kept near an object is within the tolerances."""
        position, rotation = self.look.tolerances
        return near.position <= position and near.rotation <= rotation

    def chart(self, duration: float) -> Markup:
        """How far each sample kept is from the screws, over the `duration` in s of the whole.

        In proportion to the tolerances, that of position or of rotation, whichever is more; the
        dashed line is the tolerance. A line of an object has its colour; grey is not kept.
        """
        position, rotation = self.look.tolerances
        x = 100.0 * (self.start + self.look.t) / duration
        parts = [
            f'<rect x="{_at(self.start + gap.start, duration)}" y="0" height="{_HEIGHT:.0f}" '
            f'width="{_at(gap.end - gap.start, duration)}" class="gap"><title>{escape(gap.why)}'
            "</title></rect>"
            for gap in self.look.dropped
        ]
        limit = _HEIGHT - _TOLERANCE
        parts.append(f'<line x1="0" x2="100" y1="{limit}" y2="{limit}" class="tolerance"/>')
        for near in self.look.deviations:
            share = np.maximum(near.position / position, near.rotation / rotation)
            y = _HEIGHT - _TOLERANCE * np.minimum(share, _HEIGHT / _TOLERANCE)
            for run in np.split(np.arange(len(y)), np.flatnonzero(np.diff(near.samples) > 1) + 1):
                points = " ".join(f"{x[near.samples[i]]:.2f},{y[i]:.2f}" for i in run)
                color = object_color(near.object)
                parts.append(f'<polyline points="{points}" stroke="{color}" class="deviation"/>')
        return Markup(
            f'<svg class="kept" viewBox="0 0 100 {_HEIGHT:.0f}" preserveAspectRatio="none" '
            'role="img" aria-label="deviation of the samples from the screws, by the tolerance">'
            f"{''.join(parts)}</svg>"
        )


def _at(seconds: float, duration: float) -> str:
    return f"{100.0 * seconds / duration:.2f}"


def offer(setup: Setup, X_WO: Array, number: int, recording: Recording, start: float) -> Offer:
    """Cut a recording into screws, and plan an instance with it.

    Args:
        setup: of the run.
        X_WO: (k, 4, 4) the objects of the instance.
        number: of the demonstration, from 0.
        recording: the whole, or a part of it.
        start: s, where that part starts.

    Raises:
        NoMotionKept: next to nothing of what was shown near an object would be kept.
        RecordingError: it names an object that there is not.
    """
    look = setup.look(recording)
    demonstration = look.demonstration
    if demonstration is None:
        assert look.refused is not None
        raise look.refused
    found = setup.planner.all_outcomes([demonstration], X_WO[None], setup.start)[0, 0]
    tried = judged_attempt(setup, number, demonstration, X_WO, found)
    return Offer(recording, start, look, tried)


def as_state(found: Offer | None, whole: Recording | None) -> dict[str, Any]:
    """What the panel shows of an offer, if there is one, and of the recording it is a part of."""
    duration = 0.0 if whole is None else whole.duration
    return {
        "segments": [] if found is None else found.segments,
        "kept": [] if found is None else found.kept,
        "chart": "" if found is None else found.chart(duration),
        "duration": duration,
    }
