"""Loading scenario files: every error names its place, and what is written is read back."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from drake_screw.demonstrations import FaithfulConfig, SegmentationConfig
from drake_screw.errors import ModelError, ScenarioError
from drake_screw.resources import MODEL_SUFFIXES, find_resource, list_resources
from drake_screw.scenario.loader import dump_scenario, load_scenario, load_stored_scenario
from drake_screw.scenario.object_blocks import ObjectBlock
from drake_screw.scenario.robot_blocks import RecordedOnBlock, RobotBlock
from drake_screw.scenario.run_blocks import (
    AdaptiveBlock,
    CoverageBlock,
    DemonstrationsBlock,
    PlannerBlock,
    RegionsBlock,
    TeacherBlock,
)
from drake_screw.scenario.schema import Scenario
from drake_screw.scenario.segmentation_block import SegmentationBlock
from drake_screw.scenario.values import Interval
from drake_screw.scenario.workcell_blocks import TableBlock
from drake_screw.tasks import AXES

SMALL = """\
name: small
robot:
  model: baxter
  joints: [a, b]
  end_effector: hand
  start: [0.1, -0.2]
table:
  center: [0.8, 0.2]
  size: [0.7, 1.3]
  top: -0.06
objects:
  - name: bowl
    x: [0.7, 1.1]
    y: [-0.2, 0.8]
    z: 0
    radius: 0.08
    height: 0.06
regions:
  grid: {x: 4, y: 2}
coverage:
  beta: 0.9
teacher:
  kind: simulated
  motion: pouring
"""


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    """Writes SMALL with some of its texts replaced."""

    def write(*changes: tuple[str, str]) -> Path:
        text = SMALL
        for old, new in changes:
            assert text.count(old) == 1, old
            text = text.replace(old, new)
        file = tmp_path / "small.yaml"
        file.write_text(text, encoding="utf-8")
        return file

    return write


def error_of(name_or_path: str | Path, *overrides: str) -> ScenarioError:
    with pytest.raises(ScenarioError) as caught:
        load_scenario(name_or_path, overrides)
    return caught.value


@pytest.mark.parametrize("name", ["pouring", "scooping"])
def test_shipped_scenarios_are_found_by_name(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.teacher.motion == name
    assert scenario.source is not None
    assert scenario.source.is_absolute()
    assert scenario.source.name == f"{name}.yaml"
    assert scenario.cells == ((4, 4, 1, 1, 1, 1),)
    assert scenario == load_scenario(scenario.source)


def test_shipped_scenarios_spell_out_the_defaults() -> None:
    scenario = load_scenario("pouring")
    assert scenario.coverage == CoverageBlock()
    assert scenario.demonstrations == DemonstrationsBlock(first="farthest")
    assert scenario.segmentation == SegmentationBlock()
    assert scenario.planner == PlannerBlock()


@pytest.mark.parametrize("task", ["pouring", "scooping"])
def test_the_papers_reading_is_shipped_and_does_not_move(task: str) -> None:
    paper, ours = load_scenario(f"{task}_paper"), load_scenario(task)
    assert paper.segmentation.config == SegmentationConfig(
        spacing=0.005,
        position_tolerance=0.015,
        rotation_tolerance=0.15,
        min_progress=0.001,
        region_of_interest=1.5,
    )
    assert (paper.coverage.strategy, paper.cells) == ("naive_pac", ((4, 4, 1, 1, 1, 1),))
    assert (paper.coverage.beta, paper.coverage.epsilon, paper.coverage.delta) == (0.95, 0.02, 0.05)
    assert not paper.planner.collision
    assert paper.planner.approach == "screw"
    assert paper.planner.redundancy == "least_norm"
    (symmetric,), (bowl,) = ours.objects, paper.objects
    assert symmetric.symmetry is not None
    assert bowl == symmetric.model_copy(update={"symmetry": None})
    for same in ("robot", "table", "teacher", "seed"):
        assert getattr(paper, same) == getattr(ours, same), same


def test_a_scenario_stored_before_segmentation_had_methods_is_read_as_published(
    tmp_path: Path,
) -> None:
    file = tmp_path / "scenario.yaml"
    paper = load_scenario("pouring_paper")
    file.write_text(dump_scenario(paper).replace("method: published, ", ""))
    assert "published" not in file.read_text()
    assert load_stored_scenario(file) == paper
    with pytest.raises(ScenarioError, match="min_progress: the method faithful has no such key"):
        load_scenario(file)
    ours = load_scenario("pouring")
    file.write_text(dump_scenario(ours))
    assert load_stored_scenario(file) == ours


def test_a_scenario_stored_before_there_were_ways_to_ask_is_read_as_it_was_meant(
    tmp_path: Path,
) -> None:
    file = tmp_path / "scenario.yaml"
    changes = ["demonstrations={ask: densest, first: middle}", "teacher.choose=covers_most"]
    file.write_text(dump_scenario(load_scenario("pouring", changes)))
    written = load_stored_scenario(file)
    assert (written.demonstrations.ask, written.demonstrations.first) == ("densest", "middle")
    assert written.teacher.choose == "covers_most"
    text = file.read_text()
    for key in ("  first: middle\n", "  ask: densest\n", ", choose: covers_most"):
        assert text.count(key) == 1, text
        text = text.replace(key, "")
    file.write_text(text)
    before = load_stored_scenario(file)
    assert (before.demonstrations.ask, before.demonstrations.first) == ("earliest", "random")
    assert before.teacher.choose == "nearest"


def test_the_papers_scenarios_ask_as_the_paper_does() -> None:
    for task in ("pouring_paper", "scooping_paper"):
        text = (Path("scenarios") / f"{task}.yaml").read_text()
        assert "ask: earliest" in text
        assert "first: random" in text


def test_a_scenario_stored_before_joints_moved_away_from_limits_is_of_least_norm(
    tmp_path: Path,
) -> None:
    file, ours = tmp_path / "scenario.yaml", load_scenario("pouring")
    file.write_text(dump_scenario(ours).replace("redundancy: least_norm,", ""))
    assert "redundancy" not in file.read_text()
    assert load_stored_scenario(file) == ours
    assert ours.planner.redundancy == "least_norm"


def test_defaults_fill_what_is_left_out(write: Callable[..., Path]) -> None:
    scenario = load_scenario(write())
    assert scenario.robot.base == "base"
    assert scenario.robot.parked == {}
    assert scenario.table is not None
    assert scenario.table.thickness == 0.04
    assert scenario.objects[0].yaw == Interval(0, 0)
    assert scenario.coverage == CoverageBlock(beta=0.9)
    assert scenario.segmentation == SegmentationBlock()


def test_numbers_without_a_point_and_empty_blocks_are_read(write: Callable[..., Path]) -> None:
    file = write(
        ("  beta: 0.9", "  beta: 9e-1\n  options:"),
        ("    x: [0.7, 1.1]", "    x: [1, 1.1]\n    yaw: 1"),
        ("teacher:", "segmentation:\n  # spacing: 0.01\nplanner: {tolerance: 1e-5}\nteacher:"),
    )
    scenario = load_scenario(file)
    assert scenario.coverage == CoverageBlock(beta=0.9, options={})
    assert scenario.objects[0].x == Interval(1.0, 1.1)
    assert type(scenario.objects[0].x.lower) is float
    assert scenario.objects[0].yaw == Interval(1, 1)
    assert scenario.segmentation == SegmentationBlock()
    assert scenario.planner.tolerance == 1e-5


@pytest.mark.parametrize(
    ("old", "new", "line", "message", "remedy"),
    [
        (
            "beta: 0.9",
            "betta: 0.9",
            21,
            "coverage.betta: unknown key",
            "'beta'? Keys of coverage",
        ),
        ("regions:", "region:", 18, "region: unknown key", "Did you mean 'regions'?"),
        ("name: small", "description: x", 1, "name: missing; expected text", "name of the scen"),
        (
            "  end_effector: hand\n",
            "",
            2,
            "robot.end_effector: missing; expected text",
            "name of the frame",
        ),
        (
            "    radius: 0.08\n",
            "",
            12,
            "objects.0.radius: missing; expected a number",
            "radius of the object",
        ),
        (
            "beta: 0.9",
            "beta: high",
            21,
            "coverage.beta: expected a number, found text 'high'",
            None,
        ),
        ("beta: 0.9", "beta: '0.9'", 21, "expected a number, found text '0.9'", "without quotes"),
        ("beta: 0.9", "beta: true", 21, "coverage.beta: expected a number, found true", None),
        ("beta: 0.9", "beta:", 21, "coverage.beta: expected a number, found nothing", None),
        ("beta: 0.9", "beta: .nan", 21, "expected a number, found the number nan", None),
        ("beta: 0.9", "beta: 1e999", 21, "expected a number, found the number inf", None),
        ("beta: 0.9", "beta: [0.9]", 21, "expected a number, found a list of 1", None),
        ("beta: 0.9", "beta: 0.9\nseed: 1.5", 22, "seed: expected a whole number", None),
        (
            "beta: 0.9",
            f"beta: {'9' * 400}",
            21,
            "coverage.beta: expected a number, found a number far too large",
            None,
        ),
        ("beta: 0.9", f"beta: {'9' * 9000}", 21, "coverage.beta: expected a number", None),
        ("name: small", "name: 12", 1, "name: expected text, found the number 12", "in quotes"),
        ("start: [0.1, -0.2]", "start: 3", 6, "robot.start: expected a list of numbers", None),
        (
            "start: [0.1, -0.2]",
            "start:\n    - 0.1\n    - b",
            8,
            "robot.start.1: expected a number, found text 'b'",
            None,
        ),
        (
            "center: [0.8, 0.2]",
            "center: [0.8]",
            8,
            "table.center: expected a list of 2 numbers, found a list of 1",
            None,
        ),
        (
            "x: [0.7, 1.1]",
            "x: [0.7, 0.8, 1.1]",
            13,
            "objects.0.x: expected a list of 2 numbers, found a list of 3",
            None,
        ),
        (
            "x: [0.7, 1.1]",
            "x: wide",
            13,
            "objects.0.x: expected a number or [lower, upper], found text 'wide'",
            None,
        ),
        (
            "grid: {x: 4, y: 2}",
            "grid: {x: 4, y: two}",
            19,
            "regions.grid.y: expected a whole number, found text 'two'",
            None,
        ),
        ("grid: {x: 4, y: 2}", "grid: 4", 19, "regions.grid: expected a mapping from names", None),
        ("coverage:\n  beta: 0.9", "coverage: 0.9", 20, "coverage: expected a mapping with", None),
        (
            "teacher:",
            "demonstrations:\n  initial: some\nteacher:",
            23,
            "demonstrations.initial: expected a whole number or a list of paths",
            None,
        ),
        (
            "teacher:",
            "demonstrations:\n  initial: [r, 2]\nteacher:",
            23,
            "demonstrations.initial.1: expected a path, found the number 2",
            None,
        ),
        ("beta: 0.9", "options: {a: [1]}", 21, "coverage.options.a: expected true or false", None),
        ("beta: 0.9", "beta: !!set 1", 21, "coverage.beta: the tag", "Leave it out"),
        ("beta: 0.9", "? [1]\n  : 2", 21, "coverage: a key must be a name", None),
        (
            "beta: 0.9",
            "beta: 0.9\n  delta: 0.1\n  beta: 0.8",
            23,
            "coverage.beta: repeated key; it is already given in line 21",
            "Keep one",
        ),
        (
            "start: [0.1, -0.2]",
            "start: [0.1, -0.2",
            7,
            "not valid YAML: expected ',' or ']'",
            "line 6",
        ),
        ("beta: 0.9", "beta: 0.9\n\tdelta: 1", 22, "not valid YAML: found character '\\t'", None),
        ("beta: 0.9", "beta: *high", 21, "not valid YAML: found undefined alias 'high'", None),
        (
            "beta: 0.9",
            'beta: "\\U00110000"',
            21,
            "not valid YAML: \\U... stands for no character",
            r"U0010FFFF",
        ),
        ("beta: 0.9", "beta: \x07", 21, "not valid YAML: the character #x07", "Delete it"),
        ("teacher:", "---\nteacher:", 22, "not valid YAML: but found another document", None),
        ("beta: 0.9", "beta: 1.5", 21, "coverage.beta: expected a number of at least", None),
        ("y: [-0.2, 0.8]", "y: [0.8, -0.2]", 14, "objects.0.y: lower limit 0.8 lies above", None),
        (
            "beta: 0.9",
            "beta: 0.9\n  epsilon: 0.1",
            22,
            "coverage.epsilon: the run could never stop",
            "below 0.1",
        ),
        ("beta: 0.9", "beta: 0.98", 20, "coverage.epsilon: the run could never stop", "beta"),
        (
            "motion: pouring",
            "motion: puring",
            24,
            "teacher.motion: there is no 'puring'",
            "Did you mean 'pouring'? Choices: pouring, scooping",
        ),
    ],
)
def test_errors_name_line_key_and_remedy(
    write: Callable[..., Path], old: str, new: str, line: int, message: str, remedy: str | None
) -> None:
    file = write((old, new))
    error = error_of(file)
    assert (error.file, error.line) == (file, line)
    assert message in error.message
    assert str(error).startswith(f"{file}:{line}: {error.message}")
    assert (remedy or "") in (error.remedy or "")


def test_all_problems_are_told_at_once(write: Callable[..., Path]) -> None:
    file = write(
        ("beta: 0.9", "beta: high"), ("top: -0.06", "topp: -0.06"), ("  end_effector: hand", "")
    )
    error = error_of(file)
    assert error.file == file
    assert error.message.splitlines() == [
        "3 problems",
        "  line 2: robot.end_effector: missing; expected text",
        "    Meaning: name of the frame that the demonstrations move; needed without `arms`.",
        "  line 10: table.topp: unknown key",
        "    Did you mean 'top'? Keys of table: center, size, top, thickness",
        "  line 21: coverage.beta: expected a number, found text 'high'",
    ]


@pytest.mark.parametrize("text", ["", "\n# only a comment\n", "---\n", "~"])
def test_empty_file(tmp_path: Path, text: str) -> None:
    file = tmp_path / "empty.yaml"
    file.write_text(text)
    error = error_of(file)
    assert error.file == file
    assert error.message == "the file is empty"


@pytest.mark.parametrize("text", ["- a\n- b\n", "just text\n", "12\n"])
def test_file_that_is_no_mapping(tmp_path: Path, text: str) -> None:
    file = tmp_path / "list.yaml"
    file.write_text(text)
    error = error_of(file)
    assert (error.file, error.line) == (file, 1)
    assert error.message.startswith("expected keys with values")


def test_file_that_is_not_utf8(tmp_path: Path) -> None:
    file = tmp_path / "latin.yaml"
    file.write_bytes("name: small\ndescription: Schüssel\n".encode("latin-1"))
    error = error_of(file)
    assert (error.file, error.line) == (file, 2)
    assert "not UTF-8 text: byte 0xfc" in error.message


def test_byte_order_mark_is_ignored(write: Callable[..., Path]) -> None:
    file = write()
    scenario = load_scenario(file)
    file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    assert load_scenario(file) == scenario


@pytest.mark.parametrize("text", ["a: &a [*a]\n", "a: " + "[" * 500])
def test_endless_nesting_is_refused(tmp_path: Path, text: str) -> None:
    file = tmp_path / "deep.yaml"
    file.write_text(text)
    error = error_of(file)
    assert error.file == file
    assert "nested too deeply" in error.message


def test_file_that_cannot_be_read(
    write: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(self: Path) -> bytes:
        raise PermissionError(13, "Permission denied")

    file = write()
    monkeypatch.setattr(Path, "read_bytes", refuse)
    error = error_of(file)
    assert (error.file, error.message) == (file, "the file cannot be read: Permission denied")


def test_unknown_name_lists_the_shipped_ones() -> None:
    assert "Did you mean" not in (error_of("no/such/folder.yaml").remedy or "")
    error = error_of("pourng")
    assert error.message == "no scenario 'pourng'"
    assert error.remedy is not None
    shipped = "fetching, pouring, pouring_both, pouring_iiwa, pouring_panda, pouring_paper, "
    shipped += "pouring_ur5e, scooping, scooping_paper"
    assert error.remedy.startswith(f"Did you mean 'pouring'? Shipped scenarios: {shipped}.")


def test_missing_file_suggests_its_neighbour(write: Callable[..., Path]) -> None:
    file = write()
    wrong = file.with_name("smal.yaml")
    error = error_of(wrong)
    assert error.message == f"no file '{wrong}'"
    assert f"Did you mean '{file}'? " in (error.remedy or "")
    assert "fetching, pouring, pouring_both, pouring_iiwa, pouring_panda, pouring_paper" in (
        error.remedy or ""
    )


def test_missing_file_suggests_a_shipped_name() -> None:
    assert "Did you mean 'pouring'?" in (error_of("poring.yaml").remedy or "")


def test_folder_suggests_a_file_in_it(write: Callable[..., Path]) -> None:
    file = write()
    error = error_of(file.parent)
    assert error.message == f"'{file.parent}' is a folder, not a scenario file"
    assert f"Did you mean '{file}'?" in (error.remedy or "")


def test_other_files_and_models_are_found_by_name(
    write: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write()
    monkeypatch.chdir(file.parent)
    file.rename("plain")
    assert load_scenario("plain").name == "small"
    assert {"pouring", "pouring_iiwa", "scooping"} <= set(list_resources("scenarios"))
    with pytest.raises(ModelError, match="no model 'baxterr'"):
        find_resource("models", "baxterr", MODEL_SUFFIXES)


def test_paths_are_seen_from_the_file(write: Callable[..., Path]) -> None:
    file = write(
        ("model: baxter", "model: arms/my.sdf"),
        ("kind: simulated", "kind: recorded"),
        ("motion: pouring", "folder: ../recordings\ndemonstrations:\n  initial: [one, /two]"),
    )
    scenario = load_scenario(file)
    assert scenario.robot.model == str(file.parent / "arms" / "my.sdf")
    assert scenario.teacher.folder == file.parent.parent / "recordings"
    assert scenario.demonstrations.initial == (file.parent / "one", Path("/two"))
    elsewhere = file.parent / "run" / "resolved.yaml"
    elsewhere.parent.mkdir()
    elsewhere.write_text(dump_scenario(scenario))
    assert load_scenario(elsewhere) == scenario


def test_overrides_replace_values_in_order(write: Callable[..., Path]) -> None:
    scenario = load_scenario(
        write(),
        [
            "coverage.beta=0.8",
            "coverage.epsilon = 1e-2",
            "objects.0.z=-0.5",
            "objects.0.yaw=[-1, 1]",
            "regions.grid.yaw=3",
            "regions.grid.x=5",
            "table=",
            "robot.parked.c=0.25",
            "coverage.options={batch: 10, exact: true, how: far=near}",
            "coverage.beta=0.85",
        ],
    )
    assert scenario.coverage == CoverageBlock(
        beta=0.85, epsilon=0.01, options={"batch": 10, "exact": True, "how": "far=near"}
    )
    assert scenario.objects[0].z == Interval(-0.5, -0.5)
    assert scenario.cells == ((5, 2, 3, 1, 1, 1),)
    assert scenario.table is None
    assert scenario.robot.parked == {"c": 0.25}


def test_override_reaches_keys_with_dots(write: Callable[..., Path]) -> None:
    file = write(("{x: 4, y: 2}", "{bowl.x: 4}"))
    assert load_scenario(file, ["regions.grid.bowl.x=7"]).cells == ((7, 1, 1, 1, 1, 1),)


def test_override_paths_are_seen_from_the_working_directory(
    write: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write(("kind: simulated", "kind: recorded"), ("motion: pouring", "folder: here"))
    other = file.parent / "other"
    other.mkdir()
    monkeypatch.chdir(other)
    assert load_scenario(file, ["teacher.folder=there"]).teacher.folder == other / "there"
    assert load_scenario(file).teacher.folder == file.parent / "here"


@pytest.mark.parametrize(
    ("override", "message", "remedy"),
    [
        ("coverage.beta", "expected key.path=value", None),
        ("=3", "expected key.path=value", None),
        ("coverage..beta=3", "expected key.path=value", None),
        ("coverage.beta=[1", "not valid YAML: expected ',' or ']'", None),
        ("coverage.options={a: 1, a: 2}", "a: repeated key; it is already given", None),
        ("coverage.beta=high", "coverage.beta: expected a number, found text 'high'", None),
        ("coverage.beta=2", "coverage.beta: expected a number of at", None),
        ("coverage.bta=0.5", "coverage.bta: unknown key", "Did you mean 'beta'?"),
        ("coverage.beta.x=1", "coverage.beta is a single value; there is no x in it", None),
        ("objects.1.z=0", "no entry 1 in the list objects", "Entries: 0"),
        ("objects.bowl.z=0", "no entry bowl in the list objects", "Entries: 0"),
        ("robot.joints.2=c", "no entry 2 in the list robot.joints", "Entries: 0 to 1"),
        ("objects.0.z=", "objects.0.z: expected a number or [lower, upper], found nothing", None),
        ("coverage.epsilon=0.2", "coverage.epsilon: the run could never stop", None),
        ("robot={model: a}", "robot.joints: missing", None),
    ],
)
def test_override_errors_name_the_override(
    write: Callable[..., Path], override: str, message: str, remedy: str | None
) -> None:
    error = error_of(write(), override)
    assert f"--set {override}: " in str(error)
    assert message in error.message
    assert (remedy or "") in (error.remedy or "")


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("regions.grid={x: 65, y: 64}", "4,160 regions; a grid has 4,096 at most"),
        ("coverage.epsilon=1e-9", "at least 0.0001"),
        ("planner.tolerance=100", "below 0.1"),
    ],
)
def test_what_no_machine_can_carry_out_is_refused(override: str, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        load_scenario("pouring", [override])
    load_scenario("pouring", ["regions.grid={x: 64, y: 64}"])


def test_any_path_like_names_a_file(write: Callable[..., Path]) -> None:
    class Somewhere:
        def __fspath__(self) -> str:
            return str(write())

    assert load_scenario(Somewhere()) == load_scenario(write())


def test_a_teacher_of_ones_own_is_given_the_keys_that_are_not_known(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    file = write(("kind: simulated", "kind: my.module:Mine\n  patience: 3\n  folder: here"))
    teacher = load_scenario(file, ["teacher.mood=good"]).teacher
    assert teacher.kind == "my.module:Mine"
    assert teacher.options == {"patience": 3, "mood": "good"}
    assert (teacher.motion, teacher.folder) == ("pouring", file.parent / "here")
    elsewhere = tmp_path / "elsewhere.yaml"
    elsewhere.write_text(dump_scenario(load_scenario(file)))
    assert load_scenario(elsewhere) == load_scenario(file)
    assert load_scenario(elsewhere).teacher.options == {"patience": 3}


@pytest.mark.parametrize(
    ("override", "message", "remedy"),
    [
        ("teacher.mood=good", "teacher.mood: unknown key", "Keys of teacher: kind, motion, folder"),
        ("teacher={kid: simulated}", "teacher.kid: unknown key", "Did you mean 'kind'?"),
        ("teacher={kind: 'a:B', n: [1]}", "teacher.n: expected true or false or a whole", ""),
        ("teacher.kind=:B", "teacher.kind: there is no ':B'", "or package.module:Object"),
        ("coverage.strategy=mine", "coverage.strategy: there is no 'mine'", "module:Object"),
    ],
)
def test_parts_of_ones_own_are_checked_as_far_as_they_are_known(
    write: Callable[..., Path], override: str, message: str, remedy: str
) -> None:
    error = error_of(write(), override)
    assert message in error.message
    assert remedy in (error.remedy or "")


def test_motion_and_strategy_may_be_ones_own(write: Callable[..., Path]) -> None:
    overrides = ["teacher.motion=a.b:c", "coverage={strategy: 'a:B', options: {n: 1}}"]
    scenario = load_scenario(write(), overrides)
    assert scenario.teacher.motion == "a.b:c"
    assert scenario.coverage.strategy == "a:B"


def test_python_is_told_of_broken_rules_as_well() -> None:
    with pytest.raises(ValidationError, match="the run could never stop"):
        CoverageBlock(beta=0.99)
    with pytest.raises(ValidationError, match="lower limit 2"):
        ObjectBlock(name="a", x=Interval(2.0, 1.0), y=Interval(0, 0), z=0, radius=1, height=1)


def test_loading_imports_no_drake() -> None:
    code = (
        "import sys; from drake_screw.scenario.loader import load_scenario; "
        "load_scenario('pouring'); assert 'pydrake' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


numbers = st.floats(allow_nan=False, allow_infinity=False, min_value=-1e300, max_value=1e300)
lengths = st.floats(min_value=-1000.0, max_value=1000.0)
positive = st.floats(min_value=5e-324, max_value=1000.0)
texts = st.text(
    st.characters(codec="utf-8", exclude_categories=["Cs", "Cn"]), min_size=1, max_size=12
) | st.sampled_from(["1e5", "0.5", "no", "null", "~", "1:30", "a: b", "- x", "#", "0x1", ".inf"])
names = st.from_regex("[A-Za-z0-9_-]{1,8}", fullmatch=True)
angles = st.floats(min_value=-3.14, max_value=3.14)


@st.composite
def intervals(draw: st.DrawFn, ends: st.SearchStrategy[float] = lengths) -> Interval:
    lower, upper = sorted([draw(ends), draw(ends)])
    return Interval(lower, upper)


@st.composite
def scenarios(draw: st.DrawFn) -> Scenario:
    joints = draw(st.lists(texts, min_size=1, max_size=3, unique=True))
    objects = tuple(
        ObjectBlock(
            name=name,
            x=draw(intervals()),
            y=draw(intervals()),
            yaw=draw(intervals(angles)),
            z=draw(lengths),
            radius=draw(positive),
            height=draw(positive),
        )
        for name in draw(st.lists(names, min_size=1, max_size=2, unique=True))
    )
    free = [f"{o.name}.{axis}" for o in objects for axis in AXES if not getattr(o, axis).fixed]
    beta = draw(st.floats(min_value=0.01, max_value=0.99))
    options = st.booleans() | st.integers() | numbers | texts
    regions = RegionsBlock(grid={k: draw(st.integers(1, 4)) for k in free})
    if free and draw(st.booleans()):
        shares = st.floats(min_value=1e-9, max_value=1.0, exclude_max=True)
        regions = RegionsBlock(adaptive=AdaptiveBlock(smallest=draw(shares), level=draw(shares)))
    return Scenario(
        name=draw(names),
        description=draw(texts),
        robot=RobotBlock(
            model="baxter",
            joints=tuple(joints),
            end_effector=draw(texts),
            start=tuple(draw(lengths) for _ in joints),
            parked=draw(st.dictionaries(texts.filter(lambda t: t not in joints), numbers)),
        ),
        table=draw(
            st.none()
            | st.builds(
                TableBlock,
                center=st.tuples(lengths, lengths),
                size=st.tuples(positive, positive),
                top=lengths,
                thickness=positive,
            )
        ),
        objects=objects,
        regions=regions,
        coverage=CoverageBlock(
            beta=beta,
            epsilon=draw(st.floats(min_value=0.02, max_value=0.9)) * (1 - beta),
            options=draw(st.dictionaries(texts, options, max_size=3))
            if regions.adaptive is None
            else {},
        ),
        demonstrations=DemonstrationsBlock(
            initial=draw(st.integers(0, 3) | st.just((Path("/a b"), Path("/c: #d")))), budget=3
        ),
        teacher=draw(
            st.sampled_from(
                [
                    TeacherBlock(kind="recorded", folder=Path("/some/where")),
                    TeacherBlock(kind="simulated", motion="scooping"),
                ]
            )
        ),
        recorded_on=draw(
            st.none()
            | st.builds(
                RecordedOnBlock,
                model=st.sampled_from(["baxter", "/a b/arm.sdf"]),
                joints=st.lists(texts, min_size=1, max_size=3, unique=True).map(tuple),
                end_effector=texts,
                base=texts,
            )
        ),
        seed=draw(st.integers(0, 2**128)),
    )


def test_line_breaks_of_unicode_are_read_back(write: Callable[..., Path], tmp_path: Path) -> None:
    options = {"a\x85b": True, "\u2028": "\u2029 \n", "é": "ö"}
    scenario = load_scenario(write())
    coverage = scenario.coverage.model_copy(update={"options": options})
    scenario = scenario.model_copy(update={"coverage": coverage})
    file = tmp_path / "written.yaml"
    file.write_text(dump_scenario(scenario), encoding="utf-8", newline="")
    assert load_scenario(file).coverage.options == options
    assert "é" in file.read_text(encoding="utf-8")


@settings(max_examples=40, deadline=None)
@given(scenario=scenarios())
def test_what_is_written_is_read_back(
    scenario: Scenario, tmp_path_factory: pytest.TempPathFactory
) -> None:
    file = tmp_path_factory.getbasetemp() / "round_trip.yaml"
    file.write_text(dump_scenario(scenario), encoding="utf-8", newline="")
    assert load_scenario(file) == scenario


def test_each_method_of_segmentation_has_its_own_keys_and_defaults() -> None:
    published = load_scenario("pouring", ["segmentation.method=published"]).segmentation
    assert (published.method, published.config) == ("published", SegmentationConfig())
    for nothing in ("segmentation.method=null", "segmentation.method=faithful"):
        assert load_scenario("pouring", [nothing]).segmentation.config == FaithfulConfig()
    faithful = load_scenario("pouring", ["segmentation.reach=0.5"]).segmentation
    assert (faithful.method, faithful.config) == ("faithful", FaithfulConfig(reach=0.5))
    assert faithful.min_progress is None
    with pytest.raises(ScenarioError, match=r"min_progress: the method faithful has no"):
        load_scenario("pouring", ["segmentation.min_progress=0.1"])
    with pytest.raises(ScenarioError, match=r"segmentation\.reach: the method published has no"):
        load_scenario("pouring_paper", ["segmentation.reach=0.1"])
    with pytest.raises(ScenarioError, match="segmentation: spacing must be"):
        load_scenario("pouring", ["segmentation.spacing=0.1"])
    with pytest.raises(ScenarioError, match="there is no 'fathful'") as error:
        load_scenario("pouring", ["segmentation.method=fathful"])
    assert "Did you mean 'faithful'?" in str(error.value)


def test_objects_of_the_task_are_objects_of_the_scenario() -> None:
    named = load_scenario("pouring", ["demonstrations.objects=[bowl]"])
    assert named.demonstrations.objects == ("bowl",)
    with pytest.raises(ScenarioError, match=r"objects\.0: there is no object 'bowel'"):
        load_scenario("pouring", ["demonstrations.objects=[bowel]"])


@pytest.mark.parametrize("name", ["pouring", "scooping"])
def test_shipped_scenarios_show_obstacles_and_a_tool_that_can_be_read(
    name: str, tmp_path: Path
) -> None:
    lines = load_scenario(name).source.read_text().splitlines()
    for first in ("  # tool:", "# obstacles:"):
        i = next(i for i, line in enumerate(lines) if line.startswith(first))
        while lines[i].lstrip().startswith("#"):
            lines[i] = lines[i].replace("# ", "", 1)
            i += 1
    file = tmp_path / "shown.yaml"
    file.write_text("\n".join(lines))
    scenario = load_scenario(file)
    assert scenario.robot.tool.shape.cylinder is not None
    assert scenario.obstacles[0].box == (0.04, 0.6, 0.3)
    assert scenario.obstacles[-1].name == ("jug" if name == "pouring" else "wall")


def test_meshes_are_seen_from_the_file_and_survive_its_being_stored(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    file = write(
        ("start: [0.1, -0.2]", "start: [0.1, -0.2]\n  tool: {shape: {mesh: spoon.obj}}"),
        ("regions:", "obstacles:\n  - {name: jug, mesh: ../jug.obj, scale: 0.001}\nregions:"),
    )
    scenario = load_scenario(file)
    assert scenario.obstacles[0].mesh == tmp_path.parent / "jug.obj"
    assert scenario.robot.tool.shape.mesh == tmp_path / "spoon.obj"
    stored = tmp_path / "run" / "scenario.yaml"
    stored.parent.mkdir()
    stored.write_text(dump_scenario(scenario))
    assert load_stored_scenario(stored) == scenario
    assert "scale: 1.0" not in stored.read_text()


def test_a_scenario_stored_before_there_were_obstacles_has_none(
    write: Callable[..., Path],
) -> None:
    scenario = load_stored_scenario(write())
    assert scenario.obstacles == ()
    assert scenario.robot.tool is None


def test_aliases_that_stand_for_more_than_anybody_means_are_refused(
    write: Callable[..., Path],
) -> None:
    doubled = "".join(f"a{i}: &a{i} [*a{i - 1}, *a{i - 1}]\n" for i in range(1, 60))
    error = error_of(write(("teacher:", f"a0: &a0 [x]\n{doubled}teacher:")))
    assert error.message == "not usable: aliases make more than 100,000 values of it"
    assert error.remedy == "Write out what is meant, without & and *."


def test_of_very_many_problems_the_first_are_listed(write: Callable[..., Path]) -> None:
    error = error_of(write(("teacher:", f"obstacles: [{', '.join('1' * 600)}]\nteacher:")))
    first, *lines = error.message.splitlines()
    assert first == "600 problems, of which these are the first 12"
    assert sum(line.startswith("  line 22: obstacles.") for line in lines) == 12


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("y: [-0.2, 0.8]", "y: [-1e308, 0.8]", "objects.0.y: -1e+308 m is beyond 1,000 m"),
        ("radius: 0.08", "radius: 80000", "objects.0.radius: 80000 m is beyond 1,000 m"),
        (
            "y: [-0.2, 0.8]",
            "y: 0\n    yaw: -1e308",
            "objects.0.yaw: -1e+308 rad is beyond 1,000 rad",
        ),
    ],
)
def test_lengths_beyond_any_workcell_are_refused(
    write: Callable[..., Path], old: str, new: str, message: str
) -> None:
    """Drake's queries end the process where a shape is huge."""
    error = error_of(write((old, new)))
    assert error.message.startswith(message)
    assert error.remedy in ("Numbers here are in m.", "Numbers here are in rad.")
