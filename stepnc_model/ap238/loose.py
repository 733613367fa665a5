"""Parameters to which nothing refers in ISO 14649, as properties of a workplan in the AIM.

Records of an optimisation are such parameters: interpreters of programs never meet them. In the
AIM every item needs a representation: those of one workingstep get one, by their names.
"""

from collections.abc import Iterable, Mapping

from stepnc_model.ap238.drafting import AimDraft
from stepnc_model.ap238.reading import AimReader
from stepnc_model.ap238.table import loose_rule
from stepnc_model.entities.catalogue import classes
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref

_GROUP = 2
"""Number of colons in a parameter's name before that of its group: its workingstep."""


def loose_numbers(file: Part21File, numbers: Iterable[int]) -> list[int]:
    """Those of some instances that are parameters to which no instance refers."""
    wanted = [
        number
        for number in numbers
        if issubclass(classes().get(file.keyword(number), object), loose_rule().entity)
    ]
    if not wanted:
        return []
    used = {
        int(ref)
        for number in file.ids()
        for _, values in file.parts(number)
        for ref in _references(values)
    }
    return [number for number in wanted if number not in used]


def _references(value: object) -> Iterable[Ref[object]]:
    """All references in a value of ISO 14649."""
    if isinstance(value, Ref):
        return (value,)
    if isinstance(value, tuple):
        return [ref for item in value for ref in _references(item)]
    return ()


def hang(draft: AimDraft, file: Part21File, items: Mapping[int, int], owner: int) -> None:
    """Hang items on a workplan, with one property for each group of names.

    Parameters
    ----------
    draft : AimDraft
    file : Part21File
        Instances of ISO 14649.
    items : mapping of int to int
        AIM item of each parameter, by the number of the parameter.
    owner : int
        AIM instance of the workplan.
    """
    groups: dict[str, list[int]] = {}
    for number, item in items.items():
        name = str(file.parameters(number)[0])
        parts = name.split(":", _GROUP)
        groups.setdefault(parts[-1] if len(parts) > _GROUP else "", []).append(item)
    (name,) = loose_rule().base.conditions[0].texts
    context = draft.shared(("REPRESENTATION_CONTEXT",), {"context_type": "units not necessary"})
    for group, members in groups.items():
        property_ = draft.make(
            ("ACTION_PROPERTY",), {"name": name, "description": group, "definition": Ref(owner)}
        )
        representation = draft.make(
            ("REPRESENTATION",),
            {"items": tuple(map(Ref, members)), "context_of_items": Ref(context)},
        )
        draft.make(
            ("ACTION_PROPERTY_REPRESENTATION",),
            {"property": Ref(property_), "representation": Ref(representation)},
        )


def without(reader: AimReader, draft: AimDraft, gone: set[int]) -> list[int]:
    """Take items out of their properties; return the instances of those left empty.

    Parameters
    ----------
    reader : AimReader
    draft : AimDraft
    gone : set of int
        Items to be removed.
    """
    members: dict[tuple[int, ...], list[int]] = {}
    for place in reader.loose():
        members.setdefault(place.way[:-1], []).append(place.id)
    empty: list[int] = []
    for way, items in members.items():
        if gone.issuperset(items):
            empty += way[:2]
            continue
        for item in gone.intersection(items):
            draft.take(way[-1], "items", item)
    return empty
