from __future__ import annotations

import re

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from drake_screw.planning import Cause
from drake_screw.tasks import ObjectArea, WorkArea, box_regions, grid_regions
from drake_screw.visualization import draw_heat_map, heat_map_figure, save_heat_map
from drake_screw.visualization.cells import cells
from drake_screw.visualization.heat_map import legend_handles
from drake_screw.visualization.palette import UNKNOWN, failure_color
from tests.visualization.conftest import BOWL

FAILURES = [0, 3, 10, 5, 0, 1]


@pytest.fixture
def ax() -> Axes:
    figure = Figure(figsize=(8, 4), dpi=100)
    FigureCanvasAgg(figure)
    return figure.add_subplot()


def marks(ax: Axes, gid: str) -> np.ndarray:
    """(m, 2) x, y in the world of the markers drawn under a name."""
    lines = [line for line in ax.lines if line.get_gid() == gid]
    return np.concatenate([np.array(line.get_data()).T[:, ::-1] for line in lines])


def texts(ax: Axes) -> list[str]:
    return [t.get_text() for t in ax.texts]


def color_at(ax: Axes, x: float, y: float) -> np.ndarray:
    """sRGB of the pixel that shows the place x, y of the world."""
    canvas = ax.get_figure().canvas
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())
    column, row = ax.transData.transform((y, x))
    return pixels[pixels.shape[0] - 1 - round(row), round(column), :3] / 255.0


def test_every_cell_has_the_color_of_its_estimate(ax, make_round, regions) -> None:
    event = make_round(regions, FAILURES, demonstrations=0)
    draw_heat_map(ax, event, regions, dots=0, text=False)
    for region, failures in enumerate(FAILURES):
        lower, upper = regions.bounds(region)
        x, y, _ = (0.6 * lower + 0.4 * upper)[0]
        np.testing.assert_allclose(
            color_at(ax, x, y), failure_color(failures / 10), atol=0.01, err_msg=f"{region}"
        )


def test_a_region_without_samples_is_marked_unknown(ax, make_round, regions) -> None:
    samples = [10, 10, 10, 10, 10, 0]
    event = make_round(regions, [0] * 6, demonstrations=0, samples=samples)
    draw_heat_map(ax, event, regions, dots=0)
    lower, upper = regions.bounds(5)
    x, y, _ = (0.9 * lower + 0.1 * upper)[0]
    np.testing.assert_allclose(color_at(ax, x, y), to_rgb(UNKNOWN), atol=0.01)
    assert "?" in texts(ax)


def test_it_lies_as_the_3d_view_does_with_the_robot_at_the_top(ax, make_round, regions) -> None:
    draw_heat_map(ax, make_round(regions, FAILURES), regions)
    left, low = ax.transData.transform((-0.3, 1.0))
    right, high = ax.transData.transform((0.9, 0.6))
    assert left < right
    assert low < high
    assert abs((right - left) / 1.2 - (high - low) / 0.4) < 1e-6
    np.testing.assert_allclose(marks(ax, "robot"), [[0.6, 0.0]])


def test_estimates_and_counts_are_written(ax, make_round, regions) -> None:
    draw_heat_map(ax, make_round(regions, FAILURES), regions)
    assert {"0.000", "0.300", "1.000", "0.500", "0.100"} <= set(texts(ax))
    assert {"0 / 10", "3 / 10", "10 / 10", "5 / 10", "1 / 10"} <= set(texts(ax))


def test_text_that_has_no_room_is_left_out(ax, make_round, regions) -> None:
    fine = grid_regions(regions.area, {"x": 3, "y": 60})
    draw_heat_map(ax, make_round(fine, [0] * fine.K, each=1), fine, dots=0)
    assert "0.000" not in texts(ax)


def test_text_makes_way_for_marks(ax, make_round, regions) -> None:
    middle = make_round(regions, FAILURES)
    lower, upper = regions.bounds(2)
    middle.suggestion.coordinates[:] = (lower + upper) / 2.0
    draw_heat_map(ax, middle, regions)
    y, x = next(t.get_position() for t in ax.texts if t.get_text() == "1.000")
    assert abs(y - 0.3) > 0.05
    assert (lower[0, :2] < (x, y)).all()
    assert ((x, y) < upper[0, :2]).all()


def test_the_star_is_at_the_suggestion(ax, make_round, regions) -> None:
    draw_heat_map(ax, make_round(regions, FAILURES), regions)
    np.testing.assert_allclose(marks(ax, "suggestion"), [[0.75, 0.4]])


def test_no_star_when_certified(ax, make_round, regions) -> None:
    draw_heat_map(ax, make_round(regions, [0] * 6), regions)
    assert "suggestion" not in [line.get_gid() for line in ax.lines]


def test_the_weakest_region_is_framed(ax, make_round, regions) -> None:
    draw_heat_map(ax, make_round(regions, FAILURES), regions)
    (frame,) = [p for p in ax.patches if p.get_gid() == "weakest"]
    np.testing.assert_allclose(frame.get_xy(), (0.1, 0.6))
    np.testing.assert_allclose((frame.get_width(), frame.get_height()), (0.4, 0.2))


def test_nothing_is_framed_where_nothing_fails(ax, make_round, regions) -> None:
    event = make_round(regions, [0] * 6)
    shown = draw_heat_map(ax, event, regions)
    assert not [p for p in ax.patches if p.get_gid() in ("weakest", "halo")]
    assert "weakest region" not in [h.get_label() for h in legend_handles(event, shown)]


def test_demonstrations_are_numbered_where_their_object_stood(ax, make_round, regions) -> None:
    event = make_round(regions, FAILURES, demonstrations=3)
    draw_heat_map(ax, event, regions)
    for number, demonstration in enumerate(event.demonstrations, start=1):
        place = demonstration.X_WO[0, :2, 3]
        np.testing.assert_allclose(marks(ax, f"demonstration {number}"), [place])
        (label,) = [t for t in ax.texts if t.get_text() == str(number)]
        np.testing.assert_allclose(label.get_position(), place[::-1])


@pytest.mark.parametrize(("beyond", "clipped"), [(0.0, False), (0.01, True)])
def test_a_demonstration_at_the_edge_is_drawn_whole_and_one_beyond_it_is_cut_off(
    ax, make_round, regions, beyond, clipped
) -> None:
    event = make_round(regions, FAILURES, demonstrations=1)
    event.demonstrations[0].X_WO[0, :2, 3] = regions.area.upper[0, :2] + beyond
    draw_heat_map(ax, event, regions)
    (ring,) = [line for line in ax.lines if line.get_gid() == "demonstration 1"]
    (label,) = [text for text in ax.texts if text.get_text() == "1"]
    assert (ring.get_clip_on(), label.get_clip_on()) == (clipped, clipped)


def test_instances_are_drawn_by_cause(ax, make_round, regions) -> None:
    event = make_round(regions, FAILURES)
    draw_heat_map(ax, event, regions)
    drawn = {}
    for cause in (Cause.SUCCESS, Cause.JOINT_LIMIT, Cause.UNREACHABLE, Cause.COLLISION):
        drawn[cause] = marks(ax, f"instances {cause.name}")
        expected = event.evaluation.outcomes.cause[:, 0] == cause
        np.testing.assert_allclose(drawn[cause], event.evaluation.coordinates[expected, 0, :2])
    looks = {
        (line.get_marker(), line.get_markerfacecolor())
        for line in ax.lines
        if str(line.get_gid()).startswith("instances")
    }
    assert len({marker for marker, _ in looks}) == len({color for _, color in looks}) == 4


def test_instances_are_sampled_and_the_sample_is_stated(make_round, regions) -> None:
    event = make_round(regions, [50] * 6, each=100)
    figure = heat_map_figure(event, regions, dots=90)
    ax = figure.axes[0]
    dots = [line for line in ax.lines if str(line.get_gid()).startswith("instances")]
    assert sum(len(line.get_xdata()) for line in dots) == 90
    assert figure.legends[0].get_title().get_text() == "90 of 600 instances, drawn at random"


def test_title_and_labels(make_round, regions) -> None:
    ax = heat_map_figure(make_round(regions, FAILURES), regions, scenario="pouring").axes[0]
    assert ax.get_title(loc="left").strip() == ("pouring: round 1, 2 demonstrations: not certified")
    assert any("weakest region: x 0.60..0.80, y 0.10..0.50" in text for text in texts(ax))
    assert "x in m" in ax.get_ylabel()
    assert "y in m" in ax.get_xlabel()


def test_stacks_and_the_drawn_object_are_stated(make_round) -> None:
    area = WorkArea(
        (
            ObjectArea("bowl", (0.6, 0.0, -1.0), (1.0, 0.4, 1.0), 0.0),
            ObjectArea("cup", (0.5, 0.6, 0.0), (0.5, 0.9, 0.0), 0.0),
        )
    )
    regions = grid_regions(area, {"bowl.x": 2, "bowl.yaw": 2})
    worst, mean = heat_map_figure(make_round(regions, [1, 2, 8, 0]), regions).axes[:2]
    titles = [" ".join(ax.get_title(loc="left").split()) for ax in (worst, mean)]
    assert titles[0] == "bowl: the worst of 2 regions over bowl yaw and cup y"
    assert titles[1] == "bowl: the mean over bowl yaw and cup y"
    assert {"0.800", "0.200"} <= set(texts(worst))
    assert "0.100" not in texts(worst)
    assert {"0.450", "0.100"} <= set(texts(mean))


def test_every_object_that_moves_has_its_maps(make_round) -> None:
    cup = ObjectArea("cup", (0.4, 0.6, 0.0), (0.5, 0.9, 0.0), 0.0)
    regions = grid_regions(WorkArea((BOWL, cup)), {"bowl.x": 2, "cup.y": 2})
    event = make_round(regions, [1, 2, 8, 0])
    maps = heat_map_figure(event, regions).axes[:4]
    titles = [ax.get_title(loc="left").split(":")[0] for ax in maps]
    assert titles == ["bowl", "bowl", "cup", "cup"]
    np.testing.assert_allclose(marks(maps[2], "suggestion"), [event.suggestion.coordinates[1, :2]])


def test_axes_are_chosen_and_named(make_round) -> None:
    area = WorkArea(
        (
            ObjectArea("bowl", (0.6, 0.0, 0.0), (1.0, 0.4, 0.0), z=(0.0, 0.3)),
            ObjectArea("cup", (0.5, 0.6, 0.0), (0.5, 0.9, 0.0), 0.0),
        )
    )
    regions = grid_regions(area, {"bowl.z": 3, "cup.y": 2})
    event = make_round(regions, [1, 2, 8, 0, 0, 6])
    ax = heat_map_figure(event, regions, axes=((0, 3), (1, 1))).axes[0]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("cup y in m", "bowl z in m")
    assert (*ax.get_xlim(), *ax.get_ylim()) == pytest.approx((0.6, 0.9, 0.0, 0.3))
    assert {"0.100", "0.200", "0.800", "0.600"} <= set(texts(ax))
    assert any("averaged over bowl x and bowl y" in " ".join(t.split()) for t in texts(ax))
    place = event.demonstrations[0].X_WO
    np.testing.assert_allclose(marks(ax, "demonstration 1"), [[place[0, 2, 3], place[1, 1, 3]]])


def test_a_mean_weighs_regions_by_their_share() -> None:
    area = WorkArea((ObjectArea("bowl", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), 0.0),))
    boxes = box_regions(
        area,
        [[0, 0, 0], [0, 0, 0.25], [0, 0.5, 0.25]],
        [[1, 1, 0.25], [1, 0.5, 1], [1, 1, 1]],
    )
    drawn = cells(boxes, np.array([0.4, 0.0, 0.8]))
    np.testing.assert_allclose(drawn.mean, [0.1, 0.7])
    assert np.isnan(cells(boxes, np.full(3, np.nan)).mean).all()


def test_cells_of_different_sizes_are_drawn_as_they_are(ax, make_round, regions) -> None:
    boxes = box_regions(regions.area, [[0, 0], [0.5, 0], [0.5, 0.5]], [[0.5, 1], [1, 0.5], [1, 1]])
    draw_heat_map(ax, make_round(boxes, [0, 4, 9], demonstrations=0), boxes, dots=0, text=False)
    for place, failures in [((0.7, -0.2), 0), ((0.7, 0.8), 0), ((0.9, 0.0), 4), ((0.9, 0.6), 9)]:
        np.testing.assert_allclose(color_at(ax, *place), failure_color(failures / 10), atol=0.01)
    (frame,) = [p for p in ax.patches if p.get_gid() == "weakest"]
    np.testing.assert_allclose(frame.get_xy(), (0.3, 0.8))
    np.testing.assert_allclose((frame.get_width(), frame.get_height()), (0.6, 0.2))


def test_a_weakest_region_larger_than_the_cells_is_framed_whole(ax, make_round) -> None:
    cup = ObjectArea("cup", (0.2, 0.0, 0.0), (0.4, 0.0, 0.0), 0.0)
    area = WorkArea((BOWL, cup))
    boxes = box_regions(
        area,
        [[0, 0, 0.5], [0, 0, 0], [0.5, 0, 0]],
        [[1, 1, 1], [0.5, 1, 0.5], [1, 1, 0.5]],
    )
    figure = heat_map_figure(make_round(boxes, [6, 1, 9]), boxes)
    assert "worst of up to 2 regions" in " ".join(figure.axes[0].get_title(loc="left").split())
    draw_heat_map(ax, make_round(boxes, [6, 1, 0]), boxes, dots=0)
    (frame,) = [p for p in ax.patches if p.get_gid() == "weakest"]
    np.testing.assert_allclose((frame.get_width(), frame.get_height()), (1.2, 0.4))


def test_files_are_the_same_every_time(tmp_path, make_round, regions) -> None:
    event = make_round(regions, FAILURES)
    first = save_heat_map(event, regions, tmp_path / "a.b", scenario="pouring", svg=True)
    second = save_heat_map(event, regions, tmp_path / "again", scenario="pouring", svg=True)
    assert [f.name for f in first] == ["a.b.png", "a.b.svg"]
    for one, other in zip(first, second, strict=True):
        assert one.read_bytes() == other.read_bytes()
    assert first[0].read_bytes().startswith(b"\x89PNG")
    svg = first[1].read_text()
    assert "<svg" in svg
    assert not re.search(r"<dc:date>", svg)


def test_an_svg_that_was_drawn_before_is_not_left_behind(tmp_path, make_round, regions) -> None:
    save_heat_map(make_round(regions, FAILURES), regions, tmp_path / "a", dots=10, svg=True)
    before = (tmp_path / "a.svg").read_bytes()
    none = [0] * len(FAILURES)
    written = save_heat_map(make_round(regions, none), regions, tmp_path / "a", dots=10)
    assert [f.name for f in written] == ["a.png", "a.svg"]
    assert (tmp_path / "a.svg").read_bytes() != before


def test_pyplot_is_left_alone(tmp_path, make_round, regions) -> None:
    save_heat_map(make_round(regions, FAILURES), regions, tmp_path / "a", dots=10)
    assert pyplot.get_fignums() == []
