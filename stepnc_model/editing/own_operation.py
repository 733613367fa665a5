"""Operations of their own for workingsteps that share one with others.

An operation holds one feed. Where it must stay as it is for one workingstep, the others that
run it get a copy, which can be changed.
"""

from collections.abc import Collection
from typing import Any

from stepnc_model.ap238.view import AimView
from stepnc_model.editing.draft import Draft
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program


def can_be_copied(program: Program) -> bool:
    """True if operations can be copied: one of AP238 has properties that are not read here."""
    return not isinstance(program.file, AimView)


def with_own_operations(program: Program, moved: Collection[int]) -> Program:
    """Give workingsteps copies of their operations; those that shared one share its copy.

    Parameters
    ----------
    program : Program
        Program whose operations can be copied.
    moved : collection of int
        Instances of the workingsteps that get a copy.

    Returns
    -------
    Program
        The program read again from its changed text; the same one if nothing is copied.
    """
    draft = Draft(program)
    copies: dict[int, Ref[Any]] = {}
    for step in program.workingsteps:
        if int(step.ref) not in moved:
            continue
        number = int(step.operation_ref)
        if number not in copies:
            values = program.file.parameters(number)
            copies[number] = draft.add_like(step.operation_ref, values)
        draft.put(step.ref, "its_operation", copies[number])
    if not copies:
        return program
    file = Part21File.from_bytes(draft.edits.apply(), name=program.name)
    return Program(
        file,
        units=program.units,
        name=program.name,
        stock=program.stock,
        bodies=program.bodies,
    )
