"""The legend of a run's scene: Meshcat's page has no text of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

from markupsafe import Markup

from drake_screw.tasks import Regions
from drake_screw.visualization.meshcat_page import add_to_page, render
from drake_screw.visualization.palette import (
    ACCENT,
    INK,
    OUTCOME_COLORS,
    OUTCOME_NAMES,
    PAPER,
    failure_scale,
)
from drake_screw.visualization.rounds import Round, Sample, details, headline


@dataclass(frozen=True)
class Slide:
    """A round as the page knows it: its name in the scene tree, its text, its demonstrations."""

    name: str
    headline: str
    details: str
    demonstrations: int


def slide(event: Round, regions: Regions) -> Slide:
    """What the page says of a round."""
    name, count = f"{event.round + 1:02d}", len(event.demonstrations)
    return Slide(name, headline(event), details(event, regions), count)


def with_legend(page: str, slides: Sequence[Slide], shown: Sample, *, scenario: str = "") -> str:
    """Meshcat's page with a title, the verdicts of the rounds, and what the colours mean.

    Args:
        page: as `Meshcat.StaticHtml` gives it.
        slides: at least one; the page opens on the last. Several get buttons.
        shown: the instances of the last round that were drawn.
        scenario: its name.
    """
    title = scenario or "drake_screw"
    counts = {cause: shown.count(cause) for cause in OUTCOME_NAMES}
    legend = render(
        "drake_screw.visualization",
        "legend.html.j2",
        title=title,
        ink=INK,
        scale=failure_scale(),
        slides=[asdict(each) for each in slides],
        demonstrations=[(PAPER, "demonstration"), (ACCENT, "next demonstration")],
        outcomes=[
            (OUTCOME_COLORS[cause], f"{name} ({counts[cause]:,})")
            for cause, name in OUTCOME_NAMES.items()
            if counts[cause]
        ],
        statement=shown.statement,
    )
    return add_to_page(page, legend + upright_numerals(), title=title)


def upright_numerals() -> Markup:
    """A script for a page that shows a `Scene`: the numerals on its table stand upright."""
    return render("drake_screw.visualization", "numerals.html.j2")
