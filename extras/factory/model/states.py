"""States of a machine in a shop, and which may follow which.

The six states of [1]_, Fig. 4, form a cycle: idling, batch set-up, part set-up, machining, part
ejection, then the next part or batch ejection, and idling again. Beside them stand the states
in which a machine waits, is down, maintained or switched off.

References
----------
.. [1] Lechevalier, Shin, Rachuri, Foufou, Lee, Bouras (2018), "Simulating a virtual machining
   model in an agent-based model for advanced analytics", section 4.1.
"""

from enum import StrEnum


class MachineState(StrEnum):
    """State of a machine in a shop."""

    IDLING = "idling"
    """Between two batches, and before the first."""
    BATCH_SETUP = "batch set-up"
    PART_SETUP = "part set-up"
    MACHINING = "machining"
    PART_EJECTION = "part ejection"
    BATCH_EJECTION = "batch ejection"
    STARVED = "starved"
    """Waiting for a batch."""
    BLOCKED = "blocked"
    """Waiting for room in the buffer behind, with the batch on the machine."""
    WAITING = "waiting for crew"
    FAILED = "failed"
    """Down, waiting for a repair crew."""
    REPAIR = "repair"
    MAINTENANCE = "maintenance"
    OFF = "off shift"


_S = MachineState

HANDLING = (_S.BATCH_SETUP, _S.PART_SETUP, _S.PART_EJECTION, _S.BATCH_EJECTION)
"""States whose times and powers a machine file gives."""

_CAN_FAIL = frozenset({*HANDLING, _S.MACHINING, _S.IDLING, _S.STARVED, _S.BLOCKED, _S.WAITING})

_FOLLOWING = {
    _S.IDLING: {_S.STARVED, _S.BATCH_SETUP, _S.WAITING, _S.MAINTENANCE, _S.OFF},
    _S.STARVED: {_S.BATCH_SETUP, _S.WAITING, _S.MAINTENANCE, _S.OFF},
    _S.BATCH_SETUP: {_S.PART_SETUP, _S.WAITING},
    _S.PART_SETUP: {_S.MACHINING, _S.WAITING},
    _S.MACHINING: {_S.PART_EJECTION, _S.WAITING},
    _S.PART_EJECTION: {
        _S.PART_SETUP, _S.BATCH_EJECTION, _S.WAITING, _S.MAINTENANCE, _S.OFF,
    },
    _S.BATCH_EJECTION: {_S.IDLING, _S.BLOCKED},
    _S.BLOCKED: {_S.IDLING},
    _S.WAITING: {*HANDLING, _S.MACHINING, _S.MAINTENANCE},
    _S.MAINTENANCE: {
        _S.STARVED, _S.BATCH_SETUP, _S.PART_SETUP, _S.WAITING, _S.MAINTENANCE, _S.OFF,
    },
    _S.OFF: {_S.STARVED, _S.BATCH_SETUP, _S.PART_SETUP, _S.WAITING, _S.MAINTENANCE},
    _S.FAILED: {_S.REPAIR},
    _S.REPAIR: _CAN_FAIL,
}  # fmt: skip

TRANSITIONS: dict[MachineState, frozenset[MachineState]] = {
    before: frozenset(after | ({_S.FAILED} if before in _CAN_FAIL else set()))
    for before, after in _FOLLOWING.items()
}
"""States that may follow each state. After a repair a machine returns to the state in which it
failed; a machine that waits for a crew goes on with the state that needs it."""
