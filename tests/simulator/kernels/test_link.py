"""Object files run in this process."""

from ctypes import CFUNCTYPE, c_double

import llvmlite.binding as llvm

from simulator.kernels import link

DOUBLE = """
define double @{name}(double %x) {{
  %y = fmul double %x, {factor:.1f}
  ret double %y
}}
"""


def test_objects_are_linked_one_after_another() -> None:
    for factor in (2.0, 3.0):
        name = f"times_{factor:.0f}"
        module = llvm.parse_assembly(DOUBLE.format(name=name, factor=factor))
        code = link.target_machine().emit_object(module)
        times = CFUNCTYPE(c_double, c_double)(link.address_of(code, name))
        assert times(21.0) == 21.0 * factor


def test_the_processor_is_told_by_name_and_features() -> None:
    platform, name, features = link.processor()
    assert platform
    assert name
    assert "+" in features
