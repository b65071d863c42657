"""Texts, values and bytes that stand where others should."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

NUMBERS = (
    *("nan", ".nan", "inf", "-.inf", "1e308", "-1e308", "1e-320", "1e999", "0", "-1", "-0.0"),
    *("1", "2", "1e9", "99999999", "-99999999", "9" * 25, "9" * 5000, "0x10", "1_000", "1,5"),
    *("1.5.2", "--3", "1e", "٣", "½", "1 000", "+", "1e5000", "3.14159", "6.2832", "180"),
)
WORDS = (
    *("", " ", "~", "null", "true", "no", "[]", "{}", "[1, 2", "{a: 1", "&a [*a]", "*nobody"),
    *("!!python/object:os.system x", "!tag 1", "? a", "- - - x", "a: b: c", "%", "@x", "`x`", "#"),
    *(
        "'",
        '"',
        "'open",
        '"\\x"',
        '"\\U00110000"',
        '"\\ud800"',
        "\x00",
        "\x07",
        "\x1b[31m",
        "\u2028",
    ),
    *("x" * 300, "x" * 6000, "é" * 300, "名前", "\u202e", "a/b", "../..", "/", "/dev/null", "."),
    *("~root", "$HOME", "{x}", "%s", "NaN", "None", "a\nb", "a\tb", "-", "--", "=", "a=b", "a.b.c"),
    *("package://nowhere/x", "http://localhost:1/x", "file:///x", "con", "bowl", "base", "world"),
)
VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 1, 2, 10**25, 10**400, 1e308, -1e308, 5e-324, 0.5, -0.5, 1e6, 3),
    *(
        float("nan"),
        float("inf"),
        float("-inf"),
        "",
        "x",
        "\x00",
        "é",
        "x" * 3000,
        "1",
        "nan",
        "a b",
    ),
    *([], {}, [[]], [None], {"": 1}, {"x": {}}, [1, 2], [2, 1], [0, 0], [1, 2, 3], ["a"], [[1], 2]),
    *([float("nan"), 1], [1e308, 1e308], {"a": 1, "b": [1]}, list(range(500)), [{}] * 3, 4097),
    *("/", ".", "..", "/dev/null", "nowhere.yaml", "os:system", "no.such:Thing", "base", "bowl"),
)
BYTES = (
    *(b"\xef\xbb\xbf", b"\xff\xfe", b"\x00", b"\xff", b"\xc3\x28", b"\xed\xa0\x80", b"\r\n", b"\r"),
    *(b"\n\n", b"\t", b"\x1b", b"\x85", b"\xe2\x80\xa8", b"\x1a", b"---\n", b"...\n", b'"', b"'"),
    *(
        b"<",
        b"&",
        b"&#0;",
        b"]]>",
        b"{",
        b"}",
        b"[",
        b"]",
        b":",
        b",",
        b";",
        b"-",
        b"\\",
        b"*a",
        b"%",
    ),
)

Random = np.random.Generator


def pick(rng: Random, choices: Sequence[Any]) -> Any:
    """One of some choices."""
    return choices[int(rng.integers(len(choices)))]


def word(rng: Random) -> str:
    """A text that stands for a value."""
    return str(pick(rng, NUMBERS if rng.random() < 0.5 else WORDS))
