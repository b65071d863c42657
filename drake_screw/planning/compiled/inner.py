"""How the functions are compiled that are only ever called from compiled code."""

from __future__ import annotations

from numba import njit

inner = njit(
    error_model="numpy",
    _nrt=False,
    no_cpython_wrapper=True,
    no_cfunc_wrapper=True,
)
"""Without what Python would need to call them, and without allocating memory."""

inlined = njit(
    error_model="numpy",
    fastmath={"contract"},
    _nrt=False,
    no_cpython_wrapper=True,
    no_cfunc_wrapper=True,
    forceinline=True,
)
"""The same, put in where it is called: a workcell's arrays take long to be passed on. Products and
sums may be fused into one operation, which rounds once instead of twice."""
