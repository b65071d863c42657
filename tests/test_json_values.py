"""What others wrote as JSON is one value or a ValueError, however deep it goes."""

from __future__ import annotations

import pytest

from drake_screw.json_values import decode_json, within


@pytest.mark.parametrize("text", ["", "[1", '{"a": 1', "[" * 100_000, '{"a":' * 100_000, b"\xff"])
def test_what_is_no_json_is_a_value_error(text: str | bytes) -> None:
    with pytest.raises(ValueError, match=r"."):
        decode_json(text)


def test_what_stands_within_is_none_where_there_is_none() -> None:
    value = {"a": {"b": 3}, "c": [1]}
    assert within(value, "a", "b") == 3
    assert within(value) is value
    for keys in (("a", "x"), ("c", "b"), ("a", "b", "x"), ("x", "y")):
        assert within(value, *keys) is None
    assert within([1], "a") is None
