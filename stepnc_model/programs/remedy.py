"""Options of the command line that help where a file lacks a datum, or has a wrong one."""

from stepnc_model.entities.catalogue import classes
from stepnc_model.entities.conversion import AttributeSlot, slots_of
from stepnc_model.entities.geometry import ElementarySurface, Plane
from stepnc_model.entities.measures import TolerancedLengthMeasure
from stepnc_model.errors import Finding, SchemaError

_NUMBERED = (TolerancedLengthMeasure, ElementarySurface, Plane)
"""Entities for which a number may be given."""


_STRUCTURE = frozenset({"its_elements", "main_workplan"})
"""Attributes without which a program cannot be read, so that nothing can be set in it."""


def with_remedy(message: str, entity: str, attribute: str) -> str:
    """Message about an attribute with the option that sets it.

    Parameters
    ----------
    message : str
        A message that names an option already is returned unchanged.
    entity : str
        Instance as messages name it, ``#47 DRILLING``.
    attribute : str
        EXPRESS name of the attribute, or empty.

    Returns
    -------
    str

    Examples
    --------
    >>> with_remedy("the operation has no tool", "#47 DRILLING", "its_tool")
    'the operation has no tool; set it with --set "#47.its_tool=#ID"'
    """
    number, _, keyword = entity.partition(" ")
    cls = classes().get(keyword)
    slot = None if cls is None else slots_of(cls).get(attribute)
    if slot is None or attribute in _STRUCTURE or not number.startswith("#"):
        return message
    if " --" in message:
        return message
    return f'{message}; set it with --set "{number}.{attribute}={_example(slot)}"'


def error_of(finding: Finding) -> SchemaError:
    """Error for a finding about an instance, with the option that helps."""
    return SchemaError(
        with_remedy(finding.message, finding.entity, finding.attribute),
        entity=finding.entity,
        attribute=finding.attribute,
        line=finding.line,
    )


def _example(slot: AttributeSlot) -> str:
    """Value of an attribute as it is typed."""
    if slot.items is not None:
        return f"({_example(slot.items)},...)"
    if slot.plain == (str,):
        return "'TEXT'"
    is_number = bool(slot.plain) or slot.enumeration is not None
    if is_number or any(issubclass(each, _NUMBERED) for each in slot.references):
        return "VALUE"
    return "#ID"
