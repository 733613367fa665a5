"""Columns of ``materials``, and what matters of one material."""

from service.rendering.columns import Column
from service.verbs.library import EntryFact
from simulator.spec import WorkMaterial
from stepnc_model.units import m_min_from_speed

MATERIALS: tuple[Column[WorkMaterial], ...] = (
    Column(
        key="name", kind=str, heading="name", value=lambda material: material.name, is_key=True
    ),
    Column(
        key="iso_group",
        kind=str,
        heading="ISO",
        value=lambda material: material.iso_group,
        help="ISO 513 group",
    ),
    Column(
        key="k_c11_n_mm2",
        heading="k_c1.1 N/mm2",
        form="g",
        value=lambda material: material.kienzle.k_c11,
    ),
    Column(key="m_c", heading="m_c", form="g", value=lambda material: material.kienzle.m_c),
    Column(key="title", kind=str, heading="title", value=lambda material: material.title),
)  # fmt: skip


def material_facts(material: WorkMaterial) -> list[EntryFact]:
    """List the data of a material that matter to a planner, as name and value."""
    facts: list[EntryFact] = [
        ("ISO group", material.iso_group or "none"),
        ("also called", ", ".join(material.equivalents)),
        ("k_c1.1 N/mm2", f"{material.kienzle.k_c11:g}"),
        ("m_c", f"{material.kienzle.m_c:g}"),
    ]
    for window in material.windows:
        body = f" {window.tool_body.value}" if window.tool_body else ""
        low = window.min_cutting_speed
        high = window.max_cutting_speed
        shown = " to ".join(f"{m_min_from_speed(each):g}" for each in (low, high) if each)
        facts.append((f"m/min with {window.cutting_material.value}{body}", shown))
    return facts
