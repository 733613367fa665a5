"""Machine code needs nothing but C's mathematics."""

from math import atan2
from typing import Any

import llvmlite.binding as llvm
import numpy as np
import pytest
from numba.core.errors import NumbaError

from simulator.kernels.build import object_code, require_self_contained
from simulator.kernels.kernel import reordered


def test_an_object_file_has_its_kernel_and_calls_mathematics() -> None:
    def turn(values: Any) -> None:
        for row in range(len(values)):
            values[row] = atan2(values[row], 2.0)

    code = object_code(turn, (np.zeros(3),), symbol="turn_1")
    assert code.startswith(b"\x7fELF")
    assert b"turn_1" in code
    assert b"atan2" in code
    assert b"numba" not in code.replace(b"NumbaEnv", b"")
    assert llvm.ObjectFileRef.from_data(code)


def test_sums_in_any_order_are_other_code() -> None:
    def added(values: Any) -> None:
        total = 0.0
        for value in values:
            total += value
        values[0] = total

    in_order = object_code(added, (np.zeros(3),), symbol="added_1")
    assert object_code(added, (np.zeros(3),), symbol="added_1") == in_order
    assert object_code(reordered(added), (np.zeros(3),), symbol="added_1") != in_order


def test_a_kernel_that_needs_numba_is_refused() -> None:
    def twice(values: Any) -> None:
        values[0] = len(np.append(values, values))

    with pytest.raises(NumbaError):
        object_code(twice, (np.zeros(3),), symbol="twice_1")


def test_a_function_of_nobody_is_refused() -> None:
    module = llvm.parse_assembly("declare void @NRT_Free(ptr)\ndeclare double @sin(double)")
    with pytest.raises(TypeError, match="kernel x must not call NRT_Free"):
        require_self_contained(module, "x")
