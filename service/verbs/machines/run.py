"""Machines of the library, or one of them."""

from service.progress import Tell, silent
from service.verbs.library import EntryResult, ListingResult
from service.verbs.machines.request import MachinesFiles, MachinesRequest
from service.verbs.machines.result import MACHINES, machine_facts
from simulator.library import load_machine, machine_names


def run(
    _request: MachinesRequest, files: MachinesFiles, *, tell: Tell = silent
) -> ListingResult | EntryResult:
    """List the machines, or show one by its name or the path of its file.

    Raises
    ------
    StepNcError
        When there is no such machine, or its file is not valid.
    """
    if files.name:
        entry = load_machine(files.name)
        return EntryResult(entry=entry, facts=machine_facts(entry))
    entries = tuple(load_machine(name) for name in machine_names())
    return ListingResult(kind="machines", columns=MACHINES, entries=entries)
