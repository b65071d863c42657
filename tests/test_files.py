"""Files and folders are there whole or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from drake_screw.errors import DrakeScrewError, RunDirectoryError, ScenarioError
from drake_screw.files import (
    file_hash,
    fresh_folder,
    make_folder,
    write_folder,
    write_text,
    writing,
)


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


def test_a_folder_is_made_where_there_is_nothing_or_an_empty_one(tmp_path: Path) -> None:
    make_folder(tmp_path / "a" / "b", "run")
    make_folder(tmp_path / "a" / "b", "run")
    (tmp_path / "file").write_text("kept")
    for taken in (tmp_path / "a", tmp_path / "file"):
        with pytest.raises(RunDirectoryError, match="a run never overwrites anything") as caught:
            make_folder(taken, "run")
        assert caught.value.file == taken
        assert "continue a run with --resume" in str(caught.value)
    assert (tmp_path / "file").read_text() == "kept"


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
