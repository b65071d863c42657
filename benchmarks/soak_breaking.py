"""Ways to break an input: its bytes, its values, its cells, its elements, its files."""

from __future__ import annotations

import copy
import io
import json
import os
import shutil
import socket
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from soak_values import BYTES, VALUES, Random, pick, word


def broken_bytes(rng: Random, data: bytes) -> bytes:
    """Cut off, flipped, overwritten, repeated or with something put in."""
    at, end = sorted(int(i) for i in rng.integers(0, len(data) + 1, 2))
    kept = bytearray(data)
    match int(rng.integers(11)):
        case 0:
            return data[:at]
        case 1:
            return data[at:]
        case 2:
            for i in rng.integers(0, max(len(data), 1), int(rng.integers(1, 9))):
                kept[i : i + 1] = bytes([kept[i] ^ 1 << int(rng.integers(8))]) if kept else b""
            return bytes(kept)
        case 3:
            return data[:at] + bytes(end - at) + data[end:]
        case 4:
            return data[:at] + rng.bytes(int(rng.integers(1, 200))) + data[at:]
        case 5:
            return data[:at] + pick(rng, BYTES) * int(pick(rng, (1, 1, 1, 2, 1000))) + data[at:]
        case 6:
            return data[:at] + data[end:]
        case 7:
            return data[:end] + data[at:]
        case 8:
            return pick(rng, BYTES) + data
        case 9:
            return bytes(
                pick(rng, (b"", b"\x00" * 100, b"\n" * 50, rng.bytes(300), data.hex().encode()))
            )
        case _:
            return data.decode("utf-8", "replace").encode(pick(rng, ("utf-16", "utf-32", "utf-7")))


def broken_lines(rng: Random, data: bytes) -> bytes:
    """Lines left out, repeated, exchanged, indented otherwise, or with a word of another kind."""
    lines = data.decode().split("\n")
    i, k = (int(j) for j in rng.integers(0, len(lines), 2))
    match int(rng.integers(7)):
        case 0:
            del lines[i]
        case 1:
            lines.insert(k, lines[i])
        case 2:
            lines[i], lines[k] = lines[k], lines[i]
        case 3:
            lines[i] = " " * int(rng.integers(1, 5)) + lines[i]
        case 4:
            lines[i] = lines[i].lstrip()
        case 5:
            parts = lines[i].split(" ")
            parts[int(rng.integers(len(parts)))] = word(rng)
            lines[i] = " ".join(parts)
        case _:
            return data.replace(b"\n", pick(rng, (b"\r\n", b"\r", b" ", b"\x85", b"\n\n")))
    return "\n".join(lines).encode("utf-8", "surrogatepass")


def _places(tree: Any) -> Iterator[tuple[Any, Any]]:
    """Every dict or list of a tree, with each key or index in it."""
    for key in list(tree) if isinstance(tree, dict) else range(len(tree)):
        yield tree, key
        if isinstance(tree[key], dict | list):
            yield from _places(tree[key])


def broken_tree(rng: Random, tree: Any) -> Any:
    """A copy of dicts and lists with one to three things wrong."""
    tree = copy.deepcopy(tree)
    for _ in range(int(pick(rng, (1, 1, 1, 2, 3)))):
        places = list(_places(tree))
        if not places:
            return pick(rng, VALUES)
        inside, key = pick(rng, places)
        other, other_key = pick(rng, places)
        match int(rng.integers(9)):
            case 0:
                del inside[key]
            case 1 if isinstance(inside, dict):
                other_name = pick(rng, (f"{key}s", "x", "", 3, "name", str(key).upper()))
                inside[other_name] = inside.pop(key)
            case 1:
                inside.append(copy.deepcopy(inside[key]))
            case 2:
                inside[key] = copy.deepcopy(other[other_key])
            case 3:
                inside[key] = [inside[key]] if rng.random() < 0.5 else {"x": inside[key]}
            case 4:
                inside[key] = str(inside[key]) if rng.random() < 0.5 else word(rng)
            case 5 if isinstance(inside[key], int | float) and not isinstance(inside[key], bool):
                inside[key] = inside[key] * pick(rng, (-1, 0, 1000, 1e-9, 1e30, 57.3))
            case _:
                inside[key] = copy.deepcopy(pick(rng, VALUES))
    return tree


def _deep(rng: Random) -> str:
    """YAML that grows or never ends when it is taken at its word."""
    depth = int(pick(rng, (30, 200, 3000)))
    bomb = "a0: &a0 [x]\n" + "".join(f"a{i}: &a{i} [*a{i - 1}, *a{i - 1}]\n" for i in range(1, 30))
    deep = "[" * depth, "{a: " * depth, "- " * depth
    return str(pick(rng, (*deep, "&a [*a]", bomb, "a: &a {b: *a}")))


def broken_yaml(rng: Random, data: bytes) -> bytes:
    """A YAML file with something wrong in its bytes, its lines or what it says."""
    chance = rng.random()
    if chance < 0.2:
        return broken_bytes(rng, data)
    if chance < 0.4:
        return broken_lines(rng, data)
    if chance < 0.43:
        return (data.decode() + "\nextra: " + _deep(rng)).encode()
    if chance < 0.45:
        return _deep(rng).encode()
    tree = broken_tree(rng, yaml.load(data, Loader=yaml.CSafeLoader))
    style = pick(rng, (None, True, False))
    text = yaml.dump(
        tree, Dumper=yaml.CSafeDumper, default_flow_style=style, sort_keys=False, allow_unicode=True
    )
    return text.encode("utf-8", "surrogatepass")


def broken_json(rng: Random, data: bytes) -> bytes:
    """A JSON file with something wrong in its bytes or what it says."""
    if rng.random() < 0.3:
        return broken_bytes(rng, data)
    if rng.random() < 0.05:
        return ("[" * 100_000).encode()
    return json.dumps(broken_tree(rng, json.loads(data))).encode()


def broken_csv(rng: Random, data: bytes) -> bytes:
    """A table with something wrong in its bytes, its lines, its columns or its cells."""
    chance = rng.random()
    if chance < 0.2:
        return broken_bytes(rng, data)
    if chance < 0.35:
        return broken_lines(rng, data)
    rows = [line.split(",") for line in data.decode().rstrip("\n").split("\n")]
    column, row = int(rng.integers(len(rows[0]))), int(rng.integers(len(rows)))
    match int(rng.integers(9)):
        case 0:
            rows = [[*r[:column], *r[column + 1 :]] for r in rows]
        case 1:
            rows = [[*r, r[min(column, len(r) - 1)]] for r in rows]
        case 2:
            rows = [[*r[:column], word(rng), *r[column + 1 :]] for r in rows]
        case 3:
            rows = [rows[0], *rows[:0:-1]]
        case 4:
            rows = rows[: int(rng.integers(3))]
        case 5:
            rows[row] = rows[row][:column]
        case 6:
            rows[row] = [*rows[row], *(word(rng) for _ in range(int(rng.integers(1, 4))))]
        case _:
            for _ in range(int(pick(rng, (1, 1, 3)))):
                rows[row][column] = word(rng)
                row, column = int(rng.integers(len(rows))), int(rng.integers(len(rows[0])))
                column = min(column, len(rows[row]) - 1)
    separator = pick(rng, (",", ",", ",", ",", ",", ";", "\t", " ", "|"))
    return "\n".join(separator.join(r) for r in rows).encode("utf-8", "surrogatepass")


def broken_xml(rng: Random, data: bytes) -> bytes:
    """A model with something wrong in its bytes, its lines, its elements or their values."""
    chance = rng.random()
    if chance < 0.15:
        return broken_bytes(rng, data)
    if chance < 0.25:
        return broken_lines(rng, data)
    root = ET.fromstring(data)
    for _ in range(int(pick(rng, (1, 1, 1, 2, 3)))):
        inside = [(parent, child) for parent in root.iter() for child in parent]
        if not inside:
            break
        parent, child = pick(rng, inside)
        other = pick(rng, inside)[1]
        match int(rng.integers(8)):
            case 0:
                parent.remove(child)
            case 1:
                parent.append(copy.deepcopy(child))
            case 2:
                child.tag = pick(rng, ("x", "link", "joint", "inertial", "geometry", "include"))
            case 3:
                if other is not child and child not in list(other.iter()):
                    parent.append(copy.deepcopy(other))
            case 4 if child.attrib:
                del child.attrib[pick(rng, list(child.attrib))]
            case 5 | 4:
                texts = [e for e in root.iter() if e.text and e.text.strip()] or [child]
                pick(rng, texts).text = _xml_text(word(rng))
            case 6:
                named = [e for e in root.iter() if e.attrib] or [child]
                one = pick(rng, named)
                key = pick(rng, list(one.attrib)) if one.attrib else "name"
                one.attrib[key] = _xml_text(word(rng))
            case _:
                child.text = _xml_text(word(rng))
    return ET.tostring(root)


def _xml_text(text: str) -> str:
    return "".join(c for c in text if c.isprintable())


def broken_npz(rng: Random, data: bytes) -> bytes:
    """Arrays of another shape, type or name, or missing; or broken bytes."""
    if rng.random() < 0.5:
        return broken_bytes(rng, data)
    with np.load(io.BytesIO(data)) as file:
        arrays: dict[str, Any] = dict(file)
    name = pick(rng, list(arrays))
    array = arrays[name]
    ways: tuple[Callable[[], Any], ...] = (
        lambda: array[:0],
        lambda: np.concatenate([array, array]) if array.ndim else array,
        lambda: array[..., None],
        lambda: array.ravel(),
        lambda: array.astype(str),
        lambda: np.full(array.shape, np.nan),
        lambda: np.full(array.shape, -1),
        lambda: np.full(array.shape, 10**9),
        lambda: array.astype(object),
        lambda: np.array("x"),
    )
    arrays[name] = pick(rng, ways)()
    if rng.random() < 0.2:
        arrays = {key: value for key, value in arrays.items() if key != name}
    if rng.random() < 0.1:
        arrays["x"] = np.zeros(3)
    out = io.BytesIO()
    np.savez_compressed(out, **arrays)
    return out.getvalue()


def broken_place(rng: Random, file: Path) -> None:
    """Something else where a file or folder is: nothing, a folder, a file, a link, a socket."""
    if file.is_dir():
        shutil.rmtree(file)
    else:
        file.unlink()
    match int(rng.integers(6)):
        case 0:
            return
        case 1:
            file.mkdir()
        case 2:
            file.symlink_to(file.name)
        case 3:
            file.symlink_to(pick(rng, ("nowhere", "..", "/", "/dev/null", ".")))
        case 4:
            file.write_bytes(pick(rng, (b"", b"\n", rng.bytes(100))))
        case _:
            with socket.socket(socket.AF_UNIX) as end:
                before = os.getcwd()
                os.chdir(file.parent)
                end.bind(file.name)
                os.chdir(before)


BREAKERS: dict[str, Callable[[Random, bytes], bytes]] = {
    ".yaml": broken_yaml,
    ".json": broken_json,
    ".csv": broken_csv,
    ".sdf": broken_xml,
    ".urdf": broken_xml,
    ".npz": broken_npz,
}
"""By the suffix of a file; all others have broken bytes."""


def break_file(rng: Random, file: Path) -> None:
    """Break a file where it lies."""
    if file.is_dir() or rng.random() < 0.06:
        broken_place(rng, file)
        return
    way = BREAKERS.get(file.suffix, broken_bytes)
    file.write_bytes(way(rng, file.read_bytes()))
