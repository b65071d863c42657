"""Where a user puts the objects: a task instance by their names, or as plain numbers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.errors import ScenarioError, suggestion
from drake_screw.tasks import AXES, ObjectArea, WorkArea
from drake_screw.typing import Array

InstanceLike = Mapping[str, ArrayLike] | ArrayLike
"""{object: (x, y[, yaw])}, or x, y and perhaps yaw of each object in their order; m and rad."""


def placed(area: WorkArea, instance: InstanceLike) -> Array:
    """The task instance (k, 3) that a user means.

    A yaw may be left out where the work area fixes it, and by name an object with nothing that
    varies. Places outside the work area are allowed.

    Args:
        area: has the k objects and says what varies.
        instance: x, y in m and yaw in rad of objects by their names, or of all in their order.

    Raises:
        ScenarioError: no such object, the wrong number of numbers, one that is not finite, or
            something that varies is left out.

    >>> bowl = ObjectArea("bowl", (0.7, -0.2, 0.0), (1.1, 0.8, 0.0), z=0.0)
    >>> cup = ObjectArea("cup", (0.5, -0.2, -1.0), (0.5, 0.8, 1.0), z=0.0)
    >>> placed(WorkArea((bowl, cup)), {"cup": (0.5, 0.3, 0.25), "bowl": (0.9, 0.1)}).tolist()
    [[0.9, 0.1, 0.0], [0.5, 0.3, 0.25]]
    """
    named = instance if isinstance(instance, Mapping) else _in_order(area, instance)
    known = [item.name for item in area.objects]
    for name in named:
        if name not in known:
            raise ScenarioError(
                f"no object '{name}' in this scenario",
                remedy=suggestion(str(name), known, "Objects"),
            )
    missing = [f"'{o.name}'" for o in area.objects if o.name not in named and _varies(o)]
    if missing:
        it_varies = "it varies" if len(missing) == 1 else "they vary"
        raise ScenarioError(
            f"no place is given for {' and '.join(missing)}, and {it_varies}", remedy=_form(area)
        )
    return np.array(
        [_place(o, named[o.name], area) if o.name in named else o.lower for o in area.objects]
    )


def _in_order(area: WorkArea, instance: ArrayLike) -> dict[str, ArrayLike]:
    """Numbers by object; there are as many of each."""
    k, numbers = len(area.objects), _numbers(instance, "the instance", _form(area))
    if k > 1 and len(numbers) not in (2 * k, 3 * k):
        raise ScenarioError(
            f"an instance of {len(numbers)} numbers, and there are {k} objects",
            remedy=_form(area),
        )
    return dict(zip([o.name for o in area.objects], numbers.reshape(k, -1), strict=True))


def _place(item: ObjectArea, values: ArrayLike, area: WorkArea) -> Array:
    """x, y, yaw of one object, of which `values` has all that is not fixed."""
    name, turns, form = f"'{item.name}'", item.name in area.turning, _form(area, item)
    numbers = _numbers(values, name, form)
    if turns and len(numbers) == 2:
        raise ScenarioError(f"no yaw is given for {name}, and it varies", remedy=form)
    if len(numbers) not in (2, 3):
        expected = "x, y and yaw" if turns else "x, y and perhaps yaw"
        count = "1 number" if len(numbers) == 1 else f"{len(numbers)} numbers"
        raise ScenarioError(f"{name} is given {count}, expected {expected}", remedy=form)
    for axis, value in zip(AXES, numbers, strict=False):
        if not np.isfinite(value):
            raise ScenarioError(
                f"{axis} of {name} is {value:g}, expected a finite number", remedy=form
            )
    return np.concatenate([numbers, item.lower[len(numbers) :]])


def _numbers(values: ArrayLike, what: str, form: str) -> Array:
    try:
        return np.asarray(values, dtype=float).ravel()
    except (TypeError, ValueError) as error:
        raise ScenarioError(f"{what} is {values!r}, expected numbers", remedy=form) from error


def _varies(item: ObjectArea) -> bool:
    return item.lower != item.upper


def _form(area: WorkArea, also: ObjectArea | None = None) -> str:
    """How an instance of an area is written, by name, and with one more object."""
    listed = [o for o in area.objects if _varies(o) or o is also]
    places = [f"{o.name}=X,Y" + (",YAW" if o.name in area.turning else "") for o in listed]
    units = "X and Y in m, YAW in rad" if area.turning else "X and Y in m"
    return f"Give {' '.join(places)}, with {units}."
