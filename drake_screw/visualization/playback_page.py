"""Controls and a list for a page that plays executions: Meshcat's own are for its developers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

from drake_screw.visualization.meshcat_page import add_to_page, render
from drake_screw.visualization.palette import INK


@dataclass(frozen=True)
class Played:
    """An execution on the page: from when to when it is played in s, words, and a colour."""

    start: float
    end: float
    words: str
    color: str


def with_controls(page: str, title: str, played: Sequence[Played]) -> str:
    """Meshcat's page of a recording with a title, a list of what it shows, and controls.

    Args:
        page: as `Meshcat.StaticHtml` gives it.
        title: of the page.
        played: at least one, in the order in which they are played.
    """
    controls = render(
        "drake_screw.visualization",
        "playback.html.j2",
        title=title,
        ink=INK,
        played=[asdict(one) for one in played],
    )
    return add_to_page(page, controls, title=title)
