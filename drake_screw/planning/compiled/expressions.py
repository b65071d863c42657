"""Algebra on blocks of lanes: arithmetic that is written down now, and compiled later.

Reading a row of a `Block` gives an expression for the numbers in it; operators and the functions
below make expressions of expressions, and storing one in a row records it. Vectors and matrices
are numpy arrays of dtype object, so that `+`, `@`, `np.cross` and slices work as they always do:

>>> b = Block()
>>> x, y = b[0:2], b[2:4]
>>> work = x @ y
>>> b[4] = where(work < 0.0, 0.0, sqrt(work))
>>> b[5:8] = 2.0 * np.cross([0.0, 0.0, 1.0], [x[0], 0.0, x[1]])
>>> print(b.program("example"))
example
t0 = load 0
t1 = load 1
t2 = load 2
t3 = load 3
t4 = * t0 t2
t5 = * t1 t3
t6 = + t4 t5
t7 = < t6 0.0
t8 = sqrt t6
t9 = where t7 0.0 t8
store 4 t9
t10 = * 2.0 t0
store 5 0.0
store 6 t10
store 7 0.0

As the example shows, what is constant is computed at once, what is zero, or multiplied by zero or
one, not at all, and what has a name only once.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import count
from typing import Any, overload

import numpy as np

from drake_screw.typing import Array

_serial = count()


@dataclass(frozen=True, eq=False)
class Node:
    """One operation.

    Attributes:
        operation: its name, as in `lowering`.
        arguments: what it works on.
        number: a constant's value.
        row: of the block, that is loaded or stored.
        serial: counts all nodes in the order in which they were made.
    """

    operation: str
    arguments: tuple[Node, ...] = ()
    number: float | None = None
    row: int | None = None
    serial: int = field(default_factory=_serial.__next__)


class Expression(Node):
    """A number in each lane."""

    def __add__(self, other: Value) -> Expression:
        return _apply("+", self, other)

    def __radd__(self, other: Value) -> Expression:
        return _apply("+", other, self)

    def __sub__(self, other: Value) -> Expression:
        return _apply("-", self, other)

    def __rsub__(self, other: Value) -> Expression:
        return _apply("-", other, self)

    def __mul__(self, other: Value) -> Expression:
        return _apply("*", self, other)

    def __rmul__(self, other: Value) -> Expression:
        return _apply("*", other, self)

    def __truediv__(self, other: Value) -> Expression:
        return _apply("/", self, other)

    def __rtruediv__(self, other: Value) -> Expression:
        return _apply("/", other, self)

    def __neg__(self) -> Expression:
        return _apply("neg", self)

    def __abs__(self) -> Expression:
        return _apply("abs", self)

    def __lt__(self, other: Value) -> Condition:
        return Condition("<", (self, _lifted(other)))

    def __le__(self, other: Value) -> Condition:
        return Condition("<=", (self, _lifted(other)))

    def __gt__(self, other: Value) -> Condition:
        return Condition(">", (self, _lifted(other)))

    def __ge__(self, other: Value) -> Condition:
        return Condition(">=", (self, _lifted(other)))

    def __bool__(self) -> bool:
        raise TypeError("what an expression is worth is known in compiled code only: use where()")


class Condition(Node):
    """Yes or no in each lane; where a number that is compared is NaN, no."""

    def __and__(self, other: Condition) -> Condition:
        return Condition("&", (self, other))

    def __or__(self, other: Condition) -> Condition:
        return Condition("|", (self, other))

    def __invert__(self) -> Condition:
        return Condition("~", (self,))

    def __bool__(self) -> bool:
        raise TypeError("whether a condition holds is known in compiled code only: use where()")


Value = float | Expression

_FOLD: dict[str, Callable[..., float]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "neg": operator.neg,
    "abs": abs,
    "sqrt": math.sqrt,
    "floor": math.floor,
    "ceil": math.ceil,
    "min": min,
    "max": max,
}


def _lifted(value: Any) -> Expression:
    return value if isinstance(value, Expression) else Expression("constant", number=float(value))


def _apply(operation: str, *values: Any) -> Expression:
    """The result of an operation; nothing is left to do where it is a constant or an argument."""
    if any(isinstance(value, np.ndarray) for value in values):
        return NotImplemented
    arguments = tuple(map(_lifted, values))
    numbers = [argument.number for argument in arguments]
    match operation, *numbers:
        case ("+", 0.0, None) | ("*", 1.0, None):
            return arguments[1]
        case ("+" | "-", None, 0.0) | ("*" | "/", None, 1.0):
            return arguments[0]
        case ("*" | "/", 0.0, None) | ("*", None, 0.0):
            return _lifted(0.0)
        case ("-", 0.0, None):
            return -arguments[1]
    if None in numbers:
        return Expression(operation, arguments)
    return _lifted(_FOLD[operation](*numbers))


def _where(condition: Condition, yes: Value, no: Value) -> Expression:
    return Expression("where", (condition, _lifted(yes), _lifted(no)))


def _elementwise(operation: str, arguments: int) -> Any:
    return np.frompyfunc(lambda *values: _apply(operation, *values), arguments, 1)


sqrt = _elementwise("sqrt", 1)
floor = _elementwise("floor", 1)
ceil = _elementwise("ceil", 1)
minimum = _elementwise("min", 2)
maximum = _elementwise("max", 2)
where: Any = np.frompyfunc(_where, 3, 1)
"""where(condition, yes, no). Like the functions above of numbers and of arrays, as numpy's are."""


def varies(values: Any) -> Any:
    """Which values of an array are not constant."""
    return np.frompyfunc(lambda value: _lifted(value).number is None, 1, 1)(values).astype(bool)


@dataclass(frozen=True)
class Program:
    """What a block's rows are to become, one operation after the other."""

    name: str
    nodes: tuple[Node, ...]

    def __str__(self) -> str:
        """A listing, in which programs that do different things differ."""
        names: dict[Node, str] = {}
        lines, unused = [self.name], count()
        for node in self.nodes:
            arguments = [names[argument] for argument in node.arguments]
            match node.operation:
                case "constant":
                    names[node] = repr(node.number)
                case "store":
                    lines.append(f"store {node.row} {arguments[0]}")
                case operation:
                    names[node] = name = f"t{next(unused)}"
                    arguments = arguments if node.row is None else [str(node.row)]
                    lines.append(" ".join([name, "=", operation, *arguments]))
        return "\n".join(lines)


class Block:
    """A block of lanes (see `rows`) whose rows hold expressions: reads and writes are recorded."""

    def __init__(self) -> None:
        self._loads: set[Node] = set()
        self._stores: list[Node] = []

    @overload
    def __getitem__(self, row: int) -> Expression: ...

    @overload
    def __getitem__(self, row: slice) -> Array: ...

    def __getitem__(self, row: int | slice) -> Expression | Array:
        if isinstance(row, slice):
            return np.array([self[k] for k in range(row.start, row.stop)], dtype=object)
        load = Expression("load", row=row)
        self._loads.add(load)
        return load

    def __setitem__(self, row: int | slice, value: Any) -> None:
        if isinstance(row, slice):
            for k, one in zip(range(row.start, row.stop), value, strict=True):
                self[k] = one
        else:
            self._stores.append(Node("store", (_lifted(value),), row=row))

    def program(self, name: str) -> Program:
        """All that was stored, and what it takes to know it, in the order it was written down.

        The compiler keeps to that order by and large, so what is loaded long before it is used
        takes up registers.

        Raises:
            ValueError: an expression was made of rows of another block.
        """
        needed: set[Node] = set()
        pending = list(self._stores)
        while pending:
            node = pending.pop()
            if node not in needed:
                needed.add(node)
                pending += node.arguments
        if any(node.operation == "load" and node not in self._loads for node in needed):
            raise ValueError(f"program {name!r} uses rows of another block")
        return Program(name, tuple(sorted(needed, key=operator.attrgetter("serial"))))
