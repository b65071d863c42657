"""A process that is given broken inputs, one after another, and says what became of each."""

from __future__ import annotations

import io
import os
import re
import resource
import shutil
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
from soak_inputs import KINDS

MOST_LINES, MOST_CHARACTERS = 60, 4000
"""Of a message. Every problem of a scenario has a line or two."""

MEMORY = 8 * 2**30
"""Bytes that a process may have."""

CARRIED_ON = ("run/run.json", "run/run.log", "study/study.json", "study/runs.csv")
"""Files that may change, whole, before what is carried on turns out to be damaged."""

REFUSED, ACCEPTED, ENDED = "refused", "accepted", "ended"
"""Exit code 2 with one message; 0, since what was broken does not matter or is still right; 1."""

FAULTS = ("traceback", "crash", "hang", "exit code", "message", "nameless", "warning", "left")
"""A traceback; the process died; no end; another code; no message, several, or a long one; one that
names nothing of what was given; Python's warnings; files left by what was refused."""


def serve(pipe: Connection, seed: int, originals: Path) -> None:
    """Break inputs and call the program with them, until the pipe ends.

    Args:
        pipe: takes (kind, index), and is given a verdict of each.
        seed: of all of them; an input depends on (seed, kind, index) alone.
        originals: what is broken.
    """
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _prepare()
    while True:
        try:
            pipe.send(_judged(*pipe.recv(), seed, originals))
        except (EOFError, BrokenPipeError):
            return


def _prepare() -> None:
    """Leave out what costs most of the time and is no part of the question.

    The command line is put together once, and `check` ends before it plans, for seconds, with what
    is right.
    """
    from typer.main import get_command

    from drake_screw import cli
    from drake_screw.assembly import preview

    cli.app = get_command(cli.app)  # type: ignore[assignment]
    preview._plans_per_second = lambda setup, tell: (None, None)


def _judged(kind: str, index: int, seed: int, originals: Path) -> dict[str, Any]:
    rng = np.random.default_rng([seed, list(KINDS).index(kind), index])
    home, began = os.getcwd(), time.process_time()
    parent = Path(tempfile.mkdtemp(prefix="soak_"))  # what .. is, with nothing else in it
    folder = parent / "here"
    folder.mkdir()
    os.chdir(folder)
    try:
        arguments = KINDS[kind][1](rng, originals)
        names = [str(parent), *_names(arguments)] if kind != "command line" else [""]
        before = _listing(folder)
        code, printed, why = call(arguments)
        changed = [str(f) for f, stat in _listing(folder).items() if before.get(f) != stat]
        if "--resume" in arguments:  # what is carried on says so, and drops what is damaged
            changed = [name for name in changed if name not in CARRIED_ON]
    finally:
        os.chdir(home)
        shutil.rmtree(parent, ignore_errors=True)
    verdict = "traceback" if why else verdict_of(code, printed, changed, names)
    seconds = round(time.process_time() - began, 3)
    found: dict[str, Any] = {"kind": kind, "index": index, "verdict": verdict, "seconds": seconds}
    if verdict in FAULTS:
        shown = [a if len(a) < 300 else f"{a[:300]}... {len(a)}" for a in arguments]
        found |= {"arguments": shown, "code": code, "printed": printed[-3000:], "left": changed[:9]}
        found |= {"why": why[-3000:]}
    return found


def call(arguments: list[str]) -> tuple[int, str, str]:
    """Exit code, standard error, and the traceback of what was not caught."""
    from drake_screw.cli import main

    sys.argv, why = ["drake-screw", *arguments], ""
    with _captured() as printed:
        try:
            main()
            code = 0
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else int(end.code is not None)
        except BaseException:
            code, why = 1, traceback.format_exc()
    return code, printed.getvalue(), why


@contextmanager
def _captured() -> Iterator[io.StringIO]:
    """Standard error, that of C++ included; standard output goes nowhere."""
    text, outer, kept = io.StringIO(), (sys.stdout, sys.stderr), (os.dup(1), os.dup(2))
    with tempfile.TemporaryFile() as file, open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(file.fileno(), 2)
        sys.stdout = io.TextIOWrapper(os.fdopen(os.dup(1), "wb"), encoding="utf-8")
        sys.stderr = io.TextIOWrapper(
            os.fdopen(os.dup(2), "wb"),
            encoding="utf-8",
            write_through=True,
            errors="backslashreplace",
        )
        try:
            yield text
        finally:
            for stream in (sys.stdout, sys.stderr):
                stream.close()
            sys.stdout, sys.stderr = outer
            for number, old in zip((1, 2), kept, strict=True):
                os.dup2(old, number)
                os.close(old)
            file.seek(0)
            text.write(file.read().decode("utf-8", "replace"))


def verdict_of(code: int, printed: str, changed: list[str], names: Sequence[str]) -> str:
    """What a call that ended by itself came to.

    Args:
        code: exit code.
        printed: to standard error.
        changed: files that are new, or not what they were.
        names: one of which the message has to name.
    """
    if "Traceback (most recent" in printed or "Exception ignored" in printed:
        return "traceback"
    if re.search(r"^\S+:\d+: \w*Warning: ", printed, re.M):
        return "warning"
    if code in (0, 1):
        return ENDED if code else ACCEPTED
    if code != 2:
        return "exit code"
    usage = printed.startswith("Usage: ")
    start = printed.find("error: ")
    if usage:
        return REFUSED
    message = printed[start:]
    errors = re.findall(r"^error: ", printed, re.M)
    if len(errors) != 1 or message.count("\n") > MOST_LINES or len(message) > MOST_CHARACTERS:
        return "message"
    if not any(name in message for name in names):
        return "nameless"
    return "left" if changed else REFUSED


def _names(arguments: list[str]) -> Iterator[str]:
    yield from (
        "--set",
        "--object",
        "recording.yaml",
        "jug.obj",
        "part.stl",
        "arm.sdf",
        "'part'",
        "'jug'",
        "'os:system'",
        "error: /: ",
    )
    for argument in arguments[1:]:
        if not argument.startswith("--"):
            parts = argument.split("=")
            yield from parts
            yield from (
                os.path.abspath(os.path.expanduser(p)) for p in parts if re.match(r"~|\.", p)
            )


def _listing(folder: Path) -> dict[Path, tuple[int, int]]:
    """Size and time of each file and folder."""
    found = {}
    for place, folders, files in os.walk(folder):
        for name in (*folders, *files):
            stat = os.lstat(os.path.join(place, name))
            is_folder = name in folders
            found[Path(place, name).relative_to(folder)] = (
                (0, 0) if is_folder else (stat.st_size, stat.st_mtime_ns)
            )
    return found
