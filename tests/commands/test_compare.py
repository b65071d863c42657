"""``drake-screw compare`` as a user meets it."""

from __future__ import annotations

import json
import re
import shutil
from html import unescape
from pathlib import Path

from tests.commands.conftest import Command
from tests.commands.test_json import check_keys
from tests.small_runs import finished_run

__all__ = ["finished_run"]


def test_words_page_and_json(command: Command, finished_run: Path) -> None:
    twin = Path(shutil.copytree(finished_run, "twin"))
    text = (twin / "scenario.yaml").read_text()
    wanted = text.replace("description: ", "description: <b>&", 1)
    assert wanted != text
    (twin / "scenario.yaml").write_text(wanted)
    code, out, err = command(
        "compare", finished_run, twin, "--html", "both.html", "--json", "both.json"
    )
    assert (code, err) == (0, "")
    result = json.loads(Path("both.json").read_text())
    check_keys("compare", result)
    assert [d["key"] for d in result["scenario"]] == ["description"]
    share = f"{result['runs'][0]['success']:.2%}"
    assert re.search(rf"^1 .* 0 +2 +2 +16 +{share}", out, re.MULTILINE)
    assert f"runs 1 and 2 share {result['shared'][0]['instances']:,} instances" in out
    assert "run 2: no certificate" in out
    page = Path("both.html").read_text(encoding="utf-8")
    assert page.count("data:image/svg+xml;base64,") == 2
    assert "<b>&" not in page
    assert "<b>&" in unescape(page)
    assert "http" not in re.sub(r"data:image[^\"]+", "", page)
    for row in result["regions"][0]["regions"]:
        assert f"{row['failures'][0]:,} / {row['samples'][0]:,}" in page


def test_wrong_input_is_told_in_one_message(command: Command, finished_run: Path) -> None:
    other = Path(shutil.copytree(finished_run, "other"))
    for args, words in (
        ([finished_run], "Give two run directories or more"),
        ([finished_run, "nowhere"], "error: nowhere: not a run directory"),
        ([other, "other/"], "given twice"),
        ([finished_run, other, "--html", "no/page.html"], "there is no folder 'no'"),
        ([finished_run, other, "--html", "x", "--json", "x"], "--html and --json name one file"),
    ):
        code, out, err = command("compare", *args)
        assert (code, out) == (2, "")
        assert words in err
        assert "Traceback" not in err
    assert [file.name for file in Path().iterdir()] == ["other"]
