"""Materials of the library, or one of them."""

from service.programs.machine_choice import load_material_named
from service.progress import Tell, silent
from service.verbs.library import EntryResult, ListingResult
from service.verbs.materials.request import MaterialsFiles, MaterialsRequest
from service.verbs.materials.result import MATERIALS, material_facts
from simulator.library import load_material, material_names


def run(
    _request: MaterialsRequest, files: MaterialsFiles, *, tell: Tell = silent
) -> ListingResult | EntryResult:
    """List the materials, or show one by its name or the path of its file.

    Raises
    ------
    StepNcError
        When there is no such material, or its file is not valid.
    """
    if files.name:
        entry = load_material_named(files.name).material
        return EntryResult(entry=entry, facts=material_facts(entry))
    entries = tuple(load_material(name) for name in material_names())
    return ListingResult(kind="materials", columns=MATERIALS, entries=entries)
