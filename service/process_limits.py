"""Limits of memory and processor time of a process that works on files of others.

They are set by the process itself and inherited by those that it starts. The limit of memory is
one of the address space, of which libraries reserve more than they use: some GB are for them.
"""

import resource
from dataclasses import dataclass

GIB = 1 << 30


@dataclass(frozen=True, slots=True, kw_only=True)
class ProcessLimits:
    """Limits of one process."""

    memory: int
    """Greatest size of the address space, bytes."""
    processor: int
    """Longest processor time of all threads together, s."""


def limit_process(limits: ProcessLimits) -> None:
    """Limit this process, and those that it starts, unless it is limited more already."""
    _lower(resource.RLIMIT_AS, limits.memory)
    _lower(resource.RLIMIT_CPU, limits.processor)
    # What is left of a process that was ended for its size would fill the disk.
    _lower(resource.RLIMIT_CORE, 0)


def _lower(kind: int, most: int) -> None:
    _, hard = resource.getrlimit(kind)
    if hard == resource.RLIM_INFINITY or hard > most:
        resource.setrlimit(kind, (most, most))
