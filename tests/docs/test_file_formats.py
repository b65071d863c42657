"""docs/file_formats.md names what the files hold: every key, array and column of real ones."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from drake_screw.execution.trials import trials_csv
from drake_screw.planning import Cause
from drake_screw.runs.codec import plain
from drake_screw.runs.outcome_table import tabulate_outcomes
from drake_screw.runs.run import Run, new_run
from drake_screw.runs.trajectory import write_trajectory
from drake_screw.scenario.loader import load_scenario
from drake_screw.studies.study import RUNS, STUDY, SUMMARY, new_study

PAGE = (Path(__file__).parents[2] / "docs" / "file_formats.md").read_text()


def section(heading: str) -> str:
    """The text below a heading, up to the next one of any level."""
    return PAGE.split(f" {heading}\n", 1)[1].split("\n#", 1)[0]


def run(folder: Path, *changes: str) -> Run:
    as_stated = ("objects.0.symmetry=null", "demonstrations.first=random")
    changes = (*as_stated, "demonstrations.budget=1", *changes)
    started = new_run(load_scenario("pouring", changes), folder)
    for _ in started.events():
        pass
    return started


@pytest.fixture(scope="module")
def grid(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run(tmp_path_factory.mktemp("docs") / "run")


def first_line_of_block(text: str, start: str) -> str:
    return next(line for line in text.splitlines() if line.startswith(start))


def test_every_key_of_run_json(grid: Run) -> None:
    record, text = json.loads((grid.directory.path / "run.json").read_text()), section("run.json")
    entry, made = record["rounds"][0], record["demonstrations"][0]
    keys = [*record, *entry, *entry["verdict"], *made]
    assert [key for key in keys if f"`{key}`" not in text] == []
    assert [name for name in record["versions"] if f"`{name}`" not in text] == []
    statuses = ("running", "certified", "insufficient", "interrupted")
    assert all(f"`{status}`" in text for status in statuses)


def test_the_example_of_a_demonstration_has_the_keys(grid: Run) -> None:
    example = json.loads(re.findall(r"```json\n(.*?)```", section("run.json"), re.DOTALL)[0])
    assert example.keys() == plain(grid.directory.record)["demonstrations"][0].keys()


def test_every_file_of_a_run(grid: Run) -> None:
    listed = section("Run directory")
    found = sorted(grid.directory.path.iterdir()) + sorted(grid.directory.round_folder(0).iterdir())
    assert len(found) > 10
    for file in found:
        assert file.name in listed or f"{file.stem}.png, {file.suffix}" in listed, file.name


def test_the_table_of_regions_is_the_example(grid: Run) -> None:
    table = (grid.directory.round_folder(0) / "regions.csv").read_text()
    assert table[: table.index("\n4,")] in section("regions.csv")


def test_the_suggestion_is_the_example(grid: Run) -> None:
    file = grid.directory.round_folder(0) / "next_demonstration.json"
    found, shown = json.loads(file.read_text()), section("next_demonstration.json")
    example = json.loads(re.findall(r"```json\n(.*?)```", shown, re.DOTALL)[0])
    assert example.keys() == found.keys()
    assert example["objects"]["bowl"].keys() == found["objects"]["bowl"].keys()
    assert example["region_name"] == found["region_name"]


def stated_arrays(text: str) -> dict[str, tuple[int, str]]:
    """Number of axes and dtype of each array in a table of the page."""
    found = {}
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| `") and len(cells) == 4:
            axes = len([axis for axis in cells[1].strip("()").split(",") if axis.strip()])
            found |= dict.fromkeys(re.findall(r"`(\w+)`", cells[0]), (axes, cells[2]))
    return found


def real_arrays(file: Path) -> dict[str, tuple[int, str]]:
    with np.load(file) as data:
        kinds = {
            name: "text" if data[name].dtype.kind == "U" else str(data[name].dtype) for name in data
        }
        return {name: (data[name].ndim, kind) for name, kind in kinds.items()}


def test_arrays_of_a_round(grid: Run, tmp_path: Path) -> None:
    stated = stated_arrays(section("instances.npz"))
    plain = real_arrays(grid.directory.round_folder(0) / "instances.npz")
    assert plain.items() <= stated.items()
    adaptive = run(tmp_path / "adaptive", "regions={adaptive: {}}")
    assert real_arrays(adaptive.directory.round_folder(0) / "instances.npz") == stated
    for cause in Cause:
        assert f"{cause.value} {cause.name.lower().replace('_', ' ')}" in section("instances.npz")


def test_outcomes_and_recordings(grid: Run, tmp_path: Path) -> None:
    instances = "\n".join(section("Instances").split("```")[1].strip().splitlines()) + "\n"
    (tmp_path / "places.csv").write_text(instances)
    kept, output = grid.directory.path / "demonstrations", tmp_path / "out.csv"
    tabulate_outcomes(grid.setup.scenario, kept, tmp_path / "places.csv", output)
    example = section("Outcomes").split("```")[1].strip().splitlines()
    first_column = [",".join(line.split(",")[:3]) for line in example]
    assert output.read_text().splitlines() == first_column
    joints = (kept / "01_demo_01" / "joint_angles.csv").read_text().splitlines()
    shown = first_line_of_block(section("Recordings"), "time,").removesuffix("...")
    assert joints[0].startswith(shown)
    poses = (kept / "01_demo_01" / "object_poses.csv").read_text()
    assert poses.splitlines()[-1] in section("Recordings")
    assert len(poses.splitlines()) == 4


def test_columns_of_executions(grid: Run) -> None:
    header = trials_csv([], grid.setup.area).strip().split(",")
    assert [name for name in header if f"`{name}`" not in section("Executions")] == []


def test_exported_trajectories(grid: Run, tmp_path: Path) -> None:
    text = section("Exported trajectories")
    write_trajectory(grid.directory.path, (0.9, 0.3), "npz", tmp_path / "plan.npz")
    assert real_arrays(tmp_path / "plan.npz") == stated_arrays(text)
    write_trajectory(grid.directory.path, (0.9, 0.3), "ros-trajectory", tmp_path / "plan.yaml")
    example = re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)[0]
    assert (tmp_path / "plan.yaml").read_text().startswith(example)
    write_trajectory(grid.directory.path, (0.9, 0.3), "baxter-csv", tmp_path / "plan.csv")
    shown = first_line_of_block(text, "time,").removesuffix("...")
    assert (tmp_path / "plan.csv").read_text().startswith(shown)


def test_files_of_a_study(tmp_path: Path) -> None:
    scenario = load_scenario("pouring", ["demonstrations.budget=1"])
    study = new_study(scenario, (1, 2), 1, tmp_path / "study")
    assert len(list(study.carry_out(workers=1))) == 2
    text = section("Study directory")
    keys = json.loads((study.path / STUDY).read_text()).keys()
    assert [key for key in keys if f"`{key}`" not in text] == []
    for name in (RUNS, SUMMARY):
        assert (study.path / name).read_text().splitlines()[0] in text.splitlines()
    for file in study.path.iterdir():
        assert file.name in text or f"`{file.stem}.png`, `{file.suffix}`" in text
