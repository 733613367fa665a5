"""Compilation of kernels to machine code with numba.

numba generates LLVM intermediate code of a kernel and of all functions that it calls. All
functions but the entry then become private and are optimised again as a whole, which removes
numba's exceptions (kernels never raise any). The result is an object file for this processor.

numba's own optimisation is turned down, as the whole is optimised afterwards: compiling takes a
quarter less time.

Machine code takes one argument, the address of all numbers of a call in order, of eight bytes
each, and returns numba's status. Calling a function of one argument takes a fraction of the
time in which ``ctypes`` converts several dozen. numba's calling convention is inside: two
pointers for the result and an error, then the numbers.
"""

import os
from collections.abc import Callable
from ctypes import CDLL
from types import FunctionType
from typing import Any

os.environ.setdefault("NUMBA_OPT", "1")
import llvmlite.binding as llvm
import numba

from simulator.kernels import link
from simulator.kernels.store import is_kernel, is_reordered, names_of


def object_code(
    function: Callable[..., object], arguments: tuple[object, ...], *, symbol: str
) -> bytes:
    """Compile a kernel for given argument types and return its object file.

    Parameters
    ----------
    arguments : tuple
    symbol : str
        Name of the kernel in the object file.

    Raises
    ------
    TypeError
        If the kernel needs numba at run time, for example because it allocates memory.
    """
    compiled = _compiled(function, {})
    types = tuple(map(numba.typeof, arguments))
    compiled.compile(types)
    name = compiled.overloads[types].fndesc.llvm_func_name
    module = llvm.parse_assembly(compiled.inspect_llvm(types))
    for each in module.functions:
        if not each.is_declaration:
            each.linkage = "internal"
    for each in module.global_variables:
        if not each.is_declaration:
            each.linkage = "internal"
    _add_entry(module, name, symbol)
    machine = link.target_machine()
    passes = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(3))
    passes.getModulePassManager().run(module, passes)
    require_self_contained(module, symbol)
    code: bytes = machine.emit_object(module)
    return code


def _add_entry(module: Any, name: str, symbol: str) -> None:
    """Add a function that calls the kernel with the numbers at an address."""
    kernel = module.get_function(name)
    kernel.name, kernel.linkage = f"{symbol}_kernel", "external"
    _, _, *types = (str(argument.type) for argument in kernel.arguments)
    loads = [
        f"%p{place} = getelementptr i64, ptr %numbers, i64 {place}\n"
        f"%n{place} = load {kind}, ptr %p{place}"
        for place, kind in enumerate(types)
    ]
    given = "".join(f", {kind} %n{place}" for place, kind in enumerate(types))
    declared = "".join(f", {kind}" for kind in types)
    lines = "\n".join(loads)
    caller = llvm.parse_assembly(
        f"declare i32 @{symbol}_kernel(ptr, ptr{declared})\n"
        f"define i32 @{symbol}(ptr %numbers) {{\n"
        "%result = alloca ptr\n%error = alloca ptr\n"
        f"{lines}\n"
        f"%status = call i32 @{symbol}_kernel(ptr %result, ptr %error{given})\n"
        "ret i32 %status\n}"
    )
    caller.triple, caller.data_layout = module.triple, module.data_layout
    module.link_in(caller)
    kernel.linkage = "internal"


def _compiled(function: Any, known: dict[object, Any]) -> Any:
    """Numba compiler of a kernel, in which all kernels it calls are replaced by compilers."""
    if function not in known:
        names = {
            name: _compiled(value, known) if is_kernel(value) else value
            for name, value in names_of(function)
        }
        same = FunctionType(function.__code__, names, function.__name__, function.__defaults__)
        known[function] = numba.njit(
            error_model="numpy",
            fastmath={"reassoc"} if is_reordered(function) else False,
            no_cpython_wrapper=True,
            no_cfunc_wrapper=True,
            _nrt=False,
        )(same)
    return known[function]


def require_self_contained(module: Any, symbol: str) -> None:
    """Raise an error if a kernel calls functions other than those of the C maths library."""
    library = CDLL(None)
    for each in module.functions:
        if not each.is_declaration or each.name.startswith("llvm."):
            continue
        if each.name.startswith(("NRT_", "numba_", "Py")) or not hasattr(library, each.name):
            raise TypeError(f"kernel {symbol} must not call {each.name}")
