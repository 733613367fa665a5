"""Conditions of a cut without anything of their own: custom and nominal."""

from optimiser.cuts.conditions import (
    GREATEST_DEFLECTION,
    CuttingConditions,
    PermittedDeflection,
)
from simulator.library import load_machine, load_material
from simulator.spec import CuttingMaterial


def test_what_is_not_said_is_custom_and_nominal() -> None:
    at = CuttingConditions(
        machine=load_machine("vmc15"),
        material=load_material("c45"),
        cutting_material=CuttingMaterial.CARBIDE,
        grade=None,
        roughness=None,
    )
    assert at.deflection == PermittedDeflection(value=GREATEST_DEFLECTION, origin="")
    assert (at.force_factor, at.safety_factor) == (1.0, 1.0)
