"""Eight float64 lanes as one value: the node record in a register.

A node's momentum (3), mass, force (3) and a spare lane fill one 64-byte line. With an opaque
Numba type over an LLVM vector, adding a particle's contribution to a node is one load, one
fused multiply-add and one store of that line; LLVM lowers it to AVX-512, AVX2 or NEON.

Only this module knows LLVM. Everything else calls the functions below.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from llvmlite import ir
from numba import extending, types
from numba.extending import models, register_model

LANES = 8
# Numba supplies the typing context itself; to a type checker the functions take what follows it.
intrinsic: Callable[..., Any] = extending.intrinsic

FLAGS = ("contract", "nsz")  # NaN and inf are kept, and the order of operations: it is chosen below


class Lanes(types.Type):
    """Numba's view of eight float64 lanes."""

    def __init__(self) -> None:
        super().__init__(name="Lanes8")


lanes = Lanes()
_VECTOR = ir.VectorType(ir.DoubleType(), LANES)
_MASK = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)


@register_model(Lanes)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, fe_type: Any) -> None:
        super().__init__(manager, fe_type, _VECTOR)


def _shuffle(builder: Any, first: Any, second: Any, lanes_taken: Sequence[int]) -> Any:
    """Lanes of two vectors of one length, numbered through, in a new order."""
    mask = ir.Constant(ir.VectorType(ir.IntType(32), len(lanes_taken)), list(lanes_taken))
    return builder.shuffle_vector(first, second, mask)


def _splat(builder: Any, scalar: Any) -> Any:
    first = builder.insert_element(ir.Constant(_VECTOR, ir.Undefined), scalar, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(first, ir.Constant(_VECTOR, ir.Undefined), _MASK)


def _address(context: Any, builder: Any, array_type: Any, array: Any, index: Any) -> Any:
    data = context.make_array(array_type)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [index]), _VECTOR.as_pointer())


@intrinsic
def load(typingctx: Any, array: Any, index: Any) -> Any:
    """Read lanes ``array[index : index + 8]`` of a flat float64 array."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        value = builder.load(_address(context, builder, signature.args[0], args[0], args[1]))
        value.align = 8
        return value

    return lanes(array, types.intp), generate


@intrinsic
def store(typingctx: Any, array: Any, index: Any, value: Any) -> Any:
    """Write lanes to ``array[index : index + 8]`` of a flat float64 array."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        done = builder.store(args[2], _address(context, builder, signature.args[0], args[0], args[1]))
        done.align = 8
        return context.get_dummy_value()

    return types.none(array, types.intp, lanes), generate


@intrinsic
def pack(typingctx: Any, a0: Any, a1: Any, a2: Any, a3: Any, a4: Any, a5: Any, a6: Any, a7: Any) -> Any:
    """Eight scalars as lanes."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        value = ir.Constant(_VECTOR, ir.Undefined)
        for k, scalar in enumerate(args):
            value = builder.insert_element(value, scalar, ir.Constant(ir.IntType(32), k))
        return value

    return lanes(*[types.float64] * LANES), generate


@intrinsic
def scale(typingctx: Any, scalar: Any, value: Any) -> Any:
    """``scalar * value`` in every lane."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.fmul(_splat(builder, args[0]), args[1], flags=FLAGS)

    return lanes(types.float64, lanes), generate


@intrinsic
def splat(typingctx: Any, scalar: Any) -> Any:
    """One scalar in every lane."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _splat(builder, args[0])

    return lanes(types.float64), generate


@intrinsic
def fma(typingctx: Any, scalar: Any, value: Any, total: Any) -> Any:
    """``total + scalar * value`` in every lane."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        product = builder.fmul(_splat(builder, args[0]), args[1], flags=FLAGS)
        return builder.fadd(args[2], product, flags=FLAGS)

    return lanes(types.float64, lanes, lanes), generate


@intrinsic
def plus(typingctx: Any, a: Any, b: Any) -> Any:
    """``a + b``, lane by lane."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.fadd(args[0], args[1], flags=FLAGS)

    return lanes(lanes, lanes), generate


@intrinsic
def minus(typingctx: Any, a: Any, b: Any) -> Any:
    """``a - b``, lane by lane."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.fsub(args[0], args[1], flags=FLAGS)

    return lanes(lanes, lanes), generate


@intrinsic
def times(typingctx: Any, a: Any, b: Any) -> Any:
    """``a * b``, lane by lane."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.fmul(args[0], args[1], flags=FLAGS)

    return lanes(lanes, lanes), generate


@intrinsic
def lower(typingctx: Any, a: Any, b: Any) -> Any:
    """The smaller of ``a`` and ``b``, lane by lane; where one is no number it is ``b``."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.select(builder.fcmp_ordered("<", args[0], args[1]), args[0], args[1])

    return lanes(lanes, lanes), generate


@intrinsic
def with_momentum(typingctx: Any, momentum: Any, record: Any) -> Any:
    """Lanes 0 to 2 of the first, the others of the second."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _shuffle(builder, args[0], args[1], [0, 1, 2, *range(LANES + 3, 2 * LANES)])

    return lanes(lanes, lanes), generate


def _reordered(order: Sequence[int]) -> Callable[..., Any]:
    """Make an intrinsic that puts lanes in a fixed order."""

    @intrinsic
    def reorder(typingctx: Any, value: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            return _shuffle(builder, args[0], args[0], order)

        return lanes(lanes), generate

    return reorder


# With a lane for each corner of a hexahedron in VTK's order: every corner gets the value of its
# neighbour along one edge.
across_x = _reordered([1, 0, 3, 2, 5, 4, 7, 6])
across_y = _reordered([3, 2, 1, 0, 7, 6, 5, 4])
across_z = _reordered([4, 5, 6, 7, 0, 1, 2, 3])


def _store_rows(context: Any, builder: Any, array_type: Any, args: Any) -> Any:
    """Write columns (lanes) side by side as rows to ``array[index:]``."""
    array, index, *columns = args
    # Vectors are joined two by two: the last of an odd number goes with itself, and is taken once.
    while len(columns) > 1:
        pairs = zip(columns[::2], [*columns[1::2], columns[-1]], strict=False)
        columns = [_shuffle(builder, a, b, range(2 * a.type.count)) for a, b in pairs]
    width, joined = len(args) - 2, columns[0]
    rows = _shuffle(
        builder, joined, joined, [LANES * part + k for k in range(LANES) for part in range(width)]
    )
    data = context.make_array(array_type)(context, builder, array).data
    place = builder.bitcast(builder.gep(data, [index]), rows.type.as_pointer())
    builder.store(rows, place).align = 8
    return context.get_dummy_value()


@intrinsic
def store_triples(typingctx: Any, array: Any, index: Any, a: Any, b: Any, c: Any) -> Any:
    """Write three lanes side by side as eight rows (a_k, b_k, c_k) to ``array[index : index + 24]``."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _store_rows(context, builder, signature.args[0], args)

    return types.none(array, types.intp, lanes, lanes, lanes), generate


@intrinsic
def store_quadruples(typingctx: Any, array: Any, index: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    """Write four lanes side by side as eight rows (a_k, b_k, c_k, d_k) to ``array[index : index + 32]``."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return _store_rows(context, builder, signature.args[0], args)

    return types.none(array, types.intp, lanes, lanes, lanes, lanes), generate


@intrinsic
def lane(typingctx: Any, value: Any, index: Any) -> Any:
    """Lane ``index`` as a scalar."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.extract_element(args[0], builder.trunc(args[1], ir.IntType(32)))

    return types.float64(lanes, types.intp), generate


@intrinsic
def zero(typingctx: Any) -> Any:
    """Eight zeros."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return ir.Constant(_VECTOR, [0.0] * LANES)

    return lanes(), generate


def lines(raw: np.ndarray, *shape: int) -> np.ndarray:
    """Return an array of that shape in ``raw``, float64, that begins where a 64-byte line does."""
    shift = (-(raw.ctypes.data // 8)) % LANES
    return raw[shift : shift + math.prod(shape)].reshape(shape)


def records(count: int) -> np.ndarray:
    """Return ``count`` zeroed records, shape (count, 8), each on a 64-byte line of its own."""
    return lines(np.zeros(count * LANES + LANES - 1), count, LANES)
