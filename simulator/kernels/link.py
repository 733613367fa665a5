"""Linking of machine code into this process by LLVM, without numba."""

from functools import cache
from typing import Any

import llvmlite.binding as llvm


def address_of(code: bytes, symbol: str) -> int:
    """Load an object file permanently and return the address of one of its functions."""
    engine = _engine()
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return int(engine.get_function_address(symbol))


@cache
def processor() -> tuple[str, str, str]:
    """Platform, name and features of the processor for which machine code is built."""
    features = llvm.get_host_cpu_features()
    return llvm.get_process_triple(), llvm.get_host_cpu_name(), features.flatten()


@cache
def target_machine() -> Any:
    """LLVM target machine for this processor."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    platform, name, features = processor()
    return llvm.Target.from_triple(platform).create_target_machine(
        cpu=name, features=features, opt=3, reloc="static", jit=True
    )


@cache
def _engine() -> Any:
    """LLVM's linker of this process; it keeps loaded code until the process ends."""
    return llvm.create_mcjit_compiler(llvm.parse_assembly(""), target_machine())
