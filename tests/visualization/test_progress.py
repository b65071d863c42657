from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from drake_screw.tasks import box_regions
from drake_screw.visualization import draw_progress, run_figure, save_run_figure


@pytest.fixture
def events(make_round, regions):
    failures = [[10, 4, 6, 0, 0, 0], [0, 4, 2, 0, 0, 0], [0, 0, 3, 0, 0, 0], [0] * 6]
    return [make_round(regions, f, number=i, demonstrations=i + 1) for i, f in enumerate(failures)]


def line(ax, gid: str) -> np.ndarray:
    (found,) = [item for item in ax.lines if item.get_gid() == gid]
    return np.array(found.get_data(), dtype=float).T


def test_the_line_is_the_largest_estimate_of_each_round(events) -> None:
    ax = Figure().add_subplot()
    draw_progress(ax, events, beta=0.9)
    np.testing.assert_allclose(line(ax, "weakest"), [[1, 1.0], [2, 0.4], [3, 0.3], [4, 0.0]])
    np.testing.assert_allclose(line(ax, "mean")[:, 1], [20 / 60, 6 / 60, 3 / 60, 0.0])
    np.testing.assert_allclose(line(ax, "goal")[:, 1], 0.1)
    np.testing.assert_allclose(line(ax, "certified"), [[4, 0.0]])
    named = [text.get_text() for text in ax.get_legend().get_texts()]
    assert set(named) == {
        "weakest region",
        "all regions together",
        "asked for: at most 0.1",
        "certified",
    }


def test_rounds_are_counted_in_whole_numbers_be_it_a_single_one(events) -> None:
    for count in (1, 2, 4):
        ax = Figure().add_subplot()
        draw_progress(ax, events[:count])
        lower, upper = ax.get_xlim()
        ticks = [tick for tick in ax.get_xticks() if lower <= tick <= upper]
        assert ticks == list(range(1, count + 1))


def test_regions_without_samples_do_not_count(make_round, regions) -> None:
    samples = [10, 10, 0, 0, 0, 0]
    ax = Figure().add_subplot()
    draw_progress(ax, [make_round(regions, [4, 2, 0, 0, 0, 0], samples=samples)])
    np.testing.assert_allclose(line(ax, "weakest"), [[1, 0.4]])
    np.testing.assert_allclose(line(ax, "mean"), [[1, 0.3]])


def test_larger_regions_weigh_more(make_round, regions) -> None:
    boxes = box_regions(regions.area, [[0, 0], [0.5, 0], [0.5, 0.5]], [[0.5, 1], [1, 0.5], [1, 1]])
    ax = Figure().add_subplot()
    draw_progress(ax, [make_round(boxes, [2, 4, 8])], [boxes])
    np.testing.assert_allclose(line(ax, "mean"), [[1, 0.4]])
    ax = Figure().add_subplot()
    draw_progress(ax, [make_round(boxes, [2, 4, 0], samples=[10, 10, 0])], [boxes])
    np.testing.assert_allclose(line(ax, "mean"), [[1, 0.8 / 3]])


def test_every_round_has_its_heat_map(events, regions) -> None:
    figure = run_figure(events, [regions] * 4, scenario="pouring", beta=0.95)
    titles = [ax.get_title() for ax in figure.axes if ax.get_title()]
    assert titles == [f"round {i}: {i} demonstration{'s' * (i > 1)}" for i in range(1, 5)]


def test_one_round_is_enough(tmp_path, events, regions) -> None:
    files = save_run_figure(events[:1], [regions], tmp_path / "run", svg=True)
    again = save_run_figure(events[:1], [regions], tmp_path / "again", svg=True)
    assert [file.suffix for file in files] == [".png", ".svg"]
    for one, other in zip(files, again, strict=True):
        assert one.read_bytes() == other.read_bytes()


@pytest.mark.parametrize("count", range(1, 9))
def test_maps_have_labels_and_leave_no_hole(make_round, regions, count) -> None:
    rounds = [make_round(regions, [3] * 6, number=i) for i in range(count)]
    figure = run_figure(rounds, [regions] * count, beta=0.95)
    maps, others = figure.axes[:count], figure.axes[count:]
    assert {ax.get_xlabel() for ax in maps} == {"y in m"}
    assert {ax.get_ylabel() for ax in maps} == {"x in m"}
    taken = {
        (row, column)
        for ax in [*maps, others[1]]
        for row in ax.get_subplotspec().rowspan
        for column in ax.get_subplotspec().colspan
    }
    rows, columns = maps[0].get_gridspec().get_geometry()
    bar = others[0].get_subplotspec()
    held = {(row, column) for row in bar.rowspan for column in bar.colspan}
    every = {(row, column) for row in range(rows) for column in range(columns)}
    assert every - taken - held <= {(rows - 1, columns - 1)}, "but for what is below the scale"


def test_no_text_is_in_the_way_of_lines(events) -> None:
    ax = Figure().add_subplot()
    draw_progress(ax, events, beta=0.9)
    assert not ax.texts
    ax.get_figure().draw_without_rendering()
    legend = ax.get_legend().get_window_extent()
    assert legend.y0 >= ax.get_window_extent().y1 - 1.0
