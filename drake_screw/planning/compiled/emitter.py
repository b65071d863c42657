"""Straight-line code from symbolic arithmetic: what is constant or zero is never computed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

Value = float | str
"""A constant, or the name of a variable in the code written so far."""

Vector = Sequence[Value]


class Emitter:
    """Writes one assignment a line, and folds constants on the way.

    `load` and `store` address a row of the block of lanes b, a flat array with rows of `lanes`
    numbers, at lane i. LLVM turns the loop over lanes into vector instructions if nothing is in its
    way: a constant number of turns, one array, unsigned indices (signed ones may count from the
    end), no calls, no branches but selections.
    """

    def __init__(self, lanes: int) -> None:
        self.lines: list[str] = []
        self.lanes = lanes

    def let(self, expression: str) -> str:
        """A new variable with the value of an expression."""
        name = f"t{len(self.lines)}"
        self.lines.append(f"{name} = {expression}")
        return name

    def load(self, row: int) -> str:
        return self.let(f"b[i + uintp({row * self.lanes})]")

    def store(self, row: int, value: Value) -> None:
        self.lines.append(f"b[i + uintp({row * self.lanes})] = {text(value)}")

    def sum(self, *products: Sequence[Value]) -> Value:
        """A sum of products, e.g. sum((a, b), (-1.0, c, d)) for a b - c d."""
        constant, terms = 0.0, []
        for product in products:
            scale = 1.0
            names = []
            for factor in product:
                if isinstance(factor, str):
                    names.append(factor)
                else:
                    scale *= factor
            if not names:
                constant += scale
            elif scale != 0.0:
                terms.append((scale, "*".join(names)))
        if not terms:
            return constant
        if len(terms) == 1 and constant == 0.0 and terms[0][0] == 1.0 and "*" not in terms[0][1]:
            return terms[0][1]
        parts = [_signed(scale, names) for scale, names in terms]
        if constant != 0.0:
            parts.append(f"+ {text(constant)}")
        return self.let(" ".join(parts).removeprefix("+ "))

    def dot(self, a: Iterable[Value], b: Iterable[Value]) -> Value:
        return self.sum(*zip(a, b, strict=True))

    def cross(self, a: Vector, b: Vector) -> list[Value]:
        return [self.sum((a[j], b[k]), (-1.0, a[k], b[j])) for j, k in ((1, 2), (2, 0), (0, 1))]

    def combine(self, a: Value, x: Vector, b: Value, y: Vector) -> list[Value]:
        """The vector a x + b y."""
        return [self.sum((a, xi), (b, yi)) for xi, yi in zip(x, y, strict=True)]

    def where(self, condition: str, yes: Value, no: Value) -> str:
        return self.let(f"{text(yes)} if {condition} else {text(no)}")

    def polynomial(self, x: str, coefficients: Iterable[float]) -> str:
        """Horner's scheme; coefficients from the constant term up."""
        highest, *rest = reversed(list(coefficients))
        result = text(highest)
        for c in rest:
            result = f"({result})*{x} + {text(c)}"
        return self.let(result)

    def function(self, name: str, summary: str) -> str:
        """The source text of a function that does this on every lane of a block."""
        body = "\n".join(f"        {line}" for line in self.lines)
        return (
            f"@lane_code\ndef {name}(b):\n"
            f'    """{summary}"""\n'
            f"    for j in range({self.lanes}):\n        i = uintp(j)\n{body}\n"
        )


def text(value: Value) -> str:
    if isinstance(value, str):
        return value
    return repr(float(value)) if value >= 0.0 else f"({float(value)!r})"


def _signed(scale: float, names: str) -> str:
    sign = "-" if scale < 0.0 else "+"
    size = abs(scale)
    return f"{sign} {names}" if size == 1.0 else f"{sign} {size!r}*{names}"
