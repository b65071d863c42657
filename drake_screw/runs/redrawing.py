"""The pictures of a run, from what its directory holds."""

from __future__ import annotations

from drake_screw.acquisition.loop import initial_places
from drake_screw.runs.pictures import draw_round, draw_run
from drake_screw.runs.reader import RunReader


def redraw(reader: RunReader, *, svg: bool = False) -> None:
    """Draw the pictures of all rounds, and of the whole run, again; with `svg` as SVG, too."""
    for event in reader.all_rounds():
        stem = reader.directory.round_folder(event.round) / "heat_map"
        draw_round(reader.setup, event, stem, svg=svg)
    draw_all(reader, svg=svg)


def draw_all(reader: RunReader, *, svg: bool = False) -> None:
    """Draw the pictures of a whole run; where it has no round, the place that was asked for."""
    setup, directory = reader.setup, reader.directory
    wanted = setup.scenario.demonstrations.initial
    number, asked = len(directory.record.demonstrations), None
    if reader.rounds == 0 and isinstance(wanted, int) and number < wanted:
        places = initial_places(setup.regions, setup.scenario.seed, number, setup.first)
        asked = places[0].x_y_yaw
    draw_run(setup, reader.all_rounds(), directory.path, asked=asked, svg=svg)
