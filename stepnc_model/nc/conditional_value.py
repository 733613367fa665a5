"""Values that a condition may set, ``IF [#4120 EQ 3] THEN #1=5``, where it is not known.

No jump depends on them. ``#3000=1 (TEXT)`` is an alarm, which ends the program, or nothing.
Variables of the system that move frames and offsets are left to the control.
"""

from math import nan

from stepnc_model.nc.expression import Variables, target_of

ALARM, MESSAGE = 3000, 3006
"""Variables of Fanuc that raise an alarm, and that stop with a message."""

LAST_COMMON = 999
"""Last of the local and common variables of Fanuc."""


def forget_assigned(assignment: str, variables: Variables) -> bool:
    """Forget the variable of an assignment; return whether that is all it may change.

    Parameters
    ----------
    assignment : str
        Such as ``#101=#5041+2``.
    variables : Variables
    """
    name, _, _ = assignment.partition("=")
    target = target_of(name, variables)
    if not isinstance(target, int):
        return False
    if 0 < target <= LAST_COMMON:
        variables.set(target, nan)
        return True
    return target in {ALARM, MESSAGE}
