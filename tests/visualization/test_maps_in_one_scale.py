"""Heat maps of different runs in one scale."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from drake_screw.tasks import ObjectArea, WorkArea, grid_regions
from drake_screw.tasks.regions import GridRegions
from drake_screw.visualization.maps_in_one_scale import MapOf, maps_in_one_scale, planes_shared


def regions(name: str = "bowl", *, x: tuple[float, float], y: tuple[float, float]) -> GridRegions:
    area = WorkArea((ObjectArea(name, (x[0], y[0], 0.0), (x[1], y[1], 0.0), z=0.0),))
    return grid_regions(area, {"x": 2, "y": 2})


def inches(figure: Figure) -> np.ndarray:
    """Sides of the map, and how long a metre is in it."""
    ax = figure.axes[0]
    size = np.array(ax.get_position().size) * figure.get_size_inches()
    metres = np.abs([np.diff(ax.get_xlim())[0], np.diff(ax.get_ylim())[0]])
    return np.array([*size, *(size / metres)])


def test_areas_of_the_same_object_are_drawn_equally_large(make_round) -> None:
    near, far = regions(x=(0.5, 0.9), y=(0.0, 0.3)), regions(x=(0.7, 1.1), y=(-0.5, 0.2))
    maps = [MapOf(make_round(each, [1, 2, 3, 4], demonstrations=0), each) for each in (near, far)]
    assert planes_shared(maps)
    figures = maps_in_one_scale(maps, ["run 1", "run 2"])
    for figure in figures:
        ax = figure.axes[0]
        np.testing.assert_allclose(sorted(ax.get_xlim()), [-0.5, 0.3])
        np.testing.assert_allclose(sorted(ax.get_ylim()), [0.5, 1.1])
        assert [tuple(bar.get_ylim()) for bar in ax.child_axes] == [(0.0, 1.0)]
    one, other = map(inches, figures)
    np.testing.assert_allclose(one, other)
    np.testing.assert_allclose(one[2], one[3])
    assert [figure.axes[0].get_title(loc="left") for figure in figures] == ["run 1", "run 2"]


def test_other_objects_have_a_frame_of_their_own(make_round) -> None:
    bowl = regions(x=(0.5, 0.9), y=(0.0, 0.3))
    cup = regions("cup", x=(0.7, 1.1), y=(-0.5, 0.2))
    maps = [MapOf(make_round(each, [1, 2, 3, 4], demonstrations=0), each) for each in (bowl, cup)]
    assert not planes_shared(maps)
    figures = maps_in_one_scale(maps, ["run 1", "run 2"])
    np.testing.assert_allclose(sorted(figures[0].axes[0].get_xlim()), [0.0, 0.3])
    np.testing.assert_allclose(sorted(figures[1].axes[0].get_xlim()), [-0.5, 0.2])
