"""Whatever ends the program from outside interrupts what it does."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from drake_screw.commands.signals import INTERRUPTED, Verbs, interruptible
from tests.commands.conftest import QUICK

ENDINGS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)

TWICE = """
import os, signal
from drake_screw.commands.signals import interruptible
with interruptible():
    try:
        os.kill(os.getpid(), signal.SIGTERM)
    except KeyboardInterrupt:
        print("once", flush=True)
    os.kill(os.getpid(), signal.SIGINT)
    print("never")
"""


@pytest.mark.parametrize("ending", ENDINGS)
def test_each_interrupts_and_what_was_there_before_is_there_again(ending: signal.Signals) -> None:
    before = [signal.getsignal(each) for each in ENDINGS]
    with pytest.raises(KeyboardInterrupt), interruptible():
        signal.raise_signal(ending)
    assert [signal.getsignal(each) for each in ENDINGS] == before


def test_what_is_ignored_stays_so() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with interruptible():
            os.kill(os.getpid(), signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)


def test_the_second_ends_it_at_once_without_a_word() -> None:
    done = subprocess.run(
        [sys.executable, "-c", TWICE], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (INTERRUPTED, "once\n", "")


SHARED = """
import os, signal, threading, time
from tests.commands.test_signals import wait
from drake_screw.commands.signals import interruptible
from drake_screw.sharing import Crew

def twice():
    os.kill(os.getpid(), signal.SIGINT)
    os.kill(os.getpid(), signal.SIGTERM)

if __name__ == "__main__":
    with interruptible(), Crew(dict, 2) as crew:
        for place, _ in crew.share(wait, [0, 0, 5, 5, 5]):
            if place == 1:
                threading.Thread(target=twice).start()
"""


ONCE = SHARED.replace("os.kill(os.getpid(), signal.SIGTERM)", "pass").replace("5, 5, 5", "900, 900")


def test_nobody_waits_for_what_processes_are_at(tmp_path: Path) -> None:
    """The first of two long jobs has begun when the work is interrupted."""
    done = shared(tmp_path, ONCE, timeout=300)
    assert done.returncode != 0
    assert done.stderr.splitlines()[-1] == "KeyboardInterrupt"
    assert "Broken" not in done.stderr


def shared(folder: Path, text: str, timeout: float | None = None):
    """What a script comes to that shares work out."""
    script = folder / "shared.py"
    script.write_text(text)
    return subprocess.run(
        [sys.executable, str(script)],
        capture_output=True,
        text=True,
        check=False,
        timeout=timeout,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])},
    )


def wait(tool: dict, seconds: float) -> None:
    time.sleep(seconds)


def test_nor_is_a_word_said_of_what_its_processes_shared(tmp_path: Path) -> None:
    """Both signals come at once; what it leaves is removed by a process that outlives it."""
    done = shared(tmp_path, SHARED)
    assert (done.returncode, done.stdout, done.stderr) == (INTERRUPTED, "", "")


def verbs() -> typer.Typer:
    app = typer.Typer(cls=Verbs)

    @app.command()
    def press() -> None:
        raise KeyboardInterrupt

    @app.command()
    def ask() -> None:
        typer.prompt("which arm")

    @app.command()
    def load() -> None:
        """As native code does, when it is interrupted while it is loaded."""
        try:
            signal.raise_signal(signal.SIGTERM)
        except KeyboardInterrupt:
            raise ImportError("initialization failed") from None

    @app.command()
    def speak() -> None:
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            print("carry on")
            raise typer.Exit(INTERRUPTED) from None

    @app.command()
    def fail() -> None:
        raise ImportError("no such module")

    return app


@pytest.mark.parametrize("verb", ["press", "ask", "load"])
def test_a_verb_that_is_interrupted_says_so_in_a_line(verb: str) -> None:
    with interruptible():
        done = CliRunner().invoke(verbs(), [verb])
    assert done.exit_code == INTERRUPTED
    assert done.stderr.splitlines()[-1] == "interrupted"
    assert "Abort" not in done.output


def test_a_verb_with_better_words_has_the_last() -> None:
    with interruptible():
        done = CliRunner().invoke(verbs(), ["speak"])
    assert (done.exit_code, done.output) == (INTERRUPTED, "carry on\n")


def test_what_fails_by_itself_was_not_interrupted() -> None:
    with interruptible():
        done = CliRunner().invoke(verbs(), ["fail"])
    assert isinstance(done.exception, ImportError)


@pytest.mark.slow
def test_a_run_that_is_terminated_says_so_and_goes_on(tmp_path: Path) -> None:
    run = [sys.executable, "-m", "drake_screw", "run"]
    folder = tmp_path / "run"
    with subprocess.Popen(
        [*run, "pouring", *QUICK, "--set", "coverage.strategy=naive_pac", "--output", str(folder)],
        stdout=subprocess.PIPE,
        text=True,
    ) as going:
        while not list(folder.glob("demonstrations/*")):
            time.sleep(0.05)
        going.terminate()
        assert going.wait(60) == INTERRUPTED
        assert going.stdout is not None
        assert "interrupted; carry on with" in going.stdout.read()
    assert json.loads((folder / "run.json").read_text())["status"] == "interrupted"
    done = subprocess.run([*run, "--resume", str(folder), "-q"], check=False, capture_output=True)
    assert done.returncode == 0, done.stderr
    assert json.loads((folder / "run.json").read_text())["status"] == "certified"
