"""Matplotlib's figures as files, and as a part of a page: the same bytes every time."""

from __future__ import annotations

import base64
import io
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from drake_screw.files import write_bytes
from drake_screw.visualization.palette import PAPER

_SVG = {"svg.hashsalt": "drake_screw", "svg.fonttype": "path"}


def save_figure(figure: Figure, stem: str | Path, *, svg: bool = False) -> tuple[Path, ...]:
    """Write a figure as ``<stem>.png``, and with `svg` as ``<stem>.svg``.

    An SVG that is there is drawn again in any case, so that the two show the same. There is no
    date in them, no program and no random id.

    Returns:
        The files.

    Raises:
        OSError: they cannot be written.
    """
    png, drawing = Path(f"{stem}.png"), Path(f"{stem}.svg")
    write_bytes(png, png_bytes(figure))
    if not (svg or drawing.exists()):
        return (png,)
    write_bytes(drawing, _svg(figure))
    return png, drawing


def png_bytes(figure: Figure) -> bytes:
    """A figure as PNG."""
    picture = io.BytesIO()
    figure.savefig(picture, dpi=160, metadata={"Software": None}, facecolor=PAPER)
    return picture.getvalue()


def figure_address(figure: Figure) -> str:
    """A figure as SVG in an address of its own, for an ``img`` that needs no other file."""
    return f"data:image/svg+xml;base64,{base64.b64encode(_svg(figure)).decode()}"


def _svg(figure: Figure) -> bytes:
    text = io.BytesIO()
    with mpl.rc_context(_SVG):
        metadata = {"Date": None, "Creator": None}
        figure.savefig(text, format="svg", metadata=metadata, facecolor=PAPER)
    return text.getvalue()
