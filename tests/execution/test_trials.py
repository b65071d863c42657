"""Trials as a table and in words, in several processes, and as a page that plays."""

from __future__ import annotations

import csv
import io
from dataclasses import replace

import numpy as np
import pytest

from drake_screw.execution import Contact, ExecutionStatus, Phase, recording_html
from drake_screw.execution.allowed import Allowed
from drake_screw.execution.free_objects import Displacement
from drake_screw.execution.parallel import Job, StationConfig, execute_all
from drake_screw.execution.playback import PAUSE, spans
from drake_screw.execution.trials import Trial, summarize, trials_csv
from drake_screw.robot import ObjectConfig
from drake_screw.screws import pose
from drake_screw.tasks import ObjectArea, WorkArea

AREA = WorkArea((ObjectArea("bowl", (0.7, -0.2, 0.0), (1.0, 0.8, 0.0), -0.06),))
X_WO = pose(np.eye(3), [[0.9, 0.6, -0.06]])
PLACE = np.array([[0.9, 0.6, 0.0]])


@pytest.fixture(scope="module")
def config(robot) -> StationConfig:
    return StationConfig(robot, None, (ObjectConfig("bowl", 0.08, 0.06),))


@pytest.fixture(scope="module")
def executed(config, plan):
    return list(execute_all(config, [Job(plan, X_WO)], workers=1))


@pytest.fixture
def trials(executed) -> list[Trial]:
    good = executed[0]
    failed = replace(
        good.report,
        status=ExecutionStatus(Phase.FAILED, 1, "the arm is blocked"),
        contacts=(Contact(("left_hand", "bowl"), 1.0, 1, 40.0),),
    )
    return [
        Trial(3, PLACE, "demo_01", "", good),
        Trial(4, PLACE, "demo_02", "", replace(good, report=failed)),
        Trial(5, PLACE, "", "left_w1 meets its limit in segment 2", None),
    ]


def test_jobs_are_executed(executed) -> None:
    assert len(executed) == 1
    assert executed[0].report.flawless


def test_logs_come_back_thinned_out_with_both_ends(executed) -> None:
    t = executed[0].t
    assert t[0] == 0.0
    assert t[-1] == executed[0].report.time
    assert len(t) == len(executed[0].q) < 200


@pytest.mark.slow
def test_other_processes_answer_the_same(config, plan, executed) -> None:
    jobs = [Job(plan, X_WO)] * 2
    for execution in execute_all(config, jobs, workers=2):
        assert execution.report == executed[0].report


def test_the_table_has_a_row_for_each_trial(trials) -> None:
    rows = list(csv.DictReader(io.StringIO(trials_csv(trials, AREA))))
    assert [row["status"] for row in rows] == ["done", "failed", "no plan"]
    assert [row["region"] for row in rows] == ["3", "4", "5"]
    assert rows[0]["x"] == "0.9"
    assert rows[0]["outside_limits"] == ""
    assert len(rows[0]["screw_mm"].split(";")) == 2
    assert 0.0 < float(rows[0]["tracking_mm"]) < 5.0
    assert rows[1]["segment"] == "2"
    assert rows[1]["contacts"] == "left_hand - bowl 40 N"
    assert rows[2]["reason"] == "left_w1 meets its limit in segment 2"
    assert rows[2]["tracking_mm"] == ""


def test_the_summary_counts_and_names_what_went_wrong(trials) -> None:
    text = str(summarize(trials))
    assert "3 instances, 2 executed" in text
    assert "done                       1 of 2" in text
    assert "with contact               1" in text
    assert "region 5, x 0.900 y 0.600: no plan: left_w1 meets its limit" in text
    assert "region 4" in text
    assert "blocked" in text
    assert "left_hand touches bowl" in text
    assert "region 3" not in text


def test_a_pushed_object_is_counted_and_named(executed) -> None:
    good = executed[0]
    moved = (Displacement("bowl", 4.2e-3, 0.02, 1.5), Displacement("cup", 1e-3, 0.0, 1.6))
    pushed = replace(good, report=replace(good.report, moved=moved))
    found = summarize(
        [Trial(4, PLACE, "demo_02", "", pushed), Trial(3, PLACE, "demo_01", "", good)]
    )
    assert (found.done, found.flawless, found.pushed) == (2, 1, 1)
    assert found.worst.moved == (4.2e-3, 0.02)
    (said,) = found.flawed
    assert said.text == "the bowl is pushed by 4.2 mm and turned by 0.020 rad from 1.50 s on"
    text = str(found)
    assert "pushed an object           1" in text
    assert "objects moved              at most 4.20 mm, 20.00 mrad" in text
    rows = trials_csv([Trial(4, PLACE, "demo_02", "", pushed)], AREA).splitlines()
    assert "bowl 4.200;cup 1.000" in rows[1]
    assert "objects moved" not in str(summarize([Trial(3, PLACE, "demo_01", "", good)]))


def test_too_far_off_its_way_is_a_flaw(executed) -> None:
    report = executed[0].report
    strict = replace(report, allowed=Allowed(position=report.tracking.position / 2.0))
    found = summarize([Trial(3, PLACE, "demo_01", "", replace(executed[0], report=strict))])
    assert (found.done, found.flawless, found.off_the_way) == (1, 0, 1)
    assert "mrad off its way" in found.flawed[0].text


def test_what_is_done_and_touches_nothing_is_flawless(trials, executed) -> None:
    assert summarize(trials).flawless == 1
    touching = replace(executed[0].report, contacts=(Contact(("hand", "bowl"), 1.0, 1, 40.0),))
    found = summarize([Trial(3, PLACE, "demo_01", "", replace(executed[0], report=touching))])
    assert (found.done, found.flawless) == (1, 0)


def test_nothing_executed_is_said_too(trials) -> None:
    assert str(summarize(trials[2:])).splitlines()[0] == "1 instance, 0 executed"
    for some, text in ((trials[1:], "nothing was executed as planned"), (trials, "region 4")):
        assert text in str(summarize(some)).splitlines()[-1]


def test_the_recording_is_one_page_with_every_execution(config, executed) -> None:
    shown = (executed[0], X_WO, config.robot)
    one = recording_html([shown], objects=config.objects)
    two = recording_html([shown, shown], objects=config.objects)
    assert "<html" in one
    assert "https://" not in one.split("<body")[0]
    assert len(two) > len(one) + 50_000


def test_executions_are_played_one_after_the_other(executed) -> None:
    length = float(executed[0].t[-1])
    first, second = spans([executed[0], executed[0]])
    assert first == (0.0, length)
    assert second == pytest.approx((length + PAUSE, 2.0 * length + PAUSE))
