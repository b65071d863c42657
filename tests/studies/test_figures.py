"""Figures of studies show the numbers they were given."""

from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.figure import Figure

from drake_screw.studies.figures import (
    Distribution,
    comparison_figure,
    distributions_figure,
    draw_distribution,
    save_comparison,
    save_distributions,
)
from drake_screw.tasks import WorkArea, grid_regions
from tests.visualization.conftest import BOWL

FOUND = Distribution((3, 3, 2, 5, 3, 2), without=2)


def texts(figure: Figure) -> str:
    return "\n".join(
        text.get_text() for text in figure.findobj(match=lambda a: hasattr(a, "get_text"))
    )


def test_a_distribution_counts_certified_runs_and_keeps_the_others_in_mind() -> None:
    assert FOUND.runs == 8
    assert FOUND.counts == {2: 2, 3: 3, 5: 1}
    assert (FOUND.mean, FOUND.most) == (3.0, 5)
    nothing = Distribution((), without=4)
    assert (nothing.runs, nothing.counts, nothing.most) == (4, {}, 0)
    assert math.isnan(nothing.mean)


def test_bars_are_shares_of_all_runs() -> None:
    ax = Figure().add_subplot()
    draw_distribution(ax, FOUND)
    bars = {bar.get_x() + bar.get_width() / 2: bar.get_height() for bar in ax.patches}
    assert bars == pytest.approx({2: 2 / 8, 3: 3 / 8, 5: 1 / 8})
    (mean,) = [line for line in ax.lines if line.get_gid() == "mean"]
    assert mean.get_xdata()[0] == 3.0
    written = "\n".join(text.get_text() for text in ax.texts)
    assert "mean 3.00, at most 5" in written
    assert "2 not certified" in written


def test_one_panel_for_each_K_on_one_scale() -> None:
    figure = distributions_figure({1: FOUND, 16: Distribution((9,))}, scenario="pouring")
    axes = figure.get_axes()
    assert [ax.get_ylabel() for ax in axes] == ["K = 1", "K = 16"]
    assert axes[0].get_xlim() == axes[1].get_xlim()
    assert axes[0].get_xlim()[1] > 9
    assert "pouring: 1 to 8 runs" in figure.get_suptitle()


def test_a_study_in_which_nothing_was_certified_can_be_drawn() -> None:
    figure = distributions_figure({4: Distribution((), without=3)})
    figure.draw_without_rendering()
    assert "3 not certified" in texts(figure)


@pytest.fixture
def pair(make_round):
    area = WorkArea((BOWL,))
    coarse, fine = grid_regions(area, {}), grid_regions(area, {"x": 2, "y": 3})
    rounds = make_round(coarse, [0], each=60), make_round(fine, [0, 6, 0, 0, 0, 1])
    return rounds, (coarse, fine)


def test_a_hidden_failure_is_seen_beside_the_whole(pair) -> None:
    rounds, regions = pair
    figure = comparison_figure(rounds, regions, scenario="pouring", note="17 of 20 runs")
    left, right, _ = figure.get_axes()
    cells = [sum(str(p.get_gid()).startswith("cell") for p in ax.patches) for ax in (left, right)]
    assert cells == [1, 6]
    assert left.get_title(loc="left") == "K = 1: certified"
    assert right.get_title(loc="left") == "K = 6: not certified, weakest region fails 60.0%"
    assert "the same 2 demonstrations" in figure.get_suptitle()
    assert "17 of 20 runs" in figure.get_suptitle()
    assert np.allclose(left.get_xlim(), right.get_xlim())


def test_files_are_the_same_bytes_every_time(pair, tmp_path) -> None:
    for name in ("a", "b"):
        save_distributions({1: FOUND}, tmp_path / f"d_{name}", scenario="s")
        save_comparison(*pair, tmp_path / f"p_{name}", scenario="s")
    for kind in ("d", "p"):
        for end in ("png", "svg"):
            first, second = (tmp_path / f"{kind}_{name}.{end}" for name in ("a", "b"))
            assert first.read_bytes() == second.read_bytes()
