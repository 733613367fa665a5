"""Bounds that a run must not exceed, in words."""

from simulator.spec import Machine


def overload_bounds(machine: Machine) -> str:
    """Bounds of a machine whose excess counts as overload, in words."""
    force, drive = machine.max_cutting_force, "the spindle drive's continuous power"
    return drive if force is None else f"{drive} or the permitted force of {force:.0f} N"
