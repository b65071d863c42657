"""Files and folders are there whole or not at all."""

from __future__ import annotations

import errno
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from drake_screw.errors import DrakeScrewError, RunDirectoryError, ScenarioError
from drake_screw.files import (
    appearing,
    file_hash,
    fresh_folder,
    make_folder,
    write_folder,
    write_text,
    writing,
)
from drake_screw.outputs import check_writable


def test_a_fresh_folder_is_another_one_each_time(tmp_path: Path) -> None:
    folders = []
    for _ in range(3):
        folders.append(fresh_folder(tmp_path))
        assert not list(folders[-1].iterdir())
    assert len(set(folders)) == 3
    assert {folder.parent for folder in folders} == {tmp_path}


def test_a_folder_that_cannot_be_filled_does_not_appear(tmp_path: Path) -> None:
    def fill(folder: Path) -> None:
        (folder / "half").write_text("half")
        raise RuntimeError

    write_folder(tmp_path / "out", lambda folder: write_text(folder / "whole", "first"))
    with pytest.raises(RuntimeError):
        write_folder(tmp_path / "out", fill)
    assert [f.name for f in (tmp_path / "out").iterdir()] == ["whole"]
    write_folder(tmp_path / "out", lambda folder: write_text(folder / "other", "second"))
    assert [f.name for f in (tmp_path / "out").iterdir()] == ["other"]
    assert [f.name for f in tmp_path.iterdir()] == ["out"]


FIRST = {"scenario": "what", "record": "state"}


def test_a_folder_is_made_where_there_is_nothing_or_an_empty_one(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    for new in (tmp_path / "a" / "b", tmp_path / "empty"):
        make_folder(new, "run", FIRST)
        assert {file.name: file.read_text() for file in new.iterdir()} == FIRST
    (tmp_path / "file").write_text("kept")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "scenario").write_text("kept")
    for taken in (tmp_path / "a", tmp_path / "a" / "b", tmp_path / "file", tmp_path / "mine"):
        with pytest.raises(RunDirectoryError, match="a run never overwrites anything") as caught:
            make_folder(taken, "run", FIRST)
        assert caught.value.file == taken
        assert "continue a run with --resume" in str(caught.value)
    assert (tmp_path / "file").read_text() == "kept"
    assert (tmp_path / "mine" / "scenario").read_text() == "kept"


def _interrupt_at(system_call: int, patch: pytest.MonkeyPatch, stop: Callable[[], object]) -> None:
    """Writing and renaming stop at one of the calls."""
    calls = 0

    def stopped_at(function: Callable[..., object]) -> Callable[..., object]:
        def call(*arguments: object) -> object:
            nonlocal calls
            calls += 1
            if calls == system_call:
                stop()
            return function(*arguments)

        return call

    patch.setattr(Path, "write_bytes", stopped_at(Path.write_bytes))
    patch.setattr(os, "replace", stopped_at(os.replace))


@pytest.mark.parametrize("system_call", range(1, 5))
def test_a_folder_that_a_killed_process_had_begun_can_be_made_again(
    system_call: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    new = tmp_path / "new"
    if (child := os.fork()) == 0:
        _interrupt_at(system_call, monkeypatch, lambda: os._exit(9))
        make_folder(new, "run", FIRST)
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 9
    assert not (new / "record").exists()
    assert list(new.iterdir())
    make_folder(new, "run", FIRST)
    assert {file.name: file.read_text() for file in new.iterdir()} == FIRST


@pytest.mark.parametrize("system_call", range(1, 5))
def test_of_a_folder_that_was_interrupted_before_it_had_begun_nothing_stays(
    system_call: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        _interrupt_at(system_call, patch, interrupted)
        with pytest.raises(KeyboardInterrupt):
            make_folder(tmp_path / "new", "run", FIRST)
    assert not list(tmp_path.iterdir())


def test_of_a_folder_that_cannot_be_filled_nothing_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_room(new: str, old: Path) -> None:
        if old.name == "record":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "replace", no_room)
    with pytest.raises(OSError, match="No space left"):
        make_folder(tmp_path / "new", "run", FIRST)
    assert not list(tmp_path.iterdir())


def test_what_the_system_refuses_is_an_error_with_a_remedy(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    place = tmp_path / "file" / "below"
    with pytest.raises(ScenarioError) as caught, writing(place, "Choose another.", ScenarioError):
        write_text(place, "text")
    assert str(caught.value) == f"{place}: cannot be written: Not a directory\n  Choose another."
    with pytest.raises(DrakeScrewError, match="cannot be written: quota"), writing(place, ""):
        raise OSError("quota")


def test_text_replaces_a_file_at_once(tmp_path: Path) -> None:
    write_text(tmp_path / "a", "één\n")
    write_text(tmp_path / "a", "twee\n")
    assert (tmp_path / "a").read_bytes() == b"twee\n"
    assert [f.name for f in tmp_path.iterdir()] == ["a"]
    (tmp_path / "b").write_bytes(b"abc")
    assert file_hash(tmp_path / "b").startswith("ba7816bf8f01cfea414140de5dae2223")


def test_a_link_stays_and_what_it_leads_to_is_written(tmp_path: Path) -> None:
    (tmp_path / "kept").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "kept" / "file")
    write_text(tmp_path / "link", "text")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "kept" / "file").read_text() == "text"
    assert [file.name for file in (tmp_path / "kept").iterdir()] == ["file"]


def test_of_a_link_that_leads_nowhere_the_folder_that_lacks_is_named(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "none" / "file")
    with pytest.raises(DrakeScrewError, match=f"there is no folder '{tmp_path / 'none'}'"):
        check_writable(tmp_path / "link", "")


def test_what_is_no_file_is_left_alone(tmp_path: Path) -> None:
    """A file in the place of /dev/null, say, would be a fault of the whole machine."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to(tmp_path / "pipe")
    for name in ("pipe", "link"):
        place = tmp_path / name
        with pytest.raises(DrakeScrewError, match="it is a device or a pipe"), writing(place, ""):
            write_text(place, "text")
        with pytest.raises(DrakeScrewError, match="it is a device or a pipe"):
            check_writable(place, "")
        assert place.is_fifo()
    assert len(list(tmp_path.iterdir())) == 2


def test_a_result_does_not_take_the_place_of_what_a_run_or_a_study_is(tmp_path: Path) -> None:
    check_writable(tmp_path / "scenario.yaml", "")
    (tmp_path / "scenario.yaml").touch()
    check_writable(tmp_path / "scenario.yaml", "")
    (tmp_path / "run.json").touch()
    (tmp_path / "run.html").touch()
    for name in ("run.json", "scenario.yaml"):
        with pytest.raises(DrakeScrewError, match="a run or a study keeps there what it is"):
            check_writable(tmp_path / name, "")
    check_writable(tmp_path / "run.html", "")
    check_writable(tmp_path / "study.json", "")


@pytest.fixture
def _small_files() -> Iterator[None]:
    """Files may have 4,000 bytes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4000, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.usefixtures("_small_files")
def test_a_limit_on_files_is_told_with_what_is_needed(tmp_path: Path) -> None:
    file = tmp_path / "large"
    with pytest.raises(RunDirectoryError) as caught, writing(file, "Ask for more."):
        write_text(file, "x" * 70_000)
    assert caught.value.message == (
        "cannot be written: File too large; the limit is 4 kB a file (ulimit -f); "
        "70 kB are needed for large"
    )
    assert not list(tmp_path.iterdir())


def test_a_file_that_is_being_written_is_left_to_who_writes_it(tmp_path: Path) -> None:
    file = tmp_path / "out.csv"
    with appearing(file) as part:
        part.write_text("first")
        with pytest.raises(FileExistsError, match="another process is writing it just now"):
            write_text(file, "second")
        write_text(file, "shared", shared=True)
        assert file.read_text() == "shared"
    assert file.read_text() == "first"
    write_text(file, "third")
    assert file.read_text() == "third"
    assert list(tmp_path.iterdir()) == [file]


def test_what_a_killed_process_left_is_written_over(tmp_path: Path) -> None:
    file = tmp_path / "out.csv"
    code = (
        "import os, signal, sys\nfrom pathlib import Path\n"
        "from drake_screw.files import appearing\n"
        "with appearing(Path(sys.argv[1])) as part:\n"
        "    part.write_text('half'); os.kill(os.getpid(), signal.SIGKILL)"
    )
    done = subprocess.run([sys.executable, "-c", code, str(file)], check=False)
    assert done.returncode == -signal.SIGKILL
    assert [each.name for each in tmp_path.iterdir()] == [".out.csv.part"]
    write_text(file, "whole")
    assert file.read_text() == "whole"
    assert list(tmp_path.iterdir()) == [file]
