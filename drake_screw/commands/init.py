"""``drake-screw init``: a scenario of one's own to begin with, copied or made for a robot."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from drake_screw.commands.options import VerboseOption
from drake_screw.commands.output import Output
from drake_screw.errors import DrakeScrewError, ScenarioError, unknown
from drake_screw.outputs import check_writable, writable

if TYPE_CHECKING:
    from drake_screw.onboarding.arms import FoundArm
    from drake_screw.robot import RobotConfig

EXAMPLE = "drake-screw init my_arm.urdf --output mine.yaml"

_SCHEMA = "# yaml-language-server: $schema="


def init(
    robot: Annotated[
        str,
        typer.Argument(
            metavar="ROBOT",
            help="A robot model's file (URDF, SDF, MJCF, xacro or model directives) or address "
            "(package://...), the name of a shipped model, or that of a shipped scenario, to be "
            "copied.",
        ),
    ] = "pouring",
    output: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Where to write it. Default: ROBOT.yaml, here."),
    ] = None,
    arm: Annotated[
        str | None, typer.Option(metavar="NAME", help="Which arm, of a robot that has several.")
    ] = None,
    task: Annotated[
        Literal["pouring", "scooping"], typer.Option(help="What the robot is to do.")
    ] = "pouring",
    table_height: Annotated[
        float | None,
        typer.Option(
            metavar="M", help="Height of the table over the robot's base. Default: found."
        ),
    ] = None,
    package: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=DIR", help="Where a package of the model is. May be repeated."),
    ] = None,
    xacro: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="An argument of xacro. May be repeated."),
    ] = None,
    srdf: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="SRDF file that says which links may touch."),
    ] = None,
    incomplete_shapes: Annotated[
        bool,
        typer.Option(
            "--incomplete-shapes", help="Go on where collision shapes of the robot cannot be had."
        ),
    ] = False,
    preview: Annotated[
        bool, typer.Option("--preview", help="Show the workcell in the browser.")
    ] = False,
    verbose: VerboseOption = False,
) -> None:
    """Write a scenario of your own, to change.

    For a robot's model it finds the arm, its hand, a table, a start and a work area, and says what
    it assumed; a picture of where the arm reaches lies beside the scenario. Of a shipped scenario
    it writes a copy. Every key is explained.
    """
    from drake_screw.resources import (
        MODEL_SUFFIXES,
        SCENARIO_SUFFIXES,
        list_resources,
        looks_like_path,
    )

    scenarios = list_resources("scenarios", SCENARIO_SUFFIXES)
    models = list_resources("models", MODEL_SUFFIXES)
    given = {
        "--arm": arm,
        "--table-height": table_height,
        "--package": package,
        "--xacro": xacro,
        "--srdf": srdf,
        "--incomplete-shapes": incomplete_shapes or None,
        "--preview": preview or None,
    }
    if robot in scenarios:
        for option, value in given.items():
            if value is not None:
                raise DrakeScrewError(
                    f"{option} is for a robot's model, and '{robot}' is a shipped scenario",
                    remedy=f"Leave it out, or give a model. Shipped models: {', '.join(models)}",
                )
        _copy(robot, output)
        return
    if robot not in models and not looks_like_path(robot, MODEL_SUFFIXES):
        message, remedy = unknown("scenario", robot, "what is shipped", scenarios)
        raise ScenarioError(
            message, remedy=f"{remedy}. Or a model: {', '.join(models)}, or the path of a file."
        )
    name = Path(robot).name
    for suffix in MODEL_SUFFIXES:
        name = name.removesuffix(suffix)
    file = _checked(output or Path(f"{name}.yaml"))
    check_writable(file, writable("--output"))
    out = Output()
    read = _read_as(robot, package or [], xacro or [], srdf)
    _make(read, file, arm, task, table_height, incomplete_shapes, preview, out)


def _read_as(
    model: str, packages: Sequence[str], xacro: Sequence[str], srdf: str | None
) -> RobotConfig:
    """A model with what it is to be read with.

    Raises:
        DrakeScrewError: an option is not of the form NAME=..., or there is no such folder or file.
    """
    from drake_screw.robot import RobotConfig

    folders = {k: Path(v).absolute() for k, v in _named(packages, "--package", "my_arm=../my_arm")}
    for name, folder in folders.items():
        if not folder.is_dir():
            raise DrakeScrewError(
                f"--package: there is no folder '{folder}'",
                remedy=f"Give the folder of package '{name}', in which its package.xml is.",
            )
    if srdf is not None and "://" not in srdf and not Path(srdf).is_file():
        raise DrakeScrewError(
            f"--srdf: there is no file '{srdf}'", remedy="Give the path of a robot's SRDF file."
        )
    arguments = dict(_named(xacro, "--xacro", "dof=7"))
    return RobotConfig(model, (), "", (), packages=folders, xacro=arguments, srdf=srdf)


def _named(texts: Sequence[str], option: str, example: str) -> Iterator[tuple[str, str]]:
    """Names and values of NAME=VALUE; also of NAME:=VALUE, as ROS has it."""
    for text in texts:
        name, equals, value = text.partition("=")
        name = name.removesuffix(":")
        if not equals or not name:
            raise DrakeScrewError(
                f"{option}: '{text}' is not NAME=VALUE", remedy=f"Write {option} {example}, say."
            )
        yield name, value


def _checked(file: Path) -> Path:
    """A file that a scenario can be written to.

    Raises:
        DrakeScrewError: it is there already, or not the name of one.
    """
    from drake_screw.resources import SCENARIO_SUFFIXES

    if file.suffix not in SCENARIO_SUFFIXES:
        raise DrakeScrewError(
            "not the name of a scenario file", remedy=f"Name it {file.stem}.yaml, say.", file=file
        )
    if file.exists():
        raise DrakeScrewError(
            "exists already; nothing is overwritten", remedy="Give another --output.", file=file
        )
    return file


def _copy(name: str, output: Path | None) -> None:
    from drake_screw.files import WRITABLE_OUTPUT, write_text, writing
    from drake_screw.resources import SCENARIO_SUFFIXES, find_resource

    file = output or Path(f"{name}.yaml")
    source = find_resource("scenarios", name, SCENARIO_SUFFIXES)
    text = scenario_copy(source.read_text(encoding="utf-8"), source.parent)
    with writing(_checked(file), WRITABLE_OUTPUT):
        write_text(file, text)
    out = Output()
    _say_what_next(f"written: {file}", file, out)


def _say_what_next(written: str, file: Path, out: Output) -> None:
    out.say(f"{written}; change it, then")
    out.say(f"  drake-screw check {file}")
    out.say(f"  drake-screw run {file}")


def _make(
    read: RobotConfig,
    file: Path,
    arm: str | None,
    task: str,
    table_height: float | None,
    incomplete_shapes: bool,
    preview: bool,
    out: Output,
) -> None:
    """Find a scenario for a robot, try it, write it with its picture, and say so."""
    from drake_screw.commands.countdown import Countdown
    from drake_screw.steps import Step

    with Countdown(out.console) as shown:
        from drake_screw.onboarding import assumptions, design, write_scenario

        def ask(arms: Sequence[FoundArm]) -> str:
            with shown.aside():
                return _ask(arms)

        shown(Step("looking for a scenario"))
        found = design(
            read,
            wanted_arm=arm,
            choose=ask if sys.stdin.isatty() else None,
            task=task,
            table_height=table_height,
            incomplete_shapes=incomplete_shapes,
            say=out.say,
        )
        shown(Step("trying it"))
        picture = write_scenario(found, file, f"drake-screw {' '.join(sys.argv[1:])}")
    out.say("assumed:")
    for line in assumptions(found):
        out.say(f"  {line}")
    _say_what_next(f"written: {file}, and where the arm reaches: {picture}", file, out)
    if preview:
        _show(file, out)


def _ask(arms: Sequence[FoundArm]) -> str:
    names = [arm.name for arm in arms]
    for found in arms:
        typer.echo(f"  {found.name}: {found.joints[0]} ... {found.joints[-1]}")
    return str(typer.prompt("which arm", default=names[0]))


def _show(file: Path, out: Output) -> None:
    """The workcell in Meshcat, until Enter is pressed."""
    from drake_screw.assembly.setup import Setup
    from drake_screw.runs.pictures import make_scene
    from drake_screw.scenario.loader import load_scenario
    from drake_screw.visualization.lifetime import page_meshcat

    setup = Setup(load_scenario(file))
    meshcat = page_meshcat("localhost")
    scene = make_scene(setup, meshcat)
    scene.show_suggestion(setup.area.middle)
    meshcat.Flush()
    out.say(f"the workcell is at {meshcat.web_url()}")
    if out.console.is_terminal:
        with suppress(EOFError, KeyboardInterrupt):
            out.console.input("the page stays until you press Enter ")


def scenario_copy(text: str, folder: Path) -> str:
    """A scenario's text, fit for any other folder.

    A line that names its schema for editors, by a path relative to the file, gets that path in
    full, and goes where there is no such file.

    Args:
        text: of the scenario.
        folder: that it comes from.
    """
    lines = []
    for line in text.splitlines(keepends=True):
        if line.startswith(_SCHEMA):
            schema = line.removeprefix(_SCHEMA).strip()
            if "://" not in schema:
                file = (folder / schema).resolve()
                if not file.is_file():
                    continue
                line = f"{_SCHEMA}{file.as_uri()}\n"
        lines.append(line)
    return "".join(lines)
