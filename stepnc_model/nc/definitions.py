"""Variables that a Sinumerik program defines: ``DEF REAL DEPTH=-2, SAFE=5``.

A definition steers nothing. Numbers are known from there; texts, axes, frames and fields are
not, and what depends on them stays open.
"""

import re

from stepnc_model.nc.parameters import Parameters

DEFINITION = re.compile(r"DEF\s+(?:CHAN\s+|NCK\s+)?([A-Z]+)(?:\[[^\]]*\])?\s+(.+)", re.I | re.S)
VARIABLE = re.compile(r"([A-Z_][A-Z0-9_]*)\s*(?:=\s*(.+))?", re.I | re.S)
SEPARATOR = re.compile(r",(?![^(\[]*[)\]])")

NUMBERS = {"REAL", "INT", "BOOL"}
"""Types of numbers."""


def take_definition(text: str, parameters: Parameters, *, is_sure: bool) -> bool:
    """Define variables; return whether a statement is a definition.

    Parameters
    ----------
    text : str
    parameters : Parameters
    is_sure : bool
        Whether the block is executed in any case; else the values are not known.

    Examples
    --------
    >>> from stepnc_model.nc.parameters import SINUMERIK
    >>> parameters = Parameters(SINUMERIK)
    >>> take_definition("DEF REAL DEPTH=-2, SAFE=5", parameters, is_sure=True)
    True
    >>> parameters.evaluate("SAFE-DEPTH")
    7.0
    """
    found = DEFINITION.fullmatch(text.strip())
    if found is None:
        return False
    for each in SEPARATOR.split(found[2]):
        variable = VARIABLE.fullmatch(each.strip())
        if variable is None or found[1].upper() not in NUMBERS:
            continue
        value = parameters.evaluate(variable[2]) if variable[2] else 0.0
        parameters.declare(variable[1], value if is_sure else float("nan"))
    return True
