"""Compiles a function on a block of lanes, as `Emitter` writes it, straight to vector instructions.

numba would compile it as well, but takes most of its time to find out that all variables are
floats. Here every operation on a variable becomes one LLVM instruction on WIDTH lanes at a time.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Callable
from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic

WIDTH = 8
"""Numbers in a vector: those of an AVX-512 register, two of AVX, four of NEON."""

_VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
_FAST = ("contract", "reassoc", "nsz", "arcp")
_ARITHMETIC = {ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul", ast.Div: "fdiv"}
_LOGIC = {ast.BitAnd: "and_", ast.BitOr: "or_"}
_ORDER = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}
_CALLS = {"abs": "fabs", "sqrt": "sqrt", "floor": "floor", "ceil": "ceil"}


def lane_code(function: Callable[[Any], None]) -> Any:
    """Decorator: the function, compiled, for calls from other compiled code.

    It is a function of its own in there, compiled once and not again with every caller, so that its
    rounding does not depend on them. It goes by the name of its arm's module: the names of machine
    code that numba loads from a cache are shared by the whole process, and where two arms used the
    same one, the second would run the code of the first.
    """
    (definition,) = ast.parse(inspect.getsource(function)).body
    assert isinstance(definition, ast.FunctionDef)
    loop = definition.body[-1]
    assert isinstance(loop, ast.For)
    assert isinstance(loop.iter, ast.Call)
    lanes = ast.literal_eval(loop.iter.args[0])

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        attributes = builder.function.attributes
        attributes.add("noinline")
        if isinstance(attributes, set):  # llvmlite's own `add` does not know this one
            set.add(attributes, '"prefer-vector-width"="512"')
        data = context.make_array(signature.args[0])(context, builder, args[0]).data
        with cgutils.for_range(builder, context.get_constant(types.intp, lanes // WIDTH)) as turn:
            first = builder.mul(turn.index, turn.index.type(WIDTH))
            body = _Body(builder, builder.gep(data, [first]))
            for statement in loop.body[1:]:
                body.run(statement)
        return context.get_dummy_value()

    @intrinsic
    def body(typingctx: Any, b: Any) -> Any:
        return types.void(b), codegen

    def compiled(b):  # type: ignore[no-untyped-def]
        body(b)

    compiled.__module__, compiled.__qualname__ = function.__module__, function.__qualname__
    return njit(_nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True)(compiled)


class _Body:
    """The instructions of one turn of the loop."""

    def __init__(self, builder: Any, block: Any) -> None:
        self._builder = builder
        self._block = block
        self._variables: dict[str, Any] = {}

    def run(self, statement: ast.stmt) -> None:
        assert isinstance(statement, ast.Assign)
        (target,) = statement.targets
        value = self._value(statement.value)
        if isinstance(target, ast.Name):
            self._variables[target.id] = value
        else:
            self._builder.store(value, self._row(target), align=8)

    def _row(self, subscript: Any) -> Any:
        """Address of b[i + uintp(offset)]."""
        offset = ast.literal_eval(subscript.slice.right.args[0])
        address = self._builder.gep(self._block, [ir.IntType(64)(offset)])
        return self._builder.bitcast(address, _VECTOR.as_pointer())

    def _value(self, node: ast.expr) -> Any:
        builder = self._builder
        match node:
            case ast.Constant(value=float() as number):
                return _VECTOR([number] * WIDTH)
            case ast.Name(id=name):
                return self._variables[name]
            case ast.Subscript():
                return builder.load(self._row(node), align=8)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _LOGIC:
                return getattr(builder, _LOGIC[type(op)])(self._value(left), self._value(right))
            case ast.BinOp(left=left, op=op, right=right):
                operation = getattr(builder, _ARITHMETIC[type(op)])
                return operation(self._value(left), self._value(right), flags=_FAST)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return builder.fneg(self._value(operand), flags=_FAST)
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return builder.not_(self._value(operand))
            case ast.Compare(left=left, ops=[order], comparators=[right]):
                return self._compare(_ORDER[type(order)], self._value(left), self._value(right))
            case ast.IfExp(test=test, body=yes, orelse=no):
                return builder.select(self._value(test), self._value(yes), self._value(no))
            case ast.Call(func=ast.Name(id="min" | "max" as name), args=[a, b]):
                x, y = self._value(a), self._value(b)
                return builder.select(self._compare("<" if name == "min" else ">", y, x), y, x)
            case ast.Call(func=ast.Name(id=name), args=[a]):
                function = cgutils.get_or_insert_function(
                    builder.module,
                    ir.FunctionType(_VECTOR, [_VECTOR]),
                    f"llvm.{_CALLS[name]}.v{WIDTH}f64",
                )
                return builder.call(function, [self._value(a)])
        raise NotImplementedError(ast.unparse(node))

    def _compare(self, order: str, x: Any, y: Any) -> Any:
        return self._builder.fcmp_ordered(order, x, y)
