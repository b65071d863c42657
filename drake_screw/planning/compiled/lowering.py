"""Compiles programs on blocks of lanes straight to vector instructions.

Every operation becomes one LLVM instruction on WIDTH lanes. What that buys is a shorter wait when
an arm is first used: numba would compile the same arithmetic written out as a Python function, but
takes most of its time to find out that all variables are floats. Measured for seven joints with
AVX2: 7 s instead of 20 s, the same outcomes, and 178 instead of 174 thousand plans a second of
processor time. With AVX-512 the two have not been compared.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic

from drake_screw.planning.compiled.expressions import Node, Program
from drake_screw.planning.compiled.rows import LANES

WIDTH = 8
"""Numbers in a vector: those of an AVX-512 register, two of AVX, four of NEON."""

_VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
_FAST = ("contract", "reassoc", "nsz", "arcp")
_ARITHMETIC = {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv", "neg": "fneg"}
_LOGIC = {"&": "and_", "|": "or_", "~": "not_", "where": "select"}
_INTRINSICS = {"abs": "fabs", "sqrt": "sqrt", "floor": "floor", "ceil": "ceil"}


def lane_code(program: Program, module: str) -> Any:
    """The program as a function of a block (flat float64), for calls from other compiled code.

    It is a function of its own in there, compiled once and not again with every caller, so that its
    rounding does not depend on them. It goes by the name of its arm's module: the names of machine
    code that numba loads from a cache are shared by the whole process, and where two arms used the
    same one, the second would run the code of the first.
    """

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        attributes = builder.function.attributes
        attributes.add("noinline")
        if isinstance(attributes, set):  # llvmlite's own `add` does not know this one
            set.add(attributes, '"prefer-vector-width"="512"')
        data = context.make_array(signature.args[0])(context, builder, args[0]).data
        with cgutils.for_range(builder, context.get_constant(types.intp, LANES // WIDTH)) as turn:
            lanes = builder.gep(data, [builder.mul(turn.index, turn.index.type(WIDTH))])
            values: dict[Node, Any] = {}
            for node in program.nodes:
                values[node] = _instruction(
                    builder, lanes, node, [values[a] for a in node.arguments]
                )
        return context.get_dummy_value()

    @intrinsic
    def body(typingctx: Any, b: Any) -> Any:
        return types.void(b), codegen

    def compiled(b):  # type: ignore[no-untyped-def]
        body(b)

    compiled.__module__, compiled.__qualname__ = module, program.name
    return njit(_nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True)(compiled)


def _instruction(builder: Any, lanes: Any, node: Node, arguments: list[Any]) -> Any:
    """The value of a node from those of its arguments, in the lanes that begin at an address."""
    match node.operation:
        case "constant":
            return _VECTOR([node.number] * WIDTH)
        case "load":
            return builder.load(_address(builder, lanes, node.row), align=8)
        case "store":
            return builder.store(arguments[0], _address(builder, lanes, node.row), align=8)
        case "+" | "-" | "*" | "/" | "neg" as name:
            return getattr(builder, _ARITHMETIC[name])(*arguments, flags=_FAST)
        case "&" | "|" | "~" | "where" as name:
            return getattr(builder, _LOGIC[name])(*arguments)
        case "<" | "<=" | ">" | ">=" as order:
            return builder.fcmp_ordered(order, *arguments)
        case "min" | "max" as name:
            x, y = arguments
            return builder.select(builder.fcmp_ordered("<" if name == "min" else ">", y, x), y, x)
        case name:
            kind = ir.FunctionType(_VECTOR, [_VECTOR])
            intrinsic_name = f"llvm.{_INTRINSICS[name]}.v{WIDTH}f64"
            function = cgutils.get_or_insert_function(builder.module, kind, intrinsic_name)
            return builder.call(function, arguments)


def _address(builder: Any, lanes: Any, row: Any) -> Any:
    """Where the lanes' numbers of a row are."""
    address = builder.gep(lanes, [ir.IntType(64)(row * LANES)])
    return builder.bitcast(address, _VECTOR.as_pointer())
