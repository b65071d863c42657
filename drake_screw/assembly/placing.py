"""Where a user puts the objects: a task instance by their names, or as plain numbers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.errors import ScenarioError, listed, suggestion
from drake_screw.tasks import FARTHEST, ObjectArea, WorkArea
from drake_screw.typing import Array

PlaceLike = Mapping[str, float] | ArrayLike
"""{axis: number}, or x, y and perhaps yaw, or all coordinates in the order of `WorkArea.axes`."""

InstanceLike = Mapping[str, PlaceLike] | ArrayLike
"""{object: place}, or the numbers of a place of each object in their order; m and rad."""

UNITS = {"x": "m", "y": "m", "yaw": "rad", "z": "m", "roll": "rad", "pitch": "rad"}


def placed(area: WorkArea, instance: InstanceLike) -> Array:
    """The task instance (k, c) that a user means.

    What the work area fixes may be left out: a yaw, and by name any axis, or an object with nothing
    that varies. Places outside the work area are allowed.

    Args:
        area: has the k objects and says what varies.
        instance: coordinates of objects by their names, or of all in their order.

    Raises:
        ScenarioError: no such object or axis, the wrong number of numbers, one beyond `FARTHEST`,
            or something that varies is left out.

    >>> bowl = ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), z=0.0)
    >>> cup = ObjectArea("cup", (0.5, -0.2, -1.0), (0.5, 0.8, 1.0), z=0.0)
    >>> placed(WorkArea((bowl, cup)), {"cup": (0.5, 0.3, 0.25), "bowl": (0.9, 0.1)}).tolist()
    [[0.9, 0.1, 0.0], [0.5, 0.3, 0.25]]
    >>> shelf = ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), z=(0.0, 0.4))
    >>> placed(WorkArea((shelf,)), {"bowl": {"x": 0.9, "y": 0.1, "z": 0.2}}).tolist()
    [[0.9, 0.1, 0.0, 0.2, 0.0, 0.0]]
    """
    named = instance if isinstance(instance, Mapping) else _in_order(area, instance)
    known = [item.name for item in area.objects]
    for name in named:
        if name not in known:
            raise ScenarioError(
                f"no object '{name}' in this scenario",
                remedy=suggestion(str(name), known, "Objects"),
            )
    missing = [f"'{o.name}'" for o in area.objects if o.name not in named and o.varies]
    if missing:
        it_varies = "it varies" if len(missing) == 1 else "they vary"
        raise ScenarioError(
            f"no place is given for {' and '.join(missing)}, and {it_varies}", remedy=_form(area)
        )
    found = area.lower
    for i, item in enumerate(area.objects):
        if item.name in named:
            found[i] = _place(area, i, named[item.name])
    return found


def _in_order(area: WorkArea, instance: ArrayLike) -> dict[str, ArrayLike]:
    """Numbers by object; there are as many of each."""
    k, numbers = len(area.objects), _numbers(instance, "the instance", _form(area))
    if k > 1 and len(numbers) not in (2 * k, 3 * k, len(area.axes) * k):
        raise ScenarioError(
            f"an instance of {len(numbers)} numbers, and there are {k} objects",
            remedy=_form(area),
        )
    return dict(zip([o.name for o in area.objects], numbers.reshape(k, -1), strict=True))


def _place(area: WorkArea, i: int, place: PlaceLike) -> Array:
    """(c,) coordinates of one object, of which `place` has all that is not fixed."""
    item = area.objects[i]
    name, form = f"'{item.name}'", _form(area, item)
    given = dict(place) if isinstance(place, Mapping) else _by_axis(area, i, place, form)
    for axis in given:
        if axis not in area.axes:
            raise ScenarioError(
                f"{name} has no axis '{axis}' here", remedy=suggestion(axis, area.axes, "Axes")
            )
    coordinates = area.lower[i]
    for j, axis in enumerate(area.axes):
        if axis not in given:
            if area.free[i, j]:
                raise ScenarioError(f"no {axis} is given for {name}, and it varies", remedy=form)
            continue
        (value,) = _numbers(given[axis], name, form)[:1]
        if not abs(value) <= FARTHEST:
            raise ScenarioError(
                f"{axis} of {name} is {value:g}, expected a number from -{FARTHEST:g} to "
                f"{FARTHEST:g}",
                remedy=form,
            )
        coordinates[j] = value
    return coordinates


def _by_axis(area: WorkArea, i: int, values: ArrayLike, form: str) -> dict[str, float]:
    """Numbers in the order of the axes: two, three, or all."""
    name, turns = f"'{area.objects[i].name}'", area.free[i, area.axes.index("yaw")]
    numbers = _numbers(values, name, form)
    if len(numbers) not in (2, 3, len(area.axes)):
        expected = "x, y and yaw" if turns else "x, y and perhaps yaw"
        count = "1 number" if len(numbers) == 1 else f"{len(numbers)} numbers"
        raise ScenarioError(f"{name} is given {count}, expected {expected}", remedy=form)
    return dict(zip(area.axes, numbers.tolist(), strict=False))


def _numbers(values: ArrayLike, what: str, form: str) -> Array:
    try:
        return np.asarray(values, dtype=float).ravel()
    except (TypeError, ValueError) as error:
        raise ScenarioError(f"{what} is {values!r}, expected numbers", remedy=form) from error


def _form(area: WorkArea, also: ObjectArea | None = None) -> str:
    """How an instance of an area is written, by name, and with one more object."""
    places, told = [], ["x", "y"]
    for i, item in enumerate(area.objects):
        if not item.varies and item is not also:
            continue
        free = [axis for j, axis in enumerate(area.axes) if j > 1 and area.free[i, j]]
        parts = [axis.upper() if axis == "yaw" else f"{axis}={axis.upper()}" for axis in free]
        places.append(",".join([f"{item.name}=X,Y", *parts]))
        told += [axis for axis in free if axis not in told]
    by_unit = {
        unit: [axis.upper() for axis in told if UNITS[axis] == unit] for unit in ("m", "rad")
    }
    units = ", ".join(f"{listed(names)} in {unit}" for unit, names in by_unit.items() if names)
    return f"Give {' '.join(places)}, with {units}."
