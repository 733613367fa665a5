"""A test as root without what root may beyond others, and still with the checkout readable.

Another user would not do: a checkout below a home folder is closed to him, and with it every
module and migration that is read late. Capabilities are a matter of the thread that drops them.
"""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from enum import IntEnum
from os import strerror


class Capability(IntEnum):
    """capabilities(7), by their numbers in ``linux/capability.h``."""

    DAC_OVERRIDE = 1
    """read and write whatever the permissions of a file say"""
    DAC_READ_SEARCH = 2
    """only read"""


class _Header(ctypes.Structure):
    _fields_ = [("version", ctypes.c_uint32), ("pid", ctypes.c_int)]


class _Sets(ctypes.Structure):
    _fields_ = [(name, ctypes.c_uint32) for name in ("effective", "permitted", "inheritable")]


_VERSION_3 = 0x2008_0522
_HEADER = ctypes.byref(_Header(version=_VERSION_3, pid=0))


@contextmanager
def without(*capabilities: Capability) -> Iterator[None]:
    """This thread lacks them within; who is not root lacks them anyway."""
    sets = (_Sets * 2)()
    _call("capget", sets)
    had = sets[0].effective
    sets[0].effective = had & ~sum(1 << capability for capability in capabilities)
    _call("capset", sets)
    try:
        yield
    finally:
        sets[0].effective = had
        _call("capset", sets)


def _call(name: str, sets: "ctypes.Array[_Sets]") -> None:
    """A system call on the capabilities of this thread."""
    libc = ctypes.CDLL(None, use_errno=True)
    if libc[name](_HEADER, sets):
        number = ctypes.get_errno()
        raise OSError(number, f"{name}: {strerror(number)}")
