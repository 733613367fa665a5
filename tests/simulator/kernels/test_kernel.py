"""Machine code of a kernel does what its Python does."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from simulator.kernels.kernel import KernelEntry, entry, kernel
from tests.simulator.kernels.conftest import Line, height, heights

LINE = Line(1.5, -2.0)


@pytest.mark.usefixtures("folder")
def test_machine_code_agrees_with_python() -> None:
    x = np.linspace(-3.0, 3.0, 7)
    fast, slow = np.zeros(7), np.zeros(7)
    KernelEntry(heights.function)(LINE, x, 2, fast)
    heights.function(LINE, x, 2, slow)
    assert (fast == slow).all()
    assert fast[0] == 0.0 != fast[-1]


@pytest.mark.usefixtures("folder")
def test_arrays_of_another_layout_have_machine_code_of_their_own() -> None:
    x, into = np.arange(12.0).reshape(6, 2), np.zeros(6)
    each = KernelEntry(heights.function)
    each(LINE, x[:, 1], 0, into)
    assert into.tolist() == [height(LINE, value) for value in x[:, 1]]
    each(LINE, np.ascontiguousarray(x[:, 0]), 0, into)
    assert into.tolist() == [height(LINE, value) for value in x[:, 0]]


@pytest.mark.usefixtures("folder")
def test_bound_arguments_keep_their_place_and_change_their_contents() -> None:
    x, into = np.array([1.0, 2.0]), np.zeros(2)
    run = KernelEntry(heights.function).bound(LINE, x, 0, into)
    run()
    assert into.tolist() == [height(LINE, 1.0), height(LINE, 2.0)]
    x[:] = 3.0, 4.0
    run()
    assert into.tolist() == [height(LINE, 3.0), height(LINE, 4.0)]


@pytest.mark.usefixtures("folder")
def test_bound_arrays_live_as_long_as_the_kernel() -> None:
    into = np.zeros(1000)
    run = KernelEntry(heights.function).bound(LINE, np.full(1000, 5.0), 0, into)
    others = [np.full(1000, value) for value in (1.0, 2.0)]
    run()
    assert (into == height(LINE, 5.0)).all()
    assert len(others) == 2


@pytest.mark.parametrize("value", [True, "x", None, np.int64(1)])
def test_what_a_kernel_does_not_take_is_refused(value: Any) -> None:
    with pytest.raises(TypeError, match="a kernel takes numbers"):
        heights(LINE, np.zeros(1), value, np.zeros(1))


def test_arguments_have_no_names() -> None:
    with pytest.raises(TypeError, match="by position"):
        heights(line=LINE, x=np.zeros(1), first=0, into=np.zeros(1))
    with pytest.raises(TypeError, match="by position"):
        heights.bound(line=LINE, x=np.zeros(1), first=0, into=np.zeros(1))


@pytest.mark.usefixtures("folder")
def test_a_kernel_that_allocates_is_refused() -> None:
    @kernel
    def grown(values: Any) -> Any:
        return np.append(values, 1.0)

    @entry
    def grow(values: Any) -> None:
        values[0] = len(grown(values))

    with pytest.raises(Exception, match=r"NRT required|closure"):
        grow(np.zeros(1))


def test_numba_stays_out_of_a_process_that_finds_its_machine_code(folder: Path) -> None:
    KernelEntry(heights.function)(LINE, np.zeros(2), 0, np.zeros(2))
    assert len(list(folder.glob("heights-*.o"))) == 1
    script = (
        "import sys; from pathlib import Path; from simulator.kernels import store\n"
        f"store.PACKAGE_CACHE = Path({str(folder)!r})\n"
        "import numpy as np; from tests.simulator.kernels.conftest import Line, heights\n"
        "into = np.zeros(2); heights(Line(1.0, 1.0), np.zeros(2), 0, into)\n"
        "assert into.tolist() == [2.0, 2.0] and 'numba' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", script], check=True, cwd=Path(__file__).parents[3])
