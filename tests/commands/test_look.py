"""``drake-screw look``: what recordings hold."""

from __future__ import annotations

import base64
import json
import re
import shutil
from html import unescape
from pathlib import Path

import numpy as np
import pytest

from drake_screw.assembly.setup import Setup
from drake_screw.scenario.loader import load_scenario
from tests.commands.conftest import Command
from tests.commands.test_json import PAGE, check_keys

FAITHFUL = ["--set", "segmentation={method: faithful}"]
PUBLISHED = ["--set", "segmentation={method: published}"]


@pytest.fixture
def spoilt(library: Path, tmp_path: Path) -> Path:
    """The library, with the bowl of demo_02 where the end effector never comes."""
    copy = Path(shutil.copytree(library, tmp_path / "spoilt"))
    file = copy / "demo_02" / "object_poses.csv"
    X_WO = np.loadtxt(file, delimiter=",")
    X_WO[1, 3] -= 0.8
    np.savetxt(file, X_WO, delimiter=",")
    return copy


def no_network(page: str) -> bool:
    """Nothing is loaded: neither by the page nor by the page of the scene within it."""
    loads = r"<(script|img|link|iframe)[^>]*\s(src|href)\s*=\s*[\"'](?!data:)"
    inner = [unescape(text) for text in re.findall(r'srcdoc="([^"]*)"', page)]
    return not any(re.search(loads, text) for text in (page, *inner))


@pytest.mark.parametrize("method", [PUBLISHED, FAITHFUL])
def test_a_recording_in_words(command: Command, library: Path, method: list[str]) -> None:
    code, out, err = command("look", library / "demo_02", *method)
    assert (code, err) == (0, "")
    setup = Setup(load_scenario("pouring", method[1:]))
    recordings = {r.name: r for r in setup.recordings(library)}
    look = setup.look(recordings["demo_02"])
    first, *lines = out.splitlines()
    assert first == str(look)
    assert f"{len(look.t):,} in {look.recording.duration:.2f} s" in out
    assert "pouring (the default; --scenario gives another)" in out
    assert f"bowl        {look.distance.min():.3f} m from the end effector at the nearest" in out
    assert f"{look.margin.min():.3f} rad from its" in out
    assert re.search(
        r"^dropped +\d+% of the time, outside the region of interest: 0\.00", out, re.M
    )
    table = lines[next(i for i, line in enumerate(lines) if line.startswith("screw")) + 1 :]
    assert len(table) == len(look.screws)
    assert f"{float(look.screws[-1].screw.angle):.3f} rad" in table[-1]


def test_a_library_is_a_table_with_what_is_refused(command: Command, spoilt: Path) -> None:
    code, out, _ = command("look", spoilt, *FAITHFUL, "--html", "page.html")
    assert code == 0
    assert re.search(
        r"^demo_01 +[\d,]+ +[\d.]+ s +\d+ of the bowl +\d+ mm, 0\.\d\d rad +[\d.]+ of [\d.]+ rad",
        out,
        re.MULTILINE,
    )
    assert re.search(r"^demo_02 +[\d,]+ +[\d.]+ s +not used *$", out, re.MULTILINE)
    why = "demo_02: not used: no motion is kept: the end effector comes no nearer than"
    assert why in out
    page = Path("page.html").read_text(encoding="utf-8")
    assert re.findall(r'<section id="(\w+)">', page) == ["demo_01", "demo_02", "demo_03"]
    assert page.count("no motion is kept: the end effector comes no nearer than") == 2
    assert 'href="#demo_02"' in page
    assert "<iframe" not in page
    assert no_network(page)
    pictures = re.findall(r'src="data:image/svg\+xml;base64,([^"]*)"', page)
    assert len(pictures) == 4 + 3 + 4
    assert all(b"<svg" in base64.b64decode(picture) for picture in pictures)


def test_the_page_of_a_folder_with_one_recording_has_the_scene(
    command: Command, library: Path
) -> None:
    shutil.copytree(library / "demo_01", "mine/demo_01")
    code, _, _ = command("look", "mine", "--html", "page.html", *FAITHFUL)
    assert code == 0
    assert len(re.findall(r'srcdoc="', Path("page.html").read_text())) == 1


def test_the_page_of_one_recording_has_the_scene(command: Command, library: Path) -> None:
    code, out, _ = command("look", library / "demo_01", "--html", "page.html")
    assert (code, "written: page.html" in out) == (0, True)
    page = Path("page.html").read_text(encoding="utf-8")
    (scene,) = re.findall(r'srcdoc="([^"]*)"', page)
    assert len(scene) > 1e6
    assert "<body" in unescape(scene)
    assert no_network(page)


def test_json_has_what_is_promised(command: Command, spoilt: Path) -> None:
    code, _, _ = command("look", spoilt, *FAITHFUL, "--json", "looks.json")
    result = json.loads(Path("looks.json").read_text())
    assert code == 0
    check_keys("look", result)
    told = PAGE.read_text().split("\nOf each recording:\n\n")[1].split("\n\n")[0]
    row = {
        key: text
        for keys, text in re.findall(r"^- (`.+?`): ((?:.|\n  )+)", told, re.MULTILINE)
        for key in re.findall(r"`(\w+)`", keys)
    }
    used, refused, _ = result["recordings"]
    assert set(row) == set(used)
    for key in ("joints", "objects", "screws", "dropped", "deviations"):
        assert [name for name in used[key][0] if f"`{name}`" not in row[key]] == [], key
    assert [name for name in refused["refused"] if f"`{name}`" not in row["refused"]] == []
    assert (result["segmentation"], result["library"], used["refused"]) == ("faithful", True, None)
    assert (refused["refused"]["reason"], refused["screws"]) == ("far", [])
    (kept,), (away,) = used["fidelity"], used["deviations"]
    assert max(away["position"]) == pytest.approx(kept["position"])
    assert max(away["rotation"]) == pytest.approx(kept["rotation"])
    assert len(used["screws"]) == kept["guiding_poses"] - 1
    alone = command("look", spoilt / "demo_01", *FAITHFUL, "--json", "-")
    assert json.loads(alone[1])["recordings"][0] == used
    assert "demo_01: " in alone[2]


def test_the_scenario_is_that_of_the_run(command: Command, certified: Path) -> None:
    code, out, _ = command("look", certified / "demonstrations")
    assert (code, "pouring (of the run it is in)" in out) == (0, True)
    folder = next((certified / "demonstrations").iterdir())
    assert "(of the run it is in)" in command("look", folder)[1]
    assert "scooping (as given)" in command("look", folder, "--scenario", "scooping")[1]


def test_or_the_one_named_like_the_folder(command: Command, library: Path) -> None:
    shutil.copytree(library, "scooping")
    for place in ("scooping", "scooping/demo_01"):
        assert "scooping (named like the folder 'scooping')" in command("look", place)[1]


def test_recordings_of_another_robot(command: Command, library: Path) -> None:
    code, out, _ = command("look", library / "demo_01", "--scenario", "pouring_iiwa", *FAITHFUL)
    assert code == 0
    assert re.search(r"^recorded on +baxter$", out, re.MULTILINE)
    assert "left_w" in out


@pytest.mark.parametrize(
    ("args", "expected"),
    [
        (["nowhere"], "nowhere: no such recording or library"),
        (["."], "no recordings here"),
        (["{library}/demo_01/joint_angles.csv"], "Give the folder it stands in: "),
        (["{broken}/log.csv"], "library/log.csv --output recordings"),
        (["{library}", "--scenario", "puring"], "Did you mean 'pouring'"),
        (["{library}", "--set", "segmentation.spacin=1"], "Did you mean 'spacing'"),
        (["{library}", "--html", "no/page.html"], "there is no folder 'no'"),
        (["{library}", "--html", "."], "Give --html a file"),
        (["{library}", "--json", "."], "Give --json a file"),
        (["{library}", "--html", "x", "--json", "x"], "--html and --json name one file"),
        (["{broken}"], "demo_02/joint_angles.csv:9: not a finite number: left_s0"),
        (["{broken}/demo_02", "--html", "page.html"], "Delete the row"),
        ([], "RECORDING"),
    ],
)
def test_wrong_input(
    command: Command,
    library: Path,
    tmp_path_factory: pytest.TempPathFactory,
    args: list[str],
    expected: str,
) -> None:
    broken = Path(shutil.copytree(library, tmp_path_factory.mktemp("broken") / "library"))
    file = broken / "demo_02" / "joint_angles.csv"
    lines = file.read_text().splitlines()
    lines[8] = re.sub(r",[^,]*", ",nan", lines[8], count=1)
    file.write_text("\n".join(lines) + "\n")
    (broken / "log.csv").write_text("t,q0\n")
    code, out, err = command("look", *(a.format(library=library, broken=broken) for a in args))
    assert (code, out) == (2, "")
    assert expected in " ".join(err.split())
    assert "Traceback" not in err
    assert list(Path().iterdir()) == []
