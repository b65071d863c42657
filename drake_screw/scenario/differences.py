"""Where settings in plain data, such as scenarios, differ: key by key."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import yaml

from drake_screw.scenario.schema import Scenario
from drake_screw.scenario.yaml_marks import Dumper


@dataclass(frozen=True)
class Difference:
    """A key that does not have the same value everywhere.

    Attributes:
        key: with dots, as ``--set`` takes it.
        values: one of each; None where there is no such key.
    """

    key: str
    values: tuple[Any, ...]

    @property
    def words(self) -> tuple[str, ...]:
        """The values as YAML on one line each; "" where there is no such key.

        Numbers have as many digits as tell them apart, and six at least.
        """
        short = tuple(f"{v:.6g}" if isinstance(v, float) else _yaml(v) for v in self.values)
        if all((a == b) == _same(v, w) for a, v in self._with(short) for b, w in self._with(short)):
            return short
        return tuple(map(_yaml, self.values))

    def _with(self, words: tuple[str, ...]) -> list[tuple[str, Any]]:
        return list(zip(words, self.values, strict=True))


def scenario_differences(scenarios: Sequence[Scenario]) -> tuple[Difference, ...]:
    """The keys in which scenarios differ, in the order of the schema."""
    return differences([s.model_dump(mode="json", exclude_none=True) for s in scenarios])


def differences(settings: Sequence[Mapping[str, Any]]) -> tuple[Difference, ...]:
    """The keys in which some settings differ.

    A block or a list of blocks is gone into where all have one; where one lacks it, it is a value.

    >>> [(d.key, d.values) for d in differences([{"a": {"b": 1, "c": 2}}, {"a": {"b": 1}}])]
    [('a.c', (2, None))]
    """
    return tuple(_walk("", tuple(settings)))


def _walk(key: str, values: tuple[Any, ...]) -> Iterator[Difference]:
    first = values[0]
    if all(_same(value, first) for value in values):
        return
    parts = [_parts(value) for value in values]
    if any(part is None for part in parts):
        yield Difference(key, values)
        return
    names = dict.fromkeys(name for part in parts for name in part or ())
    for name in names:
        path = f"{key}.{name}" if key else name
        yield from _walk(path, tuple((part or {}).get(name) for part in parts))


def _same(a: object, b: object) -> bool:
    return a == b and isinstance(a, bool) == isinstance(b, bool)


def _parts(value: object) -> Mapping[str, Any] | None:
    """What a block or a list of blocks is made of, by key or place; None of anything else."""
    if isinstance(value, Mapping):
        return value
    if isinstance(value, list | tuple) and all(isinstance(item, Mapping) for item in value):
        return {str(place): item for place, item in enumerate(value)}
    return None


def _yaml(value: object) -> str:
    if value is None:
        return ""
    text = yaml.dump(
        value,
        Dumper=Dumper,
        default_flow_style=True,
        sort_keys=False,
        allow_unicode=True,
        width=float("inf"),
    )
    return text.removesuffix("\n").removesuffix("\n...")
