"""What pydantic finds wrong, in the words of the scenario file."""

from __future__ import annotations

import re
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from drake_screw.errors import nearest, suggestion
from drake_screw.scenario.block import Keys, Problem
from drake_screw.scenario.json_schema import Schema, alternatives, at, describe, limits, resolved

_BOUNDS = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")


def problems_of(error: ValidationError, data: Any) -> list[Problem]:
    """One problem for each value that is wrong; none for values inside it.

    A key that is missing is passed over where an unknown key was probably meant to be it.

    Args:
        error: of validating a scenario.
        data: what was validated: dicts, tuples and scalars.
    """
    problems: dict[Keys, Problem] = {}
    meant = set()
    details = error.errors(include_url=False)
    for detail in details:
        if detail["type"] == "extra_forbidden":
            *block, name = detail["loc"]
            meant.add((*block, nearest(str(name), _valid(tuple(block)))))
    for detail in details:
        if _also_text(detail, details, data):
            continue
        problem = _problem(detail, data)
        if not (detail["type"] == "missing" and problem.keys in meant):
            problems.setdefault(problem.keys, problem)
    return [
        p for keys, p in problems.items() if not any(keys[:n] in problems for n in range(len(keys)))
    ]


def _also_text(detail: ErrorDetails, details: list[ErrorDetails], data: Any) -> bool:
    """Whether an error says only that a list, in which something is wrong, is no text either."""
    keys, value = _follow(detail["loc"], data)
    if detail["type"] != "string_type" or not isinstance(value, tuple):
        return False
    places = (_follow(other["loc"], data)[0] for other in details)
    return any(len(place) > len(keys) and place[: len(keys)] == keys for place in places)


def _problem(detail: ErrorDetails, data: Any) -> Problem:
    keys, value = _follow(detail["loc"], data)
    name = detail["loc"][-1] if detail["loc"] else ""
    match detail["type"]:
        case "rule":
            words = detail["ctx"]
            return Problem(detail["loc"], words["message"], words["remedy"])
        case "missing" if isinstance(name, str):
            schema, meaning = at(detail["loc"])
            message = f"missing; expected {describe(schema)}"
            return Problem(detail["loc"], message, f"Meaning: {meaning}.")
        case "extra_forbidden":
            where = f"Keys of {'.'.join(map(str, keys[:-1])) or 'a scenario'}"
            return Problem(keys, "unknown key", suggestion(str(name), _valid(keys[:-1]), where))
    schema, meaning = at(keys)
    match detail["type"]:
        case "literal_error" if isinstance(value, str) and "enum" in schema:
            remedy = suggestion(value, schema["enum"], "Choices")
            return Problem(keys, f"there is no '{value}'", remedy)
        case "string_pattern_mismatch":
            return Problem(keys, f"expected the {meaning}; found '{value}'")
        case kind if kind in _BOUNDS:
            bounds = " and ".join(limits(schema)).replace("at ", "of at ")
            found = _found(value).removeprefix("the number ")
            message = f"expected a number {bounds}, found {found}"
            return Problem(keys, message, f"Meaning: {meaning}.")
    return _mismatch(keys, schema, value)


def _valid(block: Keys) -> list[str]:
    """The keys of a block."""
    return list(resolved(at(block)[0])["properties"])


def _mismatch(keys: Keys, schema: Schema, value: Any) -> Problem:
    fitting = [s for s in alternatives(schema) if s.get("type") == "array"]
    wanted = describe(fitting[0] if fitting and isinstance(value, tuple) else schema)
    remedy = None
    if isinstance(value, str) and wanted.startswith(("a number", "a whole number")):
        if re.fullmatch(r"[-+.0-9eE]*[0-9][-+.0-9eE]*", value):
            remedy = "Write it without quotes."
    elif wanted == "text" and isinstance(value, bool | int | float):
        remedy = "Put it in quotes to make it text."
    return Problem(keys, f"expected {wanted}, found {_found(value)}", remedy)


def _follow(loc: Keys, data: Any) -> tuple[Keys, Any]:
    """The part of an error's place that is in the data, and what is there.

    Passes over what pydantic adds: names of alternatives, and places in what is no list.
    """
    keys: Keys = ()
    for name in loc:
        if isinstance(data, dict) and name in data:
            data = data[str(name)]
        elif isinstance(data, tuple) and isinstance(name, int) and name < len(data):
            data = data[name]
        else:
            continue
        keys = (*keys, name)
    return keys, data


def _found(value: Any) -> str:
    if isinstance(value, tuple):
        return f"a list of {len(value)}"
    if isinstance(value, dict):
        return f"a mapping with keys {', '.join(value)}" if value else "an empty mapping"
    if value is None:
        return "nothing"
    if isinstance(value, str):
        return f"text '{value[:40]}{'...' if len(value) > 40 else ''}'"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int) and abs(value) >= 10**40:
        return "a number far too large"
    return f"the number {value!r}"
