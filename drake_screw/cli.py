"""The ``drake-screw`` command, made of the verbs in `drake_screw.commands`."""

from __future__ import annotations

import logging
import os
import sys
import time
from collections.abc import Callable
from typing import Annotated

import typer
from rich.console import Console

from drake_screw.commands import (
    check,
    compare,
    evaluate,
    execute,
    export,
    import_,
    init,
    inspect,
    listing,
    look,
    report,
    run,
    select,
    study,
)
from drake_screw.commands.any_console import any_console
from drake_screw.commands.collector import collect_seldom
from drake_screw.commands.instance_option import InstanceCommand
from drake_screw.commands.log import set_up_logging
from drake_screw.commands.options import VerboseOption
from drake_screw.commands.signals import Verbs, interruptible
from drake_screw.errors import DrakeScrewError, shortened

BAD_INPUT = 2
"""Exit code."""

_VERBS: dict[str, tuple[Callable[..., None], str]] = {
    "init": (init.init, init.EXAMPLE),
    "list": (listing.list_shipped, listing.EXAMPLE),
    "check": (check.check, check.EXAMPLE),
    "import": (import_.import_, import_.EXAMPLE),
    "look": (look.look, look.EXAMPLE),
    "run": (run.run, run.EXAMPLE),
    "report": (report.report, report.EXAMPLE),
    "compare": (compare.compare, compare.EXAMPLE),
    "inspect": (inspect.inspect, inspect.EXAMPLE),
    "execute": (execute.execute, execute.EXAMPLE),
    "export": (export.export, export.EXAMPLE),
    "evaluate": (evaluate.evaluate, evaluate.EXAMPLE),
    "select": (select.select, select.EXAMPLE),
    "study": (study.study, study.EXAMPLE),
}

_OF_AN_INSTANCE = ("execute", "export")

_log = logging.getLogger(__name__)

app = typer.Typer(
    name="drake-screw",
    cls=Verbs,
    help="Manipulation plans from few demonstrations: measure how much of a work area they cover, "
    "and learn where to give the next one.",
    epilog="Begin with:  drake-screw run pouring",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 80},
)
for _name, (_verb, _example) in _VERBS.items():
    _class = InstanceCommand if _name in _OF_AN_INSTANCE else None
    app.command(_name, cls=_class, epilog=f"Example:  {_example}")(_verb)


@app.callback(invoke_without_command=True)
def _options(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", help="Print the version; with -v, those of Drake etc. too.")
    ] = False,
    verbose: VerboseOption = False,
) -> None:
    if version:
        for line in _versions(verbose):
            print(line)
        raise typer.Exit()
    if context.invoked_subcommand is None:
        print(context.get_help())


def _versions(verbose: bool) -> list[str]:
    from importlib.metadata import version

    others = ("drake", "numpy", "numba") if verbose else ()
    return [f"{name} {version(name)}" for name in ("drake-screw", *others)]


def main() -> None:
    """Run the command; bad input prints one message and ends with exit code 2."""
    collect_seldom()
    any_console()
    set_up_logging()
    began = time.perf_counter()
    try:
        with interruptible():
            app()
    except DrakeScrewError as error:
        _log.debug("raised here:", exc_info=True)
        _complain(str(error) if _is_somewhere() else _NOWHERE)
        sys.exit(BAD_INPUT)
    except (OSError, RuntimeError) as error:  # of the system, that nobody has better words for
        _log.debug("raised here:", exc_info=True)
        if not _is_somewhere():
            _complain(_NOWHERE)
        elif isinstance(error, OSError):
            place = "" if error.filename is None else f"{error.filename}: "
            _complain(f"{place}{error.strerror or error}")
        else:
            raise
        sys.exit(BAD_INPUT)
    finally:
        _log.debug("ended after %.1f s", time.perf_counter() - began)


_NOWHERE = """the folder that you are in does not exist any more
  Change to one that does: cd FOLDER"""


def _is_somewhere() -> bool:
    """Whether the current folder exists; Drake says in a RuntimeError that it does not."""
    try:
        os.getcwd()
    except FileNotFoundError:
        return False
    return True


def _complain(text: str) -> None:
    console = Console(stderr=True, soft_wrap=True)
    console.print(f"error: {shortened(text)}", style="red", markup=False, highlight=False)


if __name__ == "__main__":
    main()
