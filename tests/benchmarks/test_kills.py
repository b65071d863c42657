"""What is killed at any moment, over and over, ends as what was left alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.kills import KINDS, Differs, Kind, kill_often, trial


def never(_: object, folder: Path) -> tuple[str, ...]:
    return ("list",)


def test_a_difference_is_seen(tmp_path: Path) -> None:
    """One that ends as another did, and one that does not."""
    kind = Kind(
        prepare=lambda folder: folder,
        begin=never,
        carry_on=never,
        begun=lambda _: True,
        kept=lambda folder: {"folder": folder.name},
    )
    assert trial(kind, tmp_path, tmp_path / "a", {"folder": "a"}, lambda: 300.0).kills == 0
    with pytest.raises(Differs, match="after 0 kills: folder differ"):
        trial(kind, tmp_path, tmp_path / "b", {"folder": "a"}, lambda: 300.0)


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_kills_at_random_moments_change_nothing(name: str, tmp_path: Path) -> None:
    trials = kill_often(name, 8, tmp_path, np.random.default_rng(0), lambda _: None)
    assert sum(one.kills for one in trials) >= 8
