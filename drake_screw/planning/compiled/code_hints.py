"""Hints to LLVM about the function that is being compiled."""

from __future__ import annotations

from typing import Any

from numba import types
from numba.extending import intrinsic


@intrinsic
def lane_function(typingctx: Any) -> Any:
    """Compile the calling function on its own, and let its vectors be as wide as the processor's.

    On its own: once, and not again with every function that calls it, so that its rounding does not
    depend on them. Wide: LLVM uses half of AVX-512's width unless told that the code is nothing but
    vector arithmetic.
    """

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        attributes = builder.function.attributes
        attributes.add("noinline")
        if isinstance(attributes, set):  # llvmlite's own `add` does not know this one
            set.add(attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.void(), codegen
