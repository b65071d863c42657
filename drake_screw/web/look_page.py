"""What recordings hold, on one page that needs no network."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydrake.geometry import Meshcat, MeshcatParams

from drake_screw.assembly.looking import Looks
from drake_screw.assembly.setup import Setup
from drake_screw.demonstrations import Look
from drake_screw.demonstrations.look_summary import LookSummary
from drake_screw.errors import DrakeScrewError
from drake_screw.files import write_text, writing
from drake_screw.outputs import writable
from drake_screw.planning import Cause
from drake_screw.runs.pictures import make_scene
from drake_screw.steps import Step, Tell, to_nobody
from drake_screw.visualization.drawing import AXES
from drake_screw.visualization.figure_files import figure_address
from drake_screw.visualization.lifetime import scratch
from drake_screw.visualization.linkage import Linkage
from drake_screw.visualization.look_figures import (
    deviation_figure,
    distance_figure,
    joint_figure,
    object_color,
)
from drake_screw.visualization.look_scene import animate, draw_look
from drake_screw.visualization.look_view import view_figure
from drake_screw.visualization.meshcat_page import render
from drake_screw.visualization.palette import OUTCOME_COLORS, QUIET
from drake_screw.visualization.screw_drawing import AXIS


def write_look_page(looks: Looks, file: Path, tell: Tell = to_nobody) -> Path:
    """Write a page with a section for each recording; of the only one, with the scene in 3-D.

    Args:
        looks: what was looked at.
        file: to write.
        tell: told how far it is.

    Returns:
        The page.

    Raises:
        DrakeScrewError: it cannot be written there.
    """
    text = look_page(looks, tell)
    with writing(file, writable("--html"), DrakeScrewError):
        write_text(file, text)
    return file


def look_page(looks: Looks, tell: Tell = to_nobody) -> str:
    """The page's HTML."""
    summary, setup = looks.summary, looks.setup
    sections = []
    for number, (look, found) in enumerate(zip(looks.looks, summary.recordings, strict=True)):
        tell(Step("drawing recordings", number, len(looks.looks)))
        sections.append(_section(setup, look, found, scene=len(looks.looks) == 1))
    page = render(
        "drake_screw.web",
        "look.html.j2",
        summary=summary,
        title=looks.source.resolve().name,
        robot=setup.recorder.robot or setup.scenario.robot.model,
        key=_key(setup),
        sections=sections,
    )
    return str(page) + "\n"


def _section(setup: Setup, look: Look, found: LookSummary, *, scene: bool) -> dict[str, Any]:
    """What the template shows of a recording."""
    return {
        "look": found,
        "color": OUTCOME_COLORS[Cause.SUCCESS if look.demonstration else Cause.JOINT_LIMIT],
        "scene": _scene(setup, look) if scene else "",
        "view": figure_address(view_figure(look, setup.objects)),
        "distances": figure_address(distance_figure(look)),
        "deviations": figure_address(deviation_figure(look)) if look.demonstration else "",
        "joints": figure_address(joint_figure(look)) if look.units else "",
    }


def _scene(setup: Setup, look: Look) -> str:
    """Meshcat's page of one recording; its arm moves where it is the scenario's own."""
    with scratch():
        meshcat = Meshcat(MeshcatParams(host="localhost", show_stats_plot=False))
        make_scene(setup, meshcat)
        draw_look(meshcat, look, setup.objects)
        if look.recording.robot is None and look.units:
            for one in setup.arms:
                if one.arm.joint_names == look.recording.joint_names:
                    animate(meshcat, Linkage(one.workcell), look.t, look.q)
        return str(meshcat.StaticHtml())


def _key(setup: Setup) -> list[tuple[str, str]]:
    """What the colours mean."""
    return [
        (QUIET, "path as recorded"),
        *(
            (object_color(i), f"screws, and region of interest, of the {item.name}")
            for i, item in enumerate(setup.objects)
        ),
        (AXIS, "screw axis; the arrow around it is its turn"),
        *zip(AXES, (f"{axis} axis of a guiding pose" for axis in "xyz"), strict=True),
    ]
