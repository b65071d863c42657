"""The JSON Schema of scenario files, for editors, and what it says in words.

``python -m drake_screw.scenario.json_schema > scenarios/scenario.schema.json`` writes it.
"""

from __future__ import annotations

import json
import sys
from functools import cache
from typing import Any

from pydantic.json_schema import GenerateJsonSchema
from pydantic_core.core_schema import ModelSchema

from drake_screw.scenario.block import Block, Keys
from drake_screw.scenario.meanings import meanings
from drake_screw.scenario.schema import Scenario
from drake_screw.scenario.values import Interval

Schema = dict[str, Any]

COMMAND = "python -m drake_screw.scenario.json_schema > scenarios/scenario.schema.json"

_IN_WORDS = {
    "boolean": ("true or false", "truth values"),
    "integer": ("a whole number", "whole numbers"),
    "number": ("a number", "numbers"),
    "string": ("text", "texts"),
    "path": ("a path", "paths"),
}


@cache
def json_schema() -> Schema:
    """The schema, in which ``unit`` and ``description`` describe a key; not to be changed."""
    return Scenario.model_json_schema(schema_generator=_Generator)


def for_editors() -> str:
    """The text of the file: a block without required keys may be left empty, too."""
    dialect = {"$schema": GenerateJsonSchema.schema_dialect}
    title = {"title": "drake_screw scenario"}
    return json.dumps({**dialect, **title, **_with_nothing(json_schema())}, indent=1) + "\n"


def resolved(schema: Schema) -> Schema:
    """The schema with the definition that it refers to filled in, or with its only alternative."""
    if "$ref" in schema:
        definition = json_schema()["$defs"][schema["$ref"].rpartition("/")[2]]
        return {**definition, **schema}
    choices = alternatives(schema)
    return {**resolved(choices[0]), **schema} if len(choices) == 1 else schema


def alternatives(schema: Schema) -> list[Schema]:
    """What a value may be, apart from nothing."""
    choices: list[Schema] = schema.get("anyOf") or schema.get("oneOf") or []
    return [choice for choice in choices if choice.get("type") != "null"]


def at(keys: Keys) -> tuple[Schema, str]:
    """The schema of the value at `keys`, empty for an unknown one, and the meaning of its key."""
    schema, meaning = json_schema(), ""
    for key in keys:
        schema = _inside(schema, key)
        meaning = schema.get("description", meaning)
    return schema, meaning


def describe(schema: Schema) -> str:
    """What a value may be, in words: ``a list of 2 numbers``."""
    schema = resolved(schema)
    if "title" in schema:
        return str(schema["title"])
    if "properties" in schema:
        return f"a mapping with keys {', '.join(schema['properties'])}"
    if "type" not in schema:
        return " or ".join(describe(choice) for choice in alternatives(schema))
    if schema["type"] == "array":
        count = f"{schema['minItems']} " if "minItems" in schema else ""
        return f"a list of {count}{_plural(_entries(schema)[0], 'mappings')}"
    if schema["type"] == "object":
        return f"a mapping from names to {_plural(schema['additionalProperties'], 'values')}"
    return _IN_WORDS[schema.get("format") or schema["type"]][0]


def limits(schema: Schema) -> list[str]:
    """Limits of a number, or of the numbers in a value: ``["above 0", "below 1"]``."""
    words = {
        "exclusiveMinimum": "above",
        "minimum": "at least",
        "exclusiveMaximum": "below",
        "maximum": "at most",
    }
    found = [f"{word} {schema[name]:g}" for name, word in words.items() if name in schema]
    for inner in (*alternatives(schema), *_entries(schema)[:1]):
        found += limits(inner)
    return found


def _entries(schema: Schema) -> list[Schema]:
    """Schemas of what is in a list or a mapping."""
    inside = [schema.get("items"), schema.get("additionalProperties")]
    return [*schema.get("prefixItems", []), *(s for s in inside if isinstance(s, dict))]


def _inside(schema: Schema, key: str | int) -> Schema:
    for choice in (schema, *alternatives(schema)):
        inner = resolved(choice)
        if key in inner.get("properties", ()):
            found: Schema = inner["properties"][key]
            return found
        if _entries(inner):
            return _entries(inner)[0]
    return {}


def _plural(schema: Schema, other: str) -> str:
    kind = schema.get("format") or schema.get("type", "")
    return _IN_WORDS[kind][1] if kind in _IN_WORDS else other


def _with_nothing(schema: Any) -> Any:
    if isinstance(schema, list):
        return [_with_nothing(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    inner = {name: _with_nothing(item) for name, item in schema.items()}
    if schema.get("type") == "object" and "required" not in schema:
        inner["type"] = ["object", "null"]
    return inner


class _Generator(GenerateJsonSchema):
    """With the meanings of keys, and without the names that pydantic gives to keys and classes."""

    def encode_default(self, dft: Any) -> Any:
        return dft.written() if isinstance(dft, Interval) else super().encode_default(dft)

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False

    def model_schema(self, schema: ModelSchema) -> Schema:
        made = super().model_schema(schema)
        made.pop("title", None)
        made.pop("description", None)
        block: type[Block] = schema["cls"]
        for name, meaning in meanings(block).items():
            made["properties"][name]["description"] = meaning
        return made


def main() -> None:
    """Print the file."""
    sys.stdout.write(for_editors())


if __name__ == "__main__":
    main()
