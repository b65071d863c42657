"""The smallest set of recordings: chosen on a table, certified on instances of its own."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from drake_screw.acquisition import Evaluator, RegionsEvaluated, Suggestion, TreeEvaluator
from drake_screw.acquisition.cover_table import CoverTable
from drake_screw.assembly.setup import Setup
from drake_screw.bandits import Goal, Verdict, make_strategy
from drake_screw.demonstrations import Demonstration, write_recording
from drake_screw.errors import DrakeScrewError, RecordingError
from drake_screw.planning import Cause, Outcomes
from drake_screw.runs import selecting
from drake_screw.runs.selecting import select
from drake_screw.runs.selection import Selection
from drake_screw.runs.selection_events import Step, Tried
from drake_screw.runs.selection_table import Asked, GrowingTable
from drake_screw.scenario.loader import load_scenario
from drake_screw.tasks import ObjectArea, WorkArea, grid_regions
from drake_screw.typing import Array
from tests.bandits.bernoulli import at_most_plausible

PLACES = {"left": 0.0, "middle": 0.27, "right": 0.55}
LOWER, UPPER = -0.2367, 0.7833  # of the bowl's y
TWO = ["regions.grid={y: 2}"]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Recordings by the simulated teacher: one at either end of the work area, one between."""
    setup, folder = Setup(load_scenario("pouring")), tmp_path_factory.mktemp("library")
    for name, y in PLACES.items():
        place = np.array([[0.9, y, 0.0]])
        lesson = setup.teacher.demonstrate(
            Suggestion(int(setup.regions.index(place)), place),
            number=0,
            used=(),
            rng=np.random.default_rng(0),
        )
        assert lesson.recording is not None
        write_recording(lesson.recording, folder / name)
    return folder


def outcomes(solved: Array) -> Outcomes:
    none = np.full(solved.shape, -1)
    return Outcomes(
        np.where(solved, Cause.SUCCESS, Cause.UNREACHABLE).astype(np.uint8),
        np.where(solved, -1, 0).astype(np.int16),
        none.astype(np.int8),
        solved.astype(np.float32),
        np.zeros(solved.shape, dtype=np.int16),
    )


@dataclass
class Stripes:
    """A demonstration solves what is at most so far from it along y; remembers all instances."""

    reach: float
    table: list[Array] = field(default_factory=list)
    certified_on: list[Array] = field(default_factory=list)

    def __call__(self, setup: Setup) -> Stripes:
        return self

    def solved(self, demonstrations: Sequence[Demonstration], y: Array) -> Array:
        there = np.array([d.X_WO[0, 1, 3] for d in demonstrations])
        return np.abs(y[:, None] - there) < self.reach

    def all_outcomes(self, demonstrations, X_WO, q_start) -> Outcomes:
        self.table.append(X_WO[:, 0, 1, 3])
        return outcomes(self.solved(demonstrations, X_WO[:, 0, 1, 3]))

    def any_success(self, demonstrations, X_WO, q_start) -> Outcomes:
        self.certified_on.append(X_WO[:, 0, 1, 3])
        return outcomes(self.solved(demonstrations, X_WO[:, 0, 1, 3]))


@pytest.fixture(scope="module")
def ends(library: Path) -> tuple[Selection, Stripes, list[object]]:
    """The ends cover all but a hundredth, which is in the middle."""
    planner, seen = Stripes(0.27), []
    found = select(load_scenario("pouring", TWO), library, planner=planner, listener=seen.append)
    return found, planner, seen


def test_the_fewest_are_chosen_and_certified(ends, library: Path) -> None:
    found, _, _ = ends
    assert (found.status, found.chosen) == ("certified", ("left", "right"))
    assert found.smallest
    assert found.folders == (library / "left", library / "right")
    assert found.certificate["certified"]
    assert found.certificate["demonstrations"] == 2
    assert found.statement[0].startswith("Every region succeeds at least 0.95 of the time")
    assert [a.recordings for a in found.attempts] == [("left", "right")]
    assert sum(r.samples for r in found.regions) == found.attempts[0].instances
    assert found.certificate["fresh_instances"] == found.attempts[0].instances
    assert (found.table.regions, found.table.instances_per_region) == (2, 400)
    assert (found.short, found.passed_over, found.table.relaxed) == ((), (), 0)


def test_its_margin_over_other_sets(ends) -> None:
    found, _, _ = ends
    assert found.fewer is not None
    assert found.runner_up is not None
    assert found.fewer.recordings == ("middle",)
    assert found.fewer_ruled_out
    assert found.fewer.success_in_weakest == pytest.approx(0.52, abs=0.06)
    assert found.runner_up.recordings in {("left", "middle"), ("middle", "right")}
    assert found.on_table.success == pytest.approx(0.99, abs=0.01)
    shares = {share.name: share for share in found.recordings}
    for name, y in PLACES.items():
        alone = (min(y + 0.27, UPPER) - max(y - 0.27, LOWER)) / (UPPER - LOWER)
        assert shares[name].alone == pytest.approx(alone, abs=0.04)
        assert shares[name].chosen == (name in found.chosen)
    assert shares["left"].without == shares["right"].alone
    assert shares["left"].without_in_weakest == shares["right"].alone_in_weakest == 0.0
    assert shares["middle"].without is None
    chosen, fewer, runner_up = found.margin
    assert chosen.startswith("2 of 3 recordings: the fewest that solve 97 % of 400 instances in")
    assert "The best set of 1 is middle." in fewer
    assert fewer.endswith(
        "No set of 1 succeeds 95 % of the time in each of 2 regions (confidence 0.95)."
    )
    assert runner_up.startswith("The runner-up of 2 is ")


def test_what_is_not_known_of_other_sets_is_said(ends) -> None:
    found = ends[0]
    unsure = replace(found, smallest=False, fewer=None, runner_up=None).margin
    assert "there are too many sets to show that none is smaller" in unsure[0]
    assert unsure[1] == "The best set of 1 was not found: there are too many sets."
    assert unsure[2] == "No runner-up of 2 was found: there are none, or too many sets."
    for success, hint in ((0.96, "a smaller coverage.epsilon asks for less."), (0.94, "might.")):
        fewer = replace(found.fewer, success_in_weakest=success)
        assert replace(found, fewer=fewer, fewer_ruled_out=False).margin[1].endswith(hint)
    alone = replace(found, chosen=("left",), fewer=None)
    assert alone.margin[1] == "There is nothing smaller than a single recording."


def test_no_instance_of_the_table_counts_for_the_certificate(ends) -> None:
    _, planner, _ = ends
    table, fresh = np.concatenate(planner.table), np.concatenate(planner.certified_on)
    assert (len(table), len(fresh)) == (800, ends[0].attempts[0].instances)
    assert not np.isin(fresh, table).any()


def test_a_listener_hears_of_all_of_it(ends) -> None:
    found, _, seen = ends
    words = [event.words for event in seen if isinstance(event, Step)]
    assert [word.split()[0] for word in dict.fromkeys(words)] == [
        "learning",
        "planning",
        "looking",
        "attempt",
        "comparing",
    ]
    planned = [event for event in seen if isinstance(event, Step) and event.total == 800]
    assert [step.done for step in planned] == [0, 512, 800]
    assert any(isinstance(event, RegionsEvaluated) for event in seen)
    (tried,) = (event for event in seen if isinstance(event, Tried))
    assert (tried.number, tried.attempt) == (1, found.attempts[0])
    assert tried.regions.K == 2


def test_the_same_again_and_other_instances_with_another_seed(ends, library: Path) -> None:
    def again(*changes: str) -> tuple[Selection, Stripes]:
        planner = Stripes(0.27)
        return select(load_scenario("pouring", [*TWO, *changes]), library, planner=planner), planner

    found, planner = again()
    assert replace(found, seconds=0.0) == replace(ends[0], seconds=0.0)
    _, other = again("seed=1")
    assert not np.isin(np.concatenate(other.table), np.concatenate(planner.table)).any()


def test_the_snippet_makes_a_scenario_that_starts_from_them(ends, tmp_path: Path) -> None:
    found = ends[0]
    block = yaml.safe_load(found.snippet(12))["demonstrations"]
    assert block == {"initial": [str(folder) for folder in found.folders]}
    assert yaml.safe_load(found.snippet(1))["demonstrations"]["budget"] == 2
    folders = ", ".join(block["initial"])
    scenario = load_scenario("pouring", [f"demonstrations.initial=[{folders}]"])
    assert [recording.name for recording in Setup(scenario).initial] == list(found.chosen)


class Reluctant:
    """Certifies nothing at first, whatever there is to see."""

    name = "reluctant"
    guarantee = "none"

    def __init__(self, refusals: int, *, attempted: bool = True) -> None:
        self._refusals, self._attempted = refusals, attempted
        self._honest = make_strategy("eprocess", Goal(0.95, 0.02, 0.05))
        self.attempts: list[int] = []

    def __call__(self, setup: Setup) -> Reluctant:
        return self

    def decide(self, pull, K: int, *, attempt: int) -> Verdict:
        self.attempts.append(attempt)
        verdict = self._honest.decide(pull, K, attempt=attempt)
        if len(self.attempts) > self._refusals:
            return verdict
        return replace(verdict, certified=False, attempted=self._attempted, reason="reluctant")


def test_if_a_set_is_not_certified_another_is_tried_at_its_share_of_delta(library: Path) -> None:
    strategy, planner = Reluctant(1), Stripes(0.27)
    scenario = load_scenario("pouring", TWO)
    found = select(scenario, library, planner=planner, strategy=strategy)
    assert [a.recordings for a in found.attempts] == [("left", "right"), tuple(PLACES)]
    assert [a.certified for a in found.attempts] == [False, True]
    assert strategy.attempts == [1, 2]
    assert found.certificate["attempt"] == 2
    assert found.certificate["delta_of_attempt"] == pytest.approx(0.05 / 6)
    assert found.table.instances_per_region == 800
    first, second = (attempt.instances for attempt in found.attempts)
    assert found.certificate["instances_in_all_rounds"] == first + second
    drawn = np.concatenate(planner.certified_on)
    assert len(np.unique(drawn)) == len(drawn) == first + second
    assert found.fewer.recordings == ("left", "right")
    assert found.fewer.attempt == 1
    assert "sets tried before (1)" in found.margin[0]
    assert found.margin[1].endswith("was not certified in attempt 1.")
    assert "these are all of them" in found.margin[2]


def test_a_round_that_was_no_attempt_costs_no_delta(library: Path) -> None:
    strategy = Reluctant(1, attempted=False)
    found = select(load_scenario("pouring", TWO), library, planner=Stripes(0.27), strategy=strategy)
    assert strategy.attempts == [1, 1]
    assert found.certified


def test_when_all_recordings_together_are_not_certified_it_ends(library: Path) -> None:
    scenario = load_scenario("pouring", TWO)
    found = select(scenario, library, planner=Stripes(0.27), strategy=Reluctant(9))
    assert (found.status, len(found.attempts)) == ("insufficient", 2)
    assert found.reason == "all recordings together were tried, and not certified"
    assert found.chosen == tuple(PLACES)
    assert found.margin[0].startswith("3 of 3 recordings were tried last.")
    assert "Shown so far: every region succeeds at least beta'" in " ".join(found.statement)


def test_sets_are_tried_up_to_a_number(library: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(selecting, "LOOKS", 3)
    scenario = load_scenario("pouring", TWO)
    found = select(scenario, library, planner=Stripes(2.0), strategy=Reluctant(9))
    assert [a.recordings for a in found.attempts] == [("left",), ("middle",), ("right",)]
    assert found.reason == "3 sets were tried, and none was certified"


def test_where_not_even_all_of_them_suffice_it_says_where_and_by_how_much(library: Path) -> None:
    few = library.parent / "few"
    shutil.copytree(library / "left", few / "left", dirs_exist_ok=True)
    shutil.copytree(library / "middle", few / "middle", dirs_exist_ok=True)
    found = select(load_scenario("pouring", TWO), few, planner=Stripes(0.27))
    assert (found.status, found.chosen, found.attempts) == ("insufficient", (), ())
    assert (found.regions, found.margin, found.on_table) == ((), (), None)
    (short,) = found.short
    assert (short.region, short.samples) == (1, 400)
    missing = (UPPER - 0.54) / (UPPER - LOWER) * 2
    assert short.failures / short.samples == pytest.approx(missing, abs=0.1)
    (sentence,) = found.statement
    assert sentence == (
        "All recordings together fail more than 0.05 of the time in 1 of 2 regions, on a table of "
        "400 instances in each."
    )


def test_a_region_where_all_of_them_just_suffice_is_asked_for_less(library: Path) -> None:
    """The ends leave 4 % of the only region: more than 1 - beta - epsilon, less than 1 - beta."""
    scenario = load_scenario("pouring", ["regions.grid={}"])
    few = library.parent / "ends"
    for name in ("left", "right"):
        shutil.copytree(library / name, few / name, dirs_exist_ok=True)
    found = select(scenario, few, planner=Stripes(0.2546), instances=3000)
    assert found.table.relaxed == 1
    assert found.attempts[0].recordings == ("left", "right")


ADAPTIVE = ["regions={adaptive: {smallest: 0.0625}}"]


class Slits(Stripes):
    """Each leaves a slit that the others do not leave."""

    def solved(self, demonstrations: Sequence[Demonstration], y: Array) -> Array:
        there = np.array([d.X_WO[0, 1, 3] for d in demonstrations])
        return np.abs(y[:, None] - there) > self.reach


def test_adaptive_regions_start_over_with_every_set(
    library: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A small table is blind to the slits; what one set clears must not certify another."""
    over, start_over = [], TreeEvaluator.start_over
    monkeypatch.setattr(TreeEvaluator, "start_over", lambda e: over.append(start_over(e)))
    scenario = load_scenario("pouring", [*ADAPTIVE, "seed=3"])
    found = select(scenario, library, planner=Slits(0.012), instances=1)
    assert found.certified
    assert [len(attempt.recordings) for attempt in found.attempts] == [1, 1, 2]
    assert len(over) == 3
    assert found.table.regions == 16
    assert found.certificate["claim"].startswith("every dyadic cell")
    assert sum(region.samples for region in found.regions) == found.attempts[-1].instances


def test_of_adaptive_regions_the_smallest_cells_are_asked() -> None:
    setup = Setup(load_scenario("pouring", ["regions={adaptive: {smallest: 0.01, level: 0.02}}"]))
    asked = Asked.of(setup)
    assert asked.regions.K == 128
    np.testing.assert_allclose(asked.regions.shares, 1 / 128)
    assert asked.tau == pytest.approx(0.02 * 0.01 * 128)
    assert asked.q == pytest.approx(asked.tau * 0.03 / 0.05)


def asked_of(K: int) -> Asked:
    area = WorkArea((ObjectArea("bowl", (0.0, 0.0, 0.0), (1.0, 1.0, 0.0), 0.0),))
    return Asked(grid_regions(area, {"x": K}), 0.05, 0.03)


def table(failures: Sequence[int], n: int) -> CoverTable:
    solved = np.concatenate([np.arange(n) >= f for f in failures])[:, None]
    return CoverTable.of(solved, np.repeat(np.arange(len(failures)), n), len(failures))


def test_what_a_set_may_fail() -> None:
    asked, of = asked_of(4), table([0, 12, 13, 20], 400)
    assert asked.allowed(of).tolist() == [12, 12, 20, 20]
    assert asked.relaxed(of).tolist() == [False, False, True, True]
    assert asked.short(of).tolist() == []
    assert asked.short(table([0, 20, 21, 40], 400)).tolist() == [2, 3]


def test_a_few_failures_are_not_enough_to_end_with() -> None:
    asked = asked_of(2)
    assert asked.short(table([0, 1], 8)).tolist() == [1]
    assert not asked.surely_short(table([0, 1], 8), 0.05)
    assert asked.surely_short(table([0, 5], 8), 0.05)
    assert not asked.surely_short(table([0, 22], 400), 0.05)
    assert asked.surely_short(table([0, 40], 400), 0.05)


def test_small_tables_grow_until_they_tell(library: Path) -> None:
    """One in a hundred fails, which of four instances may look like one in four."""
    for seed in range(8):
        scenario = load_scenario("pouring", ["regions.grid={y: 2}", f"seed={seed}"])
        assert select(scenario, library, planner=Stripes(0.265), instances=4).certified


def test_recordings_of_which_nothing_is_kept_are_passed_over(library: Path, tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    shutil.copytree(library, mine)
    shutil.copytree(library / "left", mine / "astray")
    poses = np.loadtxt(mine / "astray" / "object_poses.csv", delimiter=",")
    poses[2, 3] -= 0.7
    np.savetxt(mine / "astray" / "object_poses.csv", poses, delimiter=",")
    found = select(load_scenario("pouring", TWO), mine, planner=Stripes(0.27))
    assert found.chosen == ("left", "right")
    assert found.folders == (mine / "left", mine / "right")
    (passed_over,) = found.passed_over
    assert passed_over.name == "astray"
    for name in PLACES:
        shutil.rmtree(mine / name)
    with pytest.raises(RecordingError, match=r"no recording here.*astray: ") as error:
        select(load_scenario("pouring", TWO), mine)
    assert f"drake-screw look {mine}" in str(error.value)


def test_input_that_cannot_be_used(library: Path, tmp_path: Path) -> None:
    scenario = load_scenario("pouring")
    with pytest.raises(DrakeScrewError, match="0 instances"):
        select(scenario, library, instances=0)
    with pytest.raises(RecordingError, match="no such file or folder"):
        select(scenario, tmp_path / "nowhere")
    with pytest.raises(RecordingError, match="no recordings here"):
        select(scenario, tmp_path)


class AtTheLimit:
    """Each demonstration fails just 1 - beta of the time, two hardly ever: by pieces of y."""

    def __init__(self, D: int, pieces: int = 2000) -> None:
        rng, number = np.random.default_rng(5), pieces // 20
        self.fails = np.zeros((pieces, D), dtype=bool)
        for d in range(D):
            self.fails[rng.choice(pieces, number, replace=False), d] = True

    def any_success(self, demonstrations, X_WO, q_start) -> Outcomes:
        piece = np.floor(len(self.fails) * X_WO[:, 0, 1, 3]).astype(int)
        return outcomes(~self.fails[piece][:, [d.number for d in demonstrations]])


def test_a_selection_certifies_falsely_with_probability_delta_at_most() -> None:
    """At the hardest: many sets that do not suffice, but only just; some look good on the table."""
    area = WorkArea((ObjectArea("bowl", (0.0, 0.0, 0.0), (1.0, 1.0, 0.0), 0.0),))
    regions, goal = grid_regions(area, {}), Goal(0.95, 0.02, 0.1)
    strategy = make_strategy("eprocess", goal, rank_budget=0)
    demonstrations = tuple(SimpleNamespace(name=f"demo_{i}", number=i) for i in range(40))
    planner = AtTheLimit(len(demonstrations))
    falsely, single, runs = 0, 0, 120

    def evaluate(some: Sequence[Demonstration], coordinates: Array) -> Outcomes:
        return planner.any_success(some, area.X_WO(coordinates), None)

    for seed in range(runs):
        setup = SimpleNamespace(
            goal=goal,
            regions=regions,
            scenario=SimpleNamespace(seed=seed),
            evaluate=evaluate,
            evaluator=partial(Evaluator, planner, regions, np.zeros(1), strategy, seed),
        )
        trials = selecting._Trials(setup, demonstrations, nobody)
        growing = GrowingTable(setup, demonstrations, regions, 200, nobody)
        asked = Asked(regions, goal.tau, goal.q)
        end = selecting._choose(asked, growing, trials, nobody)
        single += len(trials.sets[0]) == 1
        falsely += end.certified and len(trials.sets[-1]) == 1
    assert single > 0.9 * runs
    assert at_most_plausible(falsely, runs, goal.delta)


def nobody(_: object) -> None:
    pass
