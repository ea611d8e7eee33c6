"""Distances of several bones in one vector register.

numba does not vectorise a loop as short as this, so the instructions are generated explicitly.
"""

from __future__ import annotations

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

SIMD_WIDTH = 8
"""Bones in a row: 64 bytes, one cache line, one register of AVX-512 or two of AVX2."""


@intrinsic
def lower(typing_context, distance, u, v, step):
    """Lower row u of a (N, SIMD_WIDTH) float64 array to row v plus a step; tell whether any fell.

    In kernels only: `fell = lower(distance, u, v, step)`.
    """
    signature = types.boolean(distance, types.intp, types.intp, types.float64)
    return signature, _generate


def _generate(context, builder, signature, arguments):
    array, u, v, step = arguments
    row = ir.VectorType(ir.DoubleType(), SIMD_WIDTH)
    data = cgutils.create_struct_proxy(signature.args[0])(context, builder, array).data

    def place(index):
        first = builder.mul(index, ir.Constant(index.type, SIMD_WIDTH))
        return builder.bitcast(builder.gep(data, [first]), row.as_pointer())

    steps = ir.Constant(row, ir.Undefined)
    for lane in range(SIMD_WIDTH):
        steps = builder.insert_element(steps, step, ir.Constant(ir.IntType(32), lane))
    here = builder.load(place(u), align=8)
    there = builder.fadd(builder.load(place(v), align=8), steps)
    less = builder.fcmp_ordered("<", there, here)
    fell = builder.icmp_unsigned(
        "!=", builder.bitcast(less, ir.IntType(SIMD_WIDTH)), ir.Constant(ir.IntType(SIMD_WIDTH), 0)
    )
    builder.store(builder.select(less, there, here), place(u), align=8)
    return fell
