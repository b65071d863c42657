"""Runs that ask by other rules: in their directory, carried on, and told again."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drake_screw.acquisition import DemonstrationRequested, Event, RoundFinished, Suggestion
from drake_screw.acquisition.asking import densest
from drake_screw.assembly.setup import Setup
from drake_screw.assembly.tried_recordings import TriedRecordings
from drake_screw.demonstrations import write_recording
from drake_screw.errors import PluginError, RunDirectoryError
from drake_screw.runs.run import new_run, open_run
from drake_screw.scenario.loader import load_scenario
from drake_screw.scenario.schema import Scenario

QUICK = [
    "objects.0.symmetry=null",
    "coverage.beta=0.7",
    "coverage.epsilon=0.15",
    "seed=2",
    "demonstrations.budget=4",
]
GRID = [*QUICK, "regions={grid: {x: 2, y: 2}}"]
ADAPTIVE = [*QUICK, "regions={adaptive: {smallest: 0.0625}}"]
ELSEWHERE = ["demonstrations.ask=densest_anywhere", "demonstrations.first=middle"]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three recordings of pouring."""
    setup, folder = Setup(load_scenario("pouring")), tmp_path_factory.mktemp("library")
    for number, (x, y) in enumerate([(0.8, 0.1), (0.95, 0.35), (0.85, 0.6)]):
        place = Suggestion(0, np.array([[x, y, 0.0]]))
        rng = np.random.default_rng(number)
        lesson = setup.teacher.demonstrate(place, number=number, used=(), rng=rng)
        assert lesson.recording is not None, lesson.remark
        write_recording(lesson.recording, folder / f"demo_{number}")
    return folder


@pytest.fixture
def covering(library: Path) -> Scenario:
    teacher = ["teacher={kind: recorded, choose: covers_most}", f"teacher.folder={library}"]
    return load_scenario("pouring", [*GRID, *teacher])


def carry_out(scenario: Scenario, path: Path) -> list[Event]:
    return list(new_run(scenario, path).events())


def interrupted_and_carried_on(scenario: Scenario, path: Path) -> list[Event]:
    """Interrupted after its first round, before the teacher is asked again."""
    events = new_run(scenario, path).events()
    next(event for event in events if isinstance(event, RoundFinished))
    events.close()  # type: ignore[attr-defined]
    return list(open_run(path).events())


def story(path: Path) -> dict[str, object]:
    record = json.loads((path / "run.json").read_text())
    return {name: record[name] for name in ("status", "demonstrations", "rounds", "certificate")}


def asked(events: list[Event]) -> list[Suggestion]:
    return [event.suggestion for event in events if isinstance(event, DemonstrationRequested)]


@pytest.mark.slow
@pytest.mark.parametrize(
    "regions", [pytest.param(GRID, id="grid"), pytest.param(ADAPTIVE, id="adaptive")]
)
def test_a_run_with_another_rule_is_carried_on_and_told_again(regions, tmp_path: Path) -> None:
    scenario = load_scenario("pouring", [*regions, *ELSEWHERE])
    lived = carry_out(scenario, tmp_path / "whole")
    again = interrupted_and_carried_on(scenario, tmp_path / "parts")
    assert story(tmp_path / "whole") == story(tmp_path / "parts")
    told = list(open_run(tmp_path / "whole").replay())
    places = asked(lived)
    assert len(places) > 1
    area = scenario.objects[0]
    middle = [(axis.lower + axis.upper) / 2 for axis in (area.x, area.y, area.yaw)]
    np.testing.assert_allclose(places[0].coordinates, [middle])
    for other in (asked(again), asked(told)):
        assert [place.region for place in places] == [place.region for place in other]
        for one, same in zip(places, other, strict=True):
            np.testing.assert_array_equal(one.coordinates, same.coordinates)
    rounds = [event for event in lived if isinstance(event, RoundFinished)]
    for event, place in zip(rounds, places[1:], strict=False):
        assert event.regions.index(place.coordinates) == place.region
        entry = json.loads((tmp_path / "whole/run.json").read_text())["rounds"][event.round]
        assert entry["weakest_region"] == event.verdict.region
        assert entry["next_demonstration"]["region"] == place.region
        assert entry["next_demonstration"]["region_name"] == event.regions.name(place.region)


@pytest.mark.slow
def test_recordings_that_cover_most_are_given_also_in_a_run_that_is_carried_on(
    covering: Scenario, tmp_path: Path
) -> None:
    carry_out(covering, tmp_path / "whole")
    interrupted_and_carried_on(covering, tmp_path / "parts")
    whole, parts = story(tmp_path / "whole"), story(tmp_path / "parts")
    for told in (whole, parts):
        for entry in told["demonstrations"]:  # type: ignore[attr-defined]
            assert "solves most of what fails" in entry["remark"]
    assert whole == parts


def test_the_first_of_a_library_is_the_one_that_covers_most_of_the_work_area(
    covering: Scenario,
) -> None:
    setup = Setup(covering)
    rng = np.random.default_rng(0)
    places = rng.uniform(setup.area.lower, setup.area.upper, (2000, 1, 3))
    recordings = setup.teacher.recordings  # type: ignore[attr-defined]
    learned = [setup.learn(recording) for recording in recordings]
    covered = setup.evaluate(learned, places).success.mean(axis=0)
    corner = Suggestion(0, setup.area.lower, failing=places[:256])
    lesson = setup.teacher.demonstrate(corner, number=0, used=(), rng=rng)
    assert lesson.recording is recordings[int(np.argmax(covered))]


def test_a_recording_of_which_nothing_is_kept_works_nowhere(
    covering: Scenario, library: Path
) -> None:
    """The bowl is moved out of the arm's way in one of them."""
    setup = Setup(covering)
    good, other, _ = setup.recordings(library)
    other.X_WO[0, :3, 3] += 5.0
    tried = TriedRecordings(setup.recorder, setup.learning, setup.planner, setup.workcell.start)
    rng = np.random.default_rng(0)
    places = rng.uniform(setup.area.lower, setup.area.upper, (200, 1, 3))
    works = tried.works([other, good], places)
    assert not works[:, 0].any()
    np.testing.assert_array_equal(
        works[:, 1], setup.evaluate([setup.learn(good)], places).success[:, 0]
    )
    assert not tried.works([other], places).any()
    assert tried.works([], places).shape == (200, 0)


@pytest.mark.slow
def test_a_rule_of_ones_own_is_named_in_the_scenario_or_passed_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "my_rules.py").write_text(
        "import numpy as np\n\n\ndef last(evaluation, region, regions, rng):\n"
        "    return np.flatnonzero(evaluation.failed)[::-1]\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    named = load_scenario("pouring", [*GRID, "demonstrations.ask=my_rules:last"])
    events = carry_out(named, tmp_path / "named")
    first = next(event for event in events if isinstance(event, RoundFinished))
    last = first.evaluation.coordinates[first.evaluation.failed][-1]
    assert first.suggestion is not None
    np.testing.assert_array_equal(first.suggestion.coordinates, last)
    assert open_run(tmp_path / "named").setup.ask.__name__ == "last"

    from my_rules import last as rule

    scenario = load_scenario("pouring", GRID)
    run = new_run(scenario, tmp_path / "passed", ask=rule)
    list(run.events())
    assert run.directory.record.passed_in == ("ask",)
    assert story(tmp_path / "passed")["rounds"] == story(tmp_path / "named")["rounds"]
    with pytest.raises(RunDirectoryError, match="with its own ask"):
        list(open_run(tmp_path / "passed").events())


@pytest.mark.parametrize("make", [new_run, lambda scenario, path: Setup(scenario).ask])
def test_a_rule_that_cannot_be_imported_is_told_before_anything_is_written(
    make: Callable[..., object], tmp_path: Path
) -> None:
    scenario = load_scenario("pouring", ["demonstrations.ask=no_such_module:rule"])
    with pytest.raises(PluginError, match="asking rule 'no_such_module:rule': the module"):
        make(scenario, tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_a_setup_has_the_rule_that_is_named() -> None:
    assert Setup(load_scenario("pouring", ["demonstrations.ask=densest"])).ask is densest
