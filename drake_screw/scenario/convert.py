"""Between trees of YAML and dataclasses, driven by the type hints of their fields."""

from __future__ import annotations

import math
import os
import re
from dataclasses import MISSING, Field, fields, is_dataclass
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from drake_screw.errors import nearest
from drake_screw.resources import MODEL_SUFFIXES, looks_like_path
from drake_screw.scenario.checks import Keys, Problem, suggestion
from drake_screw.scenario.schema import Interval, ModelName
from drake_screw.scenario.yaml_marks import Entries, Items, Node, Scalar

_NAMES: dict[Any, tuple[str, str]] = {
    bool: ("true or false", "truth values"),
    int: ("a whole number", "whole numbers"),
    float: ("a number", "numbers"),
    str: ("text", "texts"),
    Path: ("a path", "paths"),
    ModelName: ("a model's name or path", "models"),
    Interval: ("a number or [lower, upper]", "ranges"),
    NoneType: ("nothing", "nothing"),
}


def from_tree(hint: Any, node: Node, keys: Keys, problems: list[Problem]) -> Any:
    """The value of type `hint` that a node spells.

    Mappings become dataclasses or dicts, lists tuples. An empty value stands for an empty mapping.
    Relative paths are seen from the place they are written in.

    Args:
        hint: a dataclass, tuple, dict, union, or one of the plain types of a scenario.
        node: what the file has there.
        keys: the way to it.
        problems: everything wrong is appended here; the value is then meaningless.
    """
    origin, arguments = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        return _union(hint, node, keys, problems)
    if hint is Interval and isinstance(node, Items):
        ends = from_tree(tuple[float, float], node, keys, problems)
        return ends if ends is None else Interval(*ends)
    if hint is Interval:
        value = from_tree(float, node, keys, []) if isinstance(node, Scalar) else None
        if value is not None:
            return Interval(value, value)
    elif is_dataclass(hint) or origin is dict:
        if isinstance(node, Scalar) and node.value is None:
            node = Entries({}, node.place)
        if isinstance(node, Entries) and origin is dict:
            return {
                name: from_tree(arguments[1], item, (*keys, name), problems)
                for name, item in node.entries.items()
            }
        if isinstance(node, Entries):
            return _block(hint, node, keys, problems)
    elif origin is tuple and isinstance(node, Items):
        hints = arguments[:1] * len(node.items) if arguments[-1] is ... else arguments
        if len(hints) == len(node.items):
            found = len(problems)
            values = tuple(
                from_tree(item_hint, item, (*keys, index), problems)
                for index, (item_hint, item) in enumerate(zip(hints, node.items, strict=True))
            )
            return values if len(problems) == found else None
    elif isinstance(node, Scalar):
        value = _scalar(hint, node)
        if value is not None:
            return value
    problems.append(Problem(keys, *_mismatch(hint, node)))
    return None


def to_plain(value: Any) -> Any:
    """A value of `from_tree` as dicts, lists and scalars, for a YAML dumper.

    Leaves out what is None, and fields that are not keys of the file. Makes paths absolute.
    """
    if isinstance(value, Interval):
        return value.lower if value.fixed else [value.lower, value.upper]
    if is_dataclass(value):
        items = {f.name: getattr(value, f.name) for f in fields(value) if _is_key(f)}
        return {name: to_plain(item) for name, item in items.items() if item is not None}
    if isinstance(value, dict):
        return {name: to_plain(item) for name, item in value.items()}
    if isinstance(value, tuple):
        return [to_plain(item) for item in value]
    return os.path.abspath(value) if isinstance(value, Path) else value


def _block(hint: Any, node: Entries, keys: Keys, problems: list[Problem]) -> Any:
    hints = get_type_hints(hint)
    valid = {f.name: f for f in fields(hint) if _is_key(f)}
    found = len(problems)
    values, meant = {}, set()
    for name, item in node.entries.items():
        if name in valid:
            values[name] = from_tree(hints[name], item, (*keys, name), problems)
        else:
            where = f"Keys of {'.'.join(map(str, keys)) or 'a scenario'}"
            problems.append(Problem((*keys, name), "unknown key", suggestion(name, valid, where)))
            meant.add(nearest(name, valid))
    for name, entry in valid.items():
        required = entry.default is MISSING and entry.default_factory is MISSING
        if required and name not in values and name not in meant:
            message = f"missing; expected {describe(hints[name])}"
            problems.append(
                Problem((*keys, name), message, f"Meaning: {entry.metadata['meaning']}.")
            )
    return hint(**values) if len(problems) == found else None


def _is_key(item: Field[Any]) -> bool:
    return "meaning" in item.metadata


def _union(hint: Any, node: Node, keys: Keys, problems: list[Problem]) -> Any:
    if isinstance(node, Scalar) and node.value is None and NoneType in get_args(hint):
        return None
    fitting = [h for h in get_args(hint) if isinstance(node, _kind(h)) and h is not NoneType]
    if len(fitting) == 1 and not isinstance(node, Scalar):
        return from_tree(fitting[0], node, keys, problems)
    for alternative in fitting:
        trial: list[Problem] = []
        value = from_tree(alternative, node, keys, trial)
        if not trial:
            return value
    problems.append(Problem(keys, *_mismatch(hint, node)))
    return None


def _kind(hint: Any) -> type[Node]:
    if is_dataclass(hint) or get_origin(hint) is dict:
        return Entries
    return Items if get_origin(hint) is tuple else Scalar


def _scalar(hint: Any, node: Scalar) -> Any:
    """The scalar as `hint`, or None where it is of another type."""
    value = node.value
    if hint in (bool, int, str):
        return value if type(value) is hint else None
    if hint is float and isinstance(value, int | float) and not isinstance(value, bool):
        try:
            return float(value) if math.isfinite(float(value)) else None
        except OverflowError:
            return None
    if not isinstance(value, str) or not value:
        return None
    path = os.path.abspath(node.place.folder / os.path.expanduser(value))
    if hint is ModelName:
        return path if looks_like_path(value, MODEL_SUFFIXES) else value
    return Path(path) if hint is Path else None


def _mismatch(hint: Any, node: Node) -> tuple[str, str | None]:
    remedy = None
    if isinstance(node, Scalar) and hint in (float, int, Interval) and type(node.value) is str:
        if re.fullmatch(r"[-+.0-9eE]*[0-9][-+.0-9eE]*", node.value):
            remedy = "Write it without quotes."
    elif isinstance(node, Scalar) and hint is str and node.value is not None:
        remedy = "Put it in quotes to make it text."
    return f"expected {describe(hint)}, found {_found(node)}", remedy


def describe(hint: Any) -> str:
    """A type in words: ``a list of 2 numbers``."""
    origin, arguments = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        return " or ".join(describe(h) for h in arguments if h is not NoneType)
    if origin is tuple:
        count = "" if arguments[-1] is ... else f"{len(arguments)} "
        return f"a list of {count}{_NAMES.get(arguments[0], ('', 'mappings'))[1]}"
    if origin is dict:
        plural = _NAMES.get(arguments[1], ("", "values"))[1]
        return f"a mapping from names to {plural}"
    if hint in _NAMES:
        return _NAMES[hint][0]
    return "a mapping with keys " + ", ".join(f.name for f in fields(hint) if _is_key(f))


def _found(node: Node) -> str:
    if isinstance(node, Items):
        return f"a list of {len(node.items)}"
    if isinstance(node, Entries):
        return (
            f"a mapping with keys {', '.join(node.entries)}" if node.entries else "an empty mapping"
        )
    if node.value is None:
        return "nothing"
    if isinstance(node.value, str):
        return f"text '{node.value[:40]}{'...' if len(node.value) > 40 else ''}'"
    return str(node.value).lower() if isinstance(node.value, bool) else _number(node.value)


def _number(value: float) -> str:
    if isinstance(value, int):
        return f"the number {value}" if abs(value) < 10**40 else "a number far too large"
    return f"the number {value!r}"
