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

from drake_screw.commands.signals import INTERRUPTED, interruptible
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
