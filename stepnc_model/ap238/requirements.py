"""Requirements of a path or the AIM on a written instance: texts, contexts, shapes.

References
----------
.. [1] ISO 10303-238, 5.1 (conditions of the mapping table), 5.2 (AIM EXPRESS).
"""

from stepnc_model.ap238.drafting import AimDraft
from stepnc_model.ap238.table import PathCondition, PathStep
from stepnc_model.part21.values import Enumeration, Ref

SCHEMA = "MODEL_BASED_INTEGRATED_MANUFACTURING_SCHEMA"
"""Schema that new files name."""


class Requirements:
    """Requirements of the new instances of one draft.

    Parameters
    ----------
    draft : AimDraft
    """

    def __init__(self, draft: AimDraft) -> None:
        self._draft = draft

    def describe(self, made: int, owner: int, step: PathStep) -> None:
        """Set what a step says about the instance that it makes."""
        self.set_all(made, owner, step.settings)
        for condition in step.conditions:
            self.fulfil(made, condition)
        self.complete(made)

    def set_all(self, node: int, owner: int, settings: tuple[tuple[str, str], ...]) -> None:
        """Set attributes of an instance, some of them as its owner has them."""
        for name, text in settings:
            path, _, type_ = name.partition(":")
            names = tuple(path.split("."))
            if text == "*":
                described = self._draft.get(owner, "description")
                self._draft.set(node, name, described if isinstance(described, str) else "")
            elif name == "ranking":
                self._draft.set(node, name, int(text))
            else:
                texts = (text,) if text else ()
                self.fulfil(node, PathCondition(attributes=names, type=type_, texts=texts))

    def complete(self, node: int) -> None:
        """Give a new instance the context that its entity requires."""
        draft = self._draft
        if draft.is_a(node, "REPRESENTATION") and draft.get(node, "context_of_items") is None:
            if draft.is_a(node, "SHAPE_REPRESENTATION"):
                self.set_context(node)
            else:
                draft.set(node, "context_of_items", Ref(self._plain_context()))
        if draft.is_a(node, "SHAPE_ASPECT") and draft.get(node, "of_shape") is None:
            if not draft.is_a(node, "INSTANCED_FEATURE"):
                draft.set(node, "of_shape", Ref(self._component_shape()))
            else:
                draft.set(node, "product_definitional", Enumeration("T"))

        if draft.is_a(node, "PRODUCT") and draft.get(node, "frame_of_reference") is None:
            context = draft.shared(
                ("PRODUCT_CONTEXT",),
                {
                    "name": "CNC Machining",
                    "frame_of_reference": Ref(self._application()),
                    "discipline_type": "manufacturing",
                },
            )
            draft.set(node, "frame_of_reference", (Ref(context),))
        if draft.is_a(node, "PRODUCT_DEFINITION"):
            context = draft.shared(
                ("PRODUCT_DEFINITION_CONTEXT",),
                {
                    "name": "CNC Machining",
                    "frame_of_reference": Ref(self._application()),
                    "life_cycle_stage": "manufacturing",
                },
            )
            draft.set(node, "frame_of_reference", Ref(context))

    def _application(self) -> int:
        """Context of the application, with the standard that defines it."""
        context = self._draft.shared(
            ("APPLICATION_CONTEXT",),
            {"application": "Application protocol for the exchange of CNC data"},
        )
        self._draft.shared(
            ("APPLICATION_PROTOCOL_DEFINITION",),
            {
                "status": "international standard",
                "application_interpreted_model_schema_name": SCHEMA.lower(),
                "application_protocol_year": 2020,
                "application": Ref(context),
            },
        )
        return context

    def _plain_context(self) -> int:
        """Context of representations without geometry."""
        return self._draft.shared(
            ("REPRESENTATION_CONTEXT",), {"context_type": "units not necessary"}
        )

    def set_context(self, node: int) -> None:
        """Give a representation the context of geometry in mm and degrees."""
        draft = self._draft
        if not draft.is_new(node) or not draft.is_a(node, "REPRESENTATION"):
            return
        units = tuple(Ref[object](draft.unit(name)) for name in ("mm", "deg"))
        context = draft.shared(
            ("GEOMETRIC_REPRESENTATION_CONTEXT", "GLOBAL_UNIT_ASSIGNED_CONTEXT"),
            {"coordinate_space_dimension": 3, "units": units},
        )
        draft.set(node, "context_of_items", Ref(context))

    def _component_shape(self) -> int:
        """Shape that the components of features are aspects of."""
        draft = self._draft
        definition = draft.shared(
            ("FEATURE_COMPONENT_DEFINITION",), {"name": "feature component"}
        )
        return draft.shared(
            ("PRODUCT_DEFINITION_SHAPE",),
            {"name": "feature component", "definition": Ref(definition)},
        )

    def fulfil(self, node: int, condition: PathCondition) -> None:
        """Make a condition true."""
        *path, last = condition.attributes
        if condition.type:
            path, last = [*path, last], ""
        if not path:
            if condition.texts:
                self._draft.set(node, last, condition.texts[0])
            return
        if not last:
            self._chain(node, path, condition.type)
            return
        if not condition.texts or path == ["items"]:
            return
        if path[0] == "formation":
            for attribute in path:
                present = self._draft.get(node, attribute)
                node = int(present) if isinstance(present, Ref) else node
            self._draft.set(node, last, condition.texts[0])
            return
        type_ = {"kind": "ACTION_RESOURCE_TYPE"}[path[0]]
        made = self._draft.shared((type_,), {last: condition.texts[0]})
        self._draft.put(node, path[0], made)

    def _chain(self, node: int, path: list[str], last: str) -> None:
        """Make a chain of instances, such as the formation and the product of a definition."""
        types = {"formation": "PRODUCT_DEFINITION_FORMATION"}
        for place, attribute in enumerate(path):
            is_last = place == len(path) - 1
            present = self._draft.get(node, attribute)
            if isinstance(present, Ref):
                node = int(present)
                continue
            made = self._draft.make((last if is_last else types[attribute],), {})
            self.complete(made)
            self._draft.put(node, attribute, made)
            node = made
