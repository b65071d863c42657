"""The page that leads from a log to a certificate: all of it runs, and says what the page shows."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

from drake_screw.cli import app
from tests.docs.test_examples import ROOT, blocks

PAGE = ROOT / "docs" / "from_a_log.md"
FENCE = re.compile(r"^```(sh|python|)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_a_log_becomes_a_certificate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    out = ""
    for kind, text in FENCE.findall(PAGE.read_text()):
        if kind == "python":
            exec(compile(text, str(PAGE), "exec"), {})
            out = (tmp_path / "log.csv").read_text()
        elif kind == "sh":
            out = ""
            for line in text.splitlines():
                done = CliRunner().invoke(app, shlex.split(line)[1:])
                assert done.exit_code == 0, f"{line}\n{done.output}"
                out += done.output
        else:
            for line in text.splitlines():
                assert line in out, f"{line!r} is not in:\n{out}"
    assert (tmp_path / "my_run" / "run.json").exists()
    assert (tmp_path / "looks.html").exists()
    log, mapping = tmp_path / "log.csv", tmp_path / "recording.yaml"
    done = CliRunner().invoke(app, ["import", str(log), "--dry-run", "--object", "bowl=1.05,0.75"])
    mapping.write_text(done.output[done.output.index("format: table") :])
    last = re.findall(r"`(drake-screw run [^`]* log\.csv)`", PAGE.read_text())
    (line,) = last
    check = ["check", "pouring", "--set", f"teacher={{kind: recorded, folder: {log}}}"]
    assert "recorded: 1 recording" in CliRunner().invoke(app, check).output
    assert line.split()[-2] == "--demonstrations"


def test_what_it_says_is_said() -> None:
    """The words of refusals in the table are the program's."""
    rows = re.findall(r"^\| (?!it says|---)(.*?) \|", PAGE.read_text(), re.MULTILINE)
    source = "\n".join(file.read_text() for file in (ROOT / "drake_screw").rglob("*.py"))
    assert len(rows) >= 5
    source = re.sub(r"[\"\\]\s*\n\s*f?\"", "", source)  # a text over several lines
    for words in rows:
        for part in re.split(r"\.\.\.|`[^`]*`|\bbowl\b", words):
            assert part.strip(" ,?") in source, part


def test_its_python_is_run_with_that_of_all_pages() -> None:
    assert len(list(blocks(PAGE))) == 1
