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


LAST_SECONDS = 5
"""Processor time between the signal that names the limit (SIGXCPU) and SIGKILL, s."""


def limit_process(limits: ProcessLimits) -> None:
    """Limit this process, and those that it starts, unless it is limited more already."""
    _lower(resource.RLIMIT_AS, limits.memory, limits.memory)
    # At the hard limit the system kills without the signal that tells why.
    most = max(1, limits.processor)
    _lower(resource.RLIMIT_CPU, most, most + LAST_SECONDS)
    # What is left of a process that was ended for its size would fill the disk.
    _lower(resource.RLIMIT_CORE, 0, 0)


def _lower(kind: int, soft: int, hard: int) -> None:
    old_soft, old_hard = resource.getrlimit(kind)
    resource.setrlimit(kind, (_lesser(old_soft, soft), _lesser(old_hard, hard)))


def _lesser(one: int, other: int) -> int:
    return other if one == resource.RLIM_INFINITY else min(one, other)
