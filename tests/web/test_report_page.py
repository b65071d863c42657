"""The report's HTML, without a browser."""

from __future__ import annotations

import json
import shutil
from html import unescape

from drake_screw.runs.run import open_run
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
    assert '<figure class="sketch">' in page
