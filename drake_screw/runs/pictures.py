"""The pictures a run leaves: heat maps, the course of the run, the scene in Meshcat."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydrake.geometry import Meshcat, MeshcatParams

from drake_screw.acquisition import RoundFinished
from drake_screw.assembly.setup import Setup
from drake_screw.errors import ScenarioError, suggestion
from drake_screw.files import writing
from drake_screw.runs.directory import PICTURE, UNWRITABLE_RUN
from drake_screw.typing import Array
from drake_screw.visualization import Scene, save_heat_map, save_run_figure
from drake_screw.visualization.cells import Axes
from drake_screw.visualization.lifetime import scratch
from drake_screw.visualization.outlines import outlines

SCENE = "meshcat.html"


def plane_of(setup: Setup, names: Sequence[str]) -> Axes:
    """The axes of heat maps by their names, ``x`` or ``cup.x``: upwards, and sideways.

    As in a grid of regions, a single object may be named or not.

    Raises:
        ScenarioError: they are not two, or not of the work area.
    """
    area = setup.area
    several = len(area.objects) > 1
    known = {
        f"{item.name}.{axis}" if several else axis: (i, j)
        for i, item in enumerate(area.objects)
        for j, axis in enumerate(area.axes)
    }
    if not several:
        names = [name.removeprefix(f"{area.objects[0].name}.") for name in names]
    for name in names:
        if name not in known:
            raise ScenarioError(
                f"no axis '{name}' in this work area", remedy=suggestion(name, known, "Axes")
            )
    if len(set(names)) != 2 or len(names) != 2:
        raise ScenarioError(
            f"expected two axes of a heat map, found {', '.join(names) or 'none'}",
            remedy=f"Give two of {', '.join(known)}, separated by a comma.",
        )
    up, sideways = names
    return known[up], known[sideways]


def draw_round(
    setup: Setup,
    event: RoundFinished,
    stem: Path,
    *,
    axes: Axes | None = None,
    svg: bool = False,
) -> None:
    """Draw a round as ``<stem>.png``, with `svg` as ``<stem>.svg``, too.

    Along the usual axes if None.
    """
    look: dict[str, Any] = {"things": outlines(setup.obstacles), "axes": axes, "svg": svg}
    save_heat_map(event, event.regions, stem, scenario=setup.scenario.name, **look)


def draw_run(
    setup: Setup,
    rounds: Sequence[RoundFinished],
    folder: Path,
    *,
    asked: Array | None = None,
    axes: Axes | None = None,
    svg: bool = False,
) -> None:
    """Draw a whole run into a folder: rounds.png, with `svg` rounds.svg, and meshcat.html.

    Of a run without a round there is just the scene, and in it the place that was `asked` for,
    (k, c), if there is one. Heat maps are along `axes`, the usual ones if None.

    Raises:
        RunDirectoryError: they cannot be written.
    """
    if not rounds:
        with writing(folder, UNWRITABLE_RUN), scratch():
            scene = make_scene(setup)
            if asked is not None:
                scene.show_suggestion(asked)
            scene.save_html(folder / SCENE)
        return
    name, regions = setup.scenario.name, [event.regions for event in rounds]
    stem = folder / PICTURE.removesuffix(".png")
    with writing(folder, UNWRITABLE_RUN):
        save_run_figure(
            rounds,
            regions,
            stem,
            scenario=name,
            beta=setup.goal.beta,
            things=outlines(setup.obstacles),
            axes=axes,
            svg=svg,
        )
        with scratch():
            _save_scene(setup, rounds, folder / SCENE)


def _save_scene(setup: Setup, rounds: Sequence[RoundFinished], file: Path) -> None:
    scene = make_scene(setup)
    for event in rounds:
        scene.show_round(event, event.regions)
    scene.save_html(file)


def make_scene(setup: Setup, meshcat: Meshcat | None = None) -> Scene:
    """The scene of a scenario, in a Meshcat of its own on localhost if none is given."""
    if meshcat is None:
        meshcat = Meshcat(MeshcatParams(host="localhost"))
    return Scene(
        meshcat,
        setup.robot,
        setup.table,
        setup.objects,
        setup.area,
        scenario=setup.scenario.name,
        obstacles=setup.obstacles,
    )
