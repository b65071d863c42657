"""Makers' models as they come: from `init` to a certificate and an execution."""

from __future__ import annotations

from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "benchmarks"


@pytest.mark.slow
def test_eight_real_arms_at_least(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.syspath_prepend(str(FOLDER))
    import any_robot

    folder = any_robot.folder_of_models()
    if folder is None:
        pytest.skip("no models of real robots: pip install example-robot-data")
    certified = []
    for key, found, line in any_robot.table(folder, any_robot.ROBOTS):
        with capsys.disabled():
            print(line)
        if "failed" not in found and found["run"]["status"] == "certified":
            summary = found["execute"]["summary"]
            assert summary["flawless"] == summary["instances"]
            certified.append(key)
    assert len(certified) >= 8, certified
