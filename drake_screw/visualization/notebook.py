"""Meshcat scenes inside a Jupyter notebook, as they stand: no server, no network."""

from __future__ import annotations

from dataclasses import dataclass

from markupsafe import Markup
from pydrake.geometry import Meshcat


@dataclass(frozen=True)
class Embedded:
    """A page that Jupyter shows in the output of a cell.

    Attributes:
        page: the page's HTML, complete.
        height: of the frame it is shown in, px.
    """

    page: str
    height: int

    def _repr_html_(self) -> str:
        frame = Markup('<iframe srcdoc="{}" width="100%" height="{}" style="border: 0"></iframe>')
        return frame.format(self.page, self.height)


def embed(meshcat: Meshcat, height: int = 480) -> Embedded:
    """The scene as it is now, to be the last value of a notebook's cell.

    It can be turned and zoomed, and a published recording played, but later changes do not reach
    it. It takes some 2 MB in the notebook.

    Args:
        meshcat: with the scene.
        height: of the frame, px.
    """
    meshcat.Flush()
    return Embedded(meshcat.StaticHtml(), height)
