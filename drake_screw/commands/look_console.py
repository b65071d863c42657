"""What recordings hold, in a terminal."""

from __future__ import annotations

from pathlib import Path

from rich.table import Table

from drake_screw.assembly.looking import LooksSummary
from drake_screw.commands.output import Output
from drake_screw.demonstrations.fidelity import Fidelity
from drake_screw.demonstrations.look_summary import LookSummary
from drake_screw.resources import SCENARIO_SUFFIXES, list_resources
from drake_screw.runs.directory import RUN, SCENARIO

DEFAULT = "pouring"


def chosen_for(recording: Path, scenario: str | None) -> tuple[str, str]:
    """The scenario to look at a recording or library with.

    Args:
        recording: where it is.
        scenario: a shipped one's name or a file, if one is given.

    Returns:
        A name or path, and in words why that one.
    """
    if scenario is not None:
        return scenario, "as given"
    folders = [recording.resolve(), *recording.resolve().parents][:3]
    for folder in folders[1:]:
        if (folder / RUN).is_file() and (folder / SCENARIO).is_file():
            return str(folder / SCENARIO), "of the run it is in"
    shipped = list_resources("scenarios", SCENARIO_SUFFIXES)
    for folder in folders[:2]:
        if folder.name in shipped:
            return folder.name, f"named like the folder '{folder.name}'"
    return DEFAULT, "the default; --scenario gives another"


def show_looks(summary: LooksSummary, why: str, output: Output) -> None:
    """A single recording in all its numbers, or a library as a table.

    Args:
        summary: of what was looked at.
        why: this scenario, in words.
        output: to write to.
    """
    scenario = f"{summary.scenario} ({why}), segmentation {summary.segmentation}"
    if summary.library:
        output.say(f"scenario   {scenario}")
        output.print_table(library_table(summary.recordings))
        for look in summary.recordings:
            if look.refused is not None:
                output.say(look.line)
        return
    (look,) = summary.recordings
    output.say(look.line)
    if look.refused is not None and look.refused.remedy:
        output.say(f"  {look.refused.remedy}")
    facts = [("scenario", scenario), *look.facts()]
    width = max(len(name) for name, _ in facts)
    before = ""
    for name, text in facts:
        output.say(f"{'' if name == before else name:<{width}}  {text}")
        before = name
    if look.screws:
        output.print_table(screw_table(look))


def library_table(looks: tuple[LookSummary, ...]) -> Table:
    """A line for each recording: what is kept of it near each object, or why it is not used."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("recording", no_wrap=True)
    for name in (
        "samples",
        "duration",
        "guiding poses",
        "kept to",
        "turn kept of shown",
        "time kept",
    ):
        table.add_column(name, justify="right", no_wrap=True)
    for look in looks:
        row = (look.name, f"{look.samples:,}", f"{look.duration:.2f} s")
        if look.refused is not None:
            table.add_row(*row, "not used")
            continue
        cells = zip(*map(_cells, look.fidelity), strict=True)
        table.add_row(*row, *("\n".join(cell) for cell in cells))
    return table


def _cells(kept: Fidelity) -> tuple[str, str, str, str]:
    """An object's part of a library's line."""
    within = f"{kept.position * 1e3:.0f} mm, {kept.rotation:.2f} rad" if kept.guiding_poses else "-"
    return (
        f"{kept.guiding_poses} of the {kept.object}",
        within,
        f"{kept.turn_kept:.2f} of {kept.turn_shown:.2f} rad",
        f"{kept.time:.0%}",
    )


def screw_table(look: LookSummary) -> Table:
    """The screws of a recording in the order of time."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for name in ("screw", "of the", "from", "to", "angle", "translation", "pitch", "axis in W"):
        table.add_column(name, justify="left" if name == "of the" else "right", no_wrap=True)
    for number, screw in enumerate(look.screws, start=1):
        table.add_row(
            str(number),
            screw.object,
            f"{screw.start:.2f} s",
            f"{screw.end:.2f} s",
            f"{screw.angle:.3f} rad",
            f"{screw.translation:.3f} m",
            screw.pitch_words,
            ", ".join(f"{x:.2f}" for x in screw.axis),
        )
    return table
