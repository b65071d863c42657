"""The pictures of a run, from what its directory holds."""

from __future__ import annotations

from drake_screw.acquisition.loop import initial_places
from drake_screw.files import writing
from drake_screw.runs.directory import UNWRITABLE_RUN
from drake_screw.runs.pictures import draw_round, draw_run
from drake_screw.runs.reader import RunReader
from drake_screw.steps import Step, Tell, to_nobody
from drake_screw.visualization.cells import Axes


def redraw(
    reader: RunReader,
    axes: Axes | None = None,
    *,
    svg: bool = False,
    tell: Tell = to_nobody,
) -> None:
    """Draw the pictures of all rounds, and of the whole run, again; with `svg` as SVG, too.

    Heat maps are along `axes`, the usual ones if None. `tell` is told how far it is.

    Raises:
        RunDirectoryError: they cannot be written.
    """
    total = reader.rounds + 1
    for event in reader.all_rounds():
        tell(Step("drawing pictures", event.round, total))
        stem = reader.directory.round_folder(event.round) / "heat_map"
        with writing(stem.parent, UNWRITABLE_RUN):
            draw_round(reader.setup, event, stem, axes=axes, svg=svg)
    tell(Step("drawing pictures", reader.rounds, total))
    draw_all(reader, axes, svg=svg)


def draw_all(reader: RunReader, axes: Axes | None = None, *, svg: bool = False) -> None:
    """Draw the pictures of a whole run; where it has no round, the place that was asked for."""
    setup, directory = reader.setup, reader.directory
    wanted = setup.scenario.demonstrations.initial
    number, asked = len(directory.record.demonstrations), None
    if reader.rounds == 0 and isinstance(wanted, int) and number < wanted:
        places = initial_places(setup.regions, setup.scenario.seed, number, setup.first)
        asked = places[0].coordinates
    draw_run(setup, reader.all_rounds(), directory.path, asked=asked, axes=axes, svg=svg)
