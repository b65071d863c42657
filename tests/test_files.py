"""Files and folders are there whole or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from drake_screw.files import file_hash, fresh_folder, write_folder, write_text


def test_a_fresh_folder_is_another_one_each_time(tmp_path: Path) -> None:
    folders = []
    for _ in range(3):
        folders.append(fresh_folder(tmp_path))
        assert not folders[-1].exists()
        folders[-1].mkdir()
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


def test_text_replaces_a_file_at_once(tmp_path: Path) -> None:
    write_text(tmp_path / "a", "één\n")
    write_text(tmp_path / "a", "twee\n")
    assert (tmp_path / "a").read_bytes() == b"twee\n"
    assert [f.name for f in tmp_path.iterdir()] == ["a"]
    (tmp_path / "b").write_bytes(b"abc")
    assert file_hash(tmp_path / "b").startswith("ba7816bf8f01cfea414140de5dae2223")
