"""The report's HTML, without a browser."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from html import unescape

from drake_screw.acquisition import Status
from drake_screw.runs.run import open_run
from drake_screw.runs.summary import round_in_run
from drake_screw.visualization.rounds import headline
from drake_screw.web.report_page import write_report
from tests.small_runs import finished_run

__all__ = ["finished_run"]


def test_words_of_a_run_are_escaped(finished_run, tmp_path) -> None:
    remark = "<script>alert('a' & \"b\")</script>"
    copy = shutil.copytree(finished_run, tmp_path / "copy")
    record = json.loads((copy / "run.json").read_text())
    record["demonstrations"][0]["remark"] = remark
    (copy / "run.json").write_text(json.dumps(record))
    page = write_report(open_run(copy).reader, tmp_path / "report").read_text(encoding="utf-8")
    assert "<script" not in page
    assert f"<td>{remark}</td>" in unescape(page)
    assert '<svg class="chart"' in page
    assert '<th class="number">round 1</th>' in page
    before, event = (open_run(copy).reader.event(round) for round in (0, 1))
    worst = event.verdict.region
    row = f'{event.verdict.upper[worst]:.4f}</td><td class="number">'
    assert row + f"{before.verdict.estimates[worst]:.4f}</td>" in page
    assert "round 1 → 2: of the work area" in page
    assert '<figure class="sketch">' in page


def test_headings_tell_the_end_of_the_run(finished_run) -> None:
    reader = open_run(finished_run).reader
    event, record = reader.event(0), reader.directory.record
    ended = f"{headline(event)}; the run: "
    assert round_in_run(event, record) == ended + "insufficient, ended after 2 rounds"
    certified = replace(record, status=Status.CERTIFIED, rounds=record.rounds * 2)
    assert round_in_run(event, certified) == ended + "certified in round 4"
    assert round_in_run(replace(event, round=3), certified).endswith(", the end of the run")
    going_on = replace(record, status=Status.RUNNING, rounds=record.rounds[:1])
    assert round_in_run(event, going_on) == ended + "running, 1 round so far"
