"""What Jupyter shows of a run and of its certificate."""

from __future__ import annotations

import base64
import re
import shutil
from dataclasses import replace
from pathlib import Path

from drake_screw.acquisition import Status
from drake_screw.runs.run import open_run
from tests.small_runs import finished_run

__all__ = ["finished_run"]


def test_a_run_shows_its_state_its_certificate_and_its_course(finished_run: Path) -> None:
    run = open_run(finished_run)
    html = run._repr_html_()
    assert re.search(r"<th[^>]*>status</th><td[^>]*>insufficient: the budget of 2", html)
    assert re.search(r"<th[^>]*>demonstrations</th><td[^>]*>2</td>", html)
    assert re.search(r"<th[^>]*>rounds</th><td[^>]*>2</td>", html)
    picture = base64.b64encode((finished_run / "rounds.png").read_bytes()).decode()
    assert f"data:image/png;base64,{picture}" in html
    assert run.certificate is not None
    stated = run.certificate._repr_html_()
    assert stated in html
    assert "<b>No certificate</b>" in stated
    assert stated.count("<br>") == len(run.certificate.statement) == 6


def test_a_run_without_an_end_shows_neither(finished_run: Path, tmp_path: Path) -> None:
    run = open_run(shutil.copytree(finished_run, tmp_path / "copy"))
    run.directory.save(status=Status.RUNNING, reason=None, certificate=None)
    html = run._repr_html_()
    assert "img" not in html
    assert "ertificate" not in html
    assert re.search(r"<td[^>]*>running</td>", html)


def test_text_is_not_markup(finished_run: Path) -> None:
    run = open_run(finished_run)
    assert run.certificate is not None
    told = "<script>alert('no')</script> & more"
    html = replace(run.certificate, reason=told)._repr_html_()
    assert "<script>" not in html
    assert "&lt;script&gt;" in html
    run.directory.record = replace(run.directory.record, reason=told)
    assert "<script>" not in run._repr_html_()
