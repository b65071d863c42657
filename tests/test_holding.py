"""One process at a time works in a folder, and a killed one does not keep it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from drake_screw.errors import RunDirectoryError
from drake_screw.holding import LOCK, holding

HOLD = """
import sys, time
from pathlib import Path
from drake_screw.holding import holding
with holding(Path(sys.argv[1]), "run"):
    print("held", flush=True)
    time.sleep(60)
"""


def test_another_process_is_told_who_holds_it_and_death_lets_go(tmp_path: Path) -> None:
    other = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)], stdout=subprocess.PIPE, text=True
    )
    assert other.stdout is not None
    assert other.stdout.readline() == "held\n"
    expected = rf"another process is at work on this run: process {other.pid} on .*, since \d"
    with pytest.raises(RunDirectoryError, match=expected) as caught, holding(tmp_path, "run"):
        pass
    assert caught.value.file == tmp_path
    os.kill(other.pid, signal.SIGKILL)
    other.wait()
    assert (tmp_path / LOCK).exists()
    with holding(tmp_path, "run"):
        pass
    assert not list(tmp_path.iterdir())


def test_it_is_let_go_whatever_happens_and_may_be_held_again(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), holding(tmp_path, "study"):
        raise ZeroDivisionError
    with holding(tmp_path, "study"):
        assert [file.name for file in tmp_path.iterdir()] == [LOCK]
        with pytest.raises(RunDirectoryError, match=f"process {os.getpid()} "):
            holding(tmp_path, "study").__enter__()
    with holding(tmp_path, "study"):
        pass


def test_a_file_that_was_removed_meanwhile_is_no_lock(tmp_path: Path, monkeypatch) -> None:
    """Whoever waits at the open file of one that has just ended must not share with a third."""
    open_ = os.open
    left = [1]

    def opened(file, *args):  # type: ignore[no-untyped-def]
        lock = open_(file, *args)
        if left and Path(file).name == LOCK:
            left.pop()
            os.unlink(file)
        return lock

    monkeypatch.setattr(os, "open", opened)
    with holding(tmp_path, "run"):
        assert (tmp_path / LOCK).exists()
        with pytest.raises(RunDirectoryError):
            holding(tmp_path, "run").__enter__()


def test_a_folder_that_is_gone_is_an_error(tmp_path: Path) -> None:
    with (
        pytest.raises(RunDirectoryError, match="cannot be written: No such file"),
        holding(tmp_path / "gone", "run"),
    ):
        pass
