"""``drake-screw init`` and ``list``: what is shipped, and a copy of it to change."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from drake_screw import load_scenario
from drake_screw.commands.init import scenario_copy
from drake_screw.resources import list_resources
from tests.commands.conftest import Command


@pytest.mark.parametrize("name", list_resources("scenarios", [".yaml"]))
def test_a_copy_is_the_shipped_scenario_with_its_comments(command: Command, name: str) -> None:
    code, out, err = command("init", name)
    assert (code, err) == (0, "")
    file = Path(f"{name}.yaml")
    anywhere = {"source": None}
    copy, shipped = (load_scenario(x).model_copy(update=anywhere) for x in (file, name))
    assert copy == shipped
    assert file.read_text().count("#") > 20
    commands = [line.split() for line in out.splitlines()[1:]]
    assert commands == [["drake-screw", verb, str(file)] for verb in ("check", "run")]


def test_the_commands_it_names_work(command: Command) -> None:
    _, out, _ = command("init", "--output", "mine.yaml")
    check = out.splitlines()[1].split()[1:]
    code, out, _ = command(*check)
    assert code == 0
    assert "scenario   pouring" in out


def test_nothing_is_overwritten(command: Command) -> None:
    Path("pouring.yaml").write_text("mine")
    code, out, err = command("init")
    assert (code, out) == (2, "")
    assert err.startswith("error: pouring.yaml: exists already")
    assert Path("pouring.yaml").read_text() == "mine"


@pytest.mark.parametrize(
    ("args", "expected"),
    [
        (["puring"], "Did you mean 'pouring'"),
        (["--output", "mine.txt"], "Name it mine.yaml"),
        (["--output", "nowhere/mine.yaml"], "cannot be written"),
        (["pouring.yaml"], "Did you mean 'pouring'"),
    ],
)
def test_what_cannot_be_written_is_said(command: Command, args: list[str], expected: str) -> None:
    code, _, err = command("init", *args)
    assert code == 2
    assert expected in err
    assert list(Path().iterdir()) == []


def test_a_named_schema_is_found_from_anywhere_or_left_out(tmp_path: Path) -> None:
    text = "# one\n# yaml-language-server: $schema={}\nname: two\n"
    (tmp_path / "schema.json").write_text("{}")
    whole = scenario_copy(text.format("schema.json"), tmp_path)
    assert whole == text.format((tmp_path / "schema.json").as_uri())
    assert scenario_copy(text.format("missing.json"), tmp_path) == "# one\nname: two\n"
    web = text.format("https://example.org/schema.json")
    assert scenario_copy(web, tmp_path) == web


def test_what_is_shipped_is_listed(command: Command) -> None:
    code, out, err = command("list")
    assert (code, err) == (0, "")
    assert "pours into a bowl" in out
    assert "7 joints, iiwa_joint_1 ... iiwa_joint_7" in out
    code, out, err = command("list", "--json", "-")
    shipped = json.loads(out)
    assert [item["name"] for item in shipped["scenarios"]] == [
        "fetching",
        "pouring",
        "pouring_both",
        "pouring_iiwa",
        "pouring_panda",
        "pouring_paper",
        "pouring_ur5e",
        "scooping",
        "scooping_paper",
    ]
    models = {item["name"]: item for item in shipped["models"]}
    assert {"left_s0", "right_w2"} <= set(models["baxter"]["joints"])
    assert all(Path(item["file"]).is_file() for item in shipped["scenarios"] + shipped["models"])
    assert "scenarios" in err
