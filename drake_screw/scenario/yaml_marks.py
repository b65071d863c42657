"""YAML as a tree in which every value knows where it was written.

Numbers, truth values and nulls are those of YAML 1.2: ``1e-5`` is a number, ``no`` is text.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from drake_screw.errors import ScenarioError


@dataclass(frozen=True)
class Place:
    """Where a value was written: at a line of a file, or in an override of the command line."""

    file: Path | None = None
    line: int | None = None
    override: str | None = None

    @property
    def folder(self) -> Path:
        """The folder that relative paths written here start from."""
        return Path.cwd() if self.file is None else self.file.parent

    def error(self, message: str, remedy: str | None = None) -> ScenarioError:
        """An error that names this place, to be raised."""
        if self.override is not None:
            message = f"--set {self.override}: {message}"
        return ScenarioError(message, remedy=remedy, file=self.file, line=self.line)


@dataclass(frozen=True)
class Scalar:
    """A single value, of the type that YAML sees in it; None where nothing is written."""

    value: bool | int | float | str | None
    place: Place


@dataclass(frozen=True)
class Items:
    """A list, in the order of the file."""

    items: tuple[Node, ...]
    place: Place


@dataclass(frozen=True)
class Entries:
    """A mapping from keys to what is written there, in the order of the file."""

    entries: dict[str, Node]
    place: Place


Node = Scalar | Items | Entries


class Text(str):
    """A text that knows the folder from which a relative path in it is seen."""

    folder: Path


def plain(node: Node) -> Any:
    """The tree as dicts, tuples and scalars, the texts among them as `Text`."""
    if isinstance(node, Entries):
        return {name: plain(value) for name, value in node.entries.items()}
    if isinstance(node, Items):
        return tuple(plain(item) for item in node.items)
    if not isinstance(node.value, str):
        return node.value
    text = Text(node.value)
    text.folder = node.place.folder
    return text


MOST_VALUES = 100_000
"""In a text, every alias written out; each use of one is a value of its own."""

_TAG = "tag:yaml.org,2002:"
_NO_CHARACTER = re.compile(r"\\U(?!000|0010)[0-9a-fA-F]{8}")
_FLOAT = re.compile(
    r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$|[-+]?\.(inf|Inf|INF)$|\.(nan|NaN|NAN)$"
)

_SCALARS: dict[str, Callable[[str], bool | int | float | str | None]] = {
    "null": lambda text: None,
    "bool": lambda text: text.lower() == "true",
    "int": int,
    "float": lambda text: float(re.sub(r"\.(?=[iInN])", "", text)),
    "str": str,
}


class _Loader(yaml.SafeLoader):
    yaml_implicit_resolvers = {}  # noqa: RUF012 (PyYAML's own way)


for _name, _pattern, _first in (
    ("null", re.compile(r"(~|null|Null|NULL|)$"), ["~", "n", "N", ""]),
    ("bool", re.compile(r"(true|True|TRUE|false|False|FALSE)$"), list("tTfF")),
    ("int", re.compile(r"[-+]?[0-9]+$"), list("-+0123456789")),
    ("float", _FLOAT, list("-+.0123456789")),
):
    _Loader.add_implicit_resolver(_TAG + _name, _pattern, _first)


class Dumper(yaml.SafeDumper):
    """Writes YAML that `parse` reads back unchanged.

    Quotes text that looks like a number, and escapes what is not printable, such as the line
    breaks of Unicode, which a reader would fold.
    """

    def ignore_aliases(self, data: object) -> bool:
        """Write out again what occurs twice."""
        return True

    def represent_str(self, data: str) -> yaml.ScalarNode:
        """Text, in double quotes where it has characters that cannot be printed."""
        style = None if data.isprintable() else '"'
        return self.represent_scalar(_TAG + "str", data, style=style)


Dumper.add_representer(str, Dumper.represent_str)
Dumper.add_implicit_resolver(_TAG + "float", _FLOAT, list("-+.0123456789"))


def parse(text: str, place: Place) -> Node | None:
    """The tree of a YAML text, or None where it has no content.

    Args:
        text: the whole YAML document.
        place: the file, or the override, that it comes from. Lines are filled in for a file.

    Raises:
        ScenarioError: the text is not YAML, repeats a key, uses tags, or is made of aliases of
            aliases that stand for more than `MOST_VALUES`.
    """
    try:
        root = yaml.compose(text, Loader=_Loader)
        tree = None if root is None else _Tree(place).node(root, None, "")
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise _at(place, line).error(
            f"not valid YAML: the character #x{ord(text[error.position]):02x} is not allowed",
            "Delete it.",
        ) from None
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        since = error.context_mark.line + 1 if error.context_mark else 0
        raise _at(place, mark.line + 1 if mark else 1).error(
            f"not valid YAML: {error.problem or error.context}",
            f"Found {error.context} that starts in line {since}."
            if error.context and since and place.file
            else None,
        ) from None
    except ValueError:  # of chr()
        line = next((i for i, t in enumerate(text.splitlines(), 1) if _NO_CHARACTER.search(t)), 1)
        raise _at(place, line).error(
            r"not valid YAML: \U... stands for no character", r"The last one is \U0010FFFF."
        ) from None
    except RecursionError:
        raise place.error("not usable: nested too deeply, or an alias of itself") from None
    if tree is not None and _size(tree, {}) > MOST_VALUES:
        raise place.error(
            f"not usable: aliases make more than {MOST_VALUES:,} values of it",
            "Write out what is meant, without & and *.",
        )
    return tree


def _size(node: Node, known: dict[int, int]) -> int:
    """How many values there are once every alias is written out."""
    if id(node) not in known:
        inside: Iterable[Node] = ()
        if isinstance(node, Entries):
            inside = node.entries.values()
        elif isinstance(node, Items):
            inside = node.items
        known[id(node)] = 1 + sum(_size(each, known) for each in inside)
    return known[id(node)]


def put(tree: Node, keys: tuple[str, ...], value: Node, done: tuple[str, ...] = ()) -> Node:
    """A copy of the tree with the value at `keys` replaced, or added.

    Places in lists are given as numbers from 0. Where several keys joined by dots name a key
    that exists (``bowl.x`` of a grid), they are taken as that key.

    Raises:
        ScenarioError: `keys` lead into a text or a number, or past the end of a list.
    """
    if not keys:
        return value
    here = ".".join(done)
    if isinstance(tree, Scalar) and tree.value is None:
        tree = Entries({}, value.place)
    if isinstance(tree, Scalar):
        raise value.place.error(f"{here} is a single value; there is no {keys[0]} in it")
    if isinstance(tree, Items):
        count = len(tree.items)
        if not re.fullmatch("[0-9]{1,9}", keys[0]) or int(keys[0]) >= count:
            valid = f"0 to {count - 1}" if count > 1 else "0" if count else "none; it is empty"
            raise value.place.error(f"no entry {keys[0]} in the list {here}", f"Entries: {valid}")
        index = int(keys[0])
        item = put(tree.items[index], keys[1:], value, (*done, keys[0]))
        return Items((*tree.items[:index], item, *tree.items[index + 1 :]), tree.place)
    joined = [".".join(keys[:n]) for n in range(len(keys), 0, -1)]
    name = next((name for name in joined if name in tree.entries), keys[0])
    rest = keys[name.count(".") + 1 :]
    old = tree.entries.get(name, Entries({}, value.place))
    new = put(old, rest, value, (*done, name))
    return Entries({**tree.entries, name: new}, tree.place)


def locate(tree: Node, keys: tuple[str | int, ...]) -> Place:
    """The place of the value at `keys`, or of the innermost block around it that was written."""
    node = tree
    for name in keys:
        if isinstance(node, Entries) and name in node.entries:
            node = node.entries[str(name)]
        elif isinstance(node, Items) and isinstance(name, int) and name < len(node.items):
            node = node.items[name]
        else:
            break
    return node.place


def _at(place: Place, line: int) -> Place:
    return place if place.file is None else Place(place.file, line)


class _Tree:
    """Turns PyYAML's nodes into ours, each alias once."""

    def __init__(self, place: Place) -> None:
        self.place = place
        self.known: dict[tuple[yaml.Node, int], Node] = {}

    def node(self, node: yaml.Node, line: int | None, path: str) -> Node:
        """`line` is that of the key, where there is one: a value may start on a later line."""
        line = node.start_mark.line + 1 if line is None else line
        if (node, line) not in self.known:
            self.known[node, line] = self._node(node, _at(self.place, line), path)
        return self.known[node, line]

    def _node(self, node: yaml.Node, place: Place, path: str) -> Node:
        tag = node.tag.removeprefix(_TAG)
        if isinstance(node, yaml.SequenceNode) and tag == "seq":
            items = (self.node(n, None, f"{path}{i}.") for i, n in enumerate(node.value))
            return Items(tuple(items), place)
        if isinstance(node, yaml.MappingNode) and tag == "map":
            return Entries(self._entries(node, path), place)
        where = path.removesuffix(".") or "scenario"
        if isinstance(node, yaml.ScalarNode) and tag in _SCALARS:
            try:
                return Scalar(_SCALARS[tag](node.value), place)
            except ValueError:
                found = f"'{node.value[:40]}'"
                raise place.error(f"{where}: expected a number, found {found}") from None
        raise place.error(f"{where}: the tag {node.tag} has no meaning here", "Leave it out.")

    def _entries(self, node: yaml.MappingNode, path: str) -> dict[str, Node]:
        entries: dict[str, Node] = {}
        lines: dict[str, int] = {}
        for key_node, value in node.value:
            line = key_node.start_mark.line + 1
            place = _at(self.place, line)
            if not isinstance(key_node, yaml.ScalarNode):
                where = path.removesuffix(".") or "scenario"
                raise place.error(f"{where}: a key must be a name, not a list or a mapping")
            name = key_node.value
            if name in entries:
                first = f" in line {lines[name]}" if place.line else ""
                raise place.error(
                    f"{path}{name}: repeated key; it is already given{first}",
                    "Keep one of the two.",
                )
            entries[name], lines[name] = self.node(value, line, f"{path}{name}."), line
        return entries
