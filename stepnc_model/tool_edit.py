"""Diameter of the milling tool of a program, replaced. Unit mm."""

from stepnc_model.draft import Draft
from stepnc_model.edit_conditions import rounded
from stepnc_model.entities.milling import MillingTypeOperation
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Real
from stepnc_model.program import Program
from stepnc_model.tool import body_of, tool_of


def with_tool_diameter(program: Program, diameter: float) -> Program:
    """Program whose milling tool has another diameter; its other dimensions stay.

    Tools that share the dimensions with it keep theirs.

    Parameters
    ----------
    program : Program
    diameter : float, mm

    Returns
    -------
    Program
        Read again from the changed text, with the same name, units and stock.

    Raises
    ------
    SchemaError
        If the program mills with several tools or none, or the diameter is not possible.
    """
    steps = [
        each
        for each in program.workingsteps
        if isinstance(each.operation, MillingTypeOperation)
    ]
    tools = list(dict.fromkeys(each.tool_ref for each in steps))
    if len(tools) != 1:
        used = ", ".join(f"'{tool_of(program, each).id}'" for each in tools) or "none"
        message = f"a tool diameter needs a program that mills with one tool, not {used}"
        raise program.error(message, program.workingsteps[0].ref)
    tool_of(program, tools[0])
    draft = Draft(program)
    body = draft.own(tools[0], "its_tool_body")
    shape = body_of(program, tools[0])
    if shape is None or shape.dimension is None:
        raise program.error("the tool has no dimension", tools[0])
    body_ref = program.get(tools[0]).its_tool_body  # type: ignore[attr-defined]
    dimension = draft.own(body_ref, "dimension", at=body)
    draft.put(shape.dimension, "diameter", Real(rounded(diameter)), at=dimension)
    file = Part21File.from_bytes(draft.edits.apply(), name=program.name)
    changed = program.changed(file)
    tool_of(changed, tools[0])
    return changed
