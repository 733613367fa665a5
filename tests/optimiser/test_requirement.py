"""The roughness that a program asks for."""

from pathlib import Path

import pytest

from optimiser.bounds.roughness import required_roughness
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program

PARTS = Path(__file__).parents[2] / "examples" / "parts"
FACE = "#50=SURFACE_TEXTURE_PARAMETER(1.6,'Ra','ISO 4287',$,(#51));"


def edited(*changes: tuple[str, str]) -> Program:
    """The bracket with some texts replaced."""
    text = (PARTS / "bracket.stpnc").read_text()
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    return Program(Part21File.from_bytes(text.encode(), name="bracket"), name="bracket")


def asked(program: Program, name: str) -> float | None:
    (step,) = (step for step in program.workingsteps if step.id == name)
    return required_roughness(program, step)


@pytest.fixture(scope="module")
def bracket() -> Program:
    return edited()


@pytest.mark.parametrize(
    ("name", "roughness"),
    [
        ("FINISH FACE", 1.6e-3),
        ("FINISH POCKET", 3.2e-3),
        ("FINISH CONTOUR", 3.2e-3),
        ("REAM HOLE 1", 0.8e-3),
        ("REAM HOLE 2", 0.8e-3),
    ],
)
def test_roughness_is_read_in_micrometres(
    bracket: Program, name: str, roughness: float
) -> None:
    assert asked(bracket, name) == pytest.approx(roughness)


@pytest.mark.parametrize("name", ["MILL STEP", "MILL SLOT", "FINISH OPEN POCKET"])
def test_surface_of_which_nothing_is_asked_has_none(bracket: Program, name: str) -> None:
    assert asked(bracket, name) is None


def test_rz_counts_as_four_times_ra() -> None:
    program = edited((FACE, FACE.replace("(1.6,'Ra'", "(6.3,'Rz'")))
    assert asked(program, "FINISH FACE") == pytest.approx(6.3e-3 / 4.0)


@pytest.mark.parametrize("name", ["ra", " RA ", "Ra", "R"])
def test_name_of_ra_is_read_with_and_without_capitals(name: str) -> None:
    program = edited((FACE, FACE.replace("'Ra'", f"'{name}'")))
    assert asked(program, "FINISH FACE") == pytest.approx(1.6e-3)


@pytest.mark.parametrize("value", ["1.6,'Wt'", "0.,'Ra'", "-1.6,'Ra'"])
def test_other_parameters_and_values_that_are_none_do_not_count(value: str) -> None:
    program = edited((FACE, FACE.replace("1.6,'Ra'", value)))
    assert asked(program, "FINISH FACE") is None


def test_finest_of_several_counts() -> None:
    program = edited((
        "#52=SURFACE_TEXTURE_PARAMETER(3.2,'Ra','ISO 4287',$,(#53,#54));",
        "#52=SURFACE_TEXTURE_PARAMETER(3.2,'Ra','ISO 4287',$,(#53,#54));"
        "#901=SURFACE_TEXTURE_PARAMETER(2.5,'Ra','ISO 4287',$,(#53));",
    ))
    assert asked(program, "FINISH POCKET") == pytest.approx(2.5e-3)
    assert asked(program, "FINISH CONTOUR") == pytest.approx(3.2e-3)


def test_plane_milling_does_not_make_the_side() -> None:
    program = edited(("MACHINED_SURFACE(#100,.BOTTOM.)", "MACHINED_SURFACE(#100,.SIDE.)"))
    assert asked(program, "FINISH FACE") is None


def test_side_milling_does_not_make_the_bottom() -> None:
    program = edited(("MACHINED_SURFACE(#110,.SIDE.)", "MACHINED_SURFACE(#110,.BOTTOM.)"))
    assert asked(program, "FINISH CONTOUR") is None


@pytest.mark.parametrize("element", [".BOTTOM.", ".SIDE.", ".BOTTOM_AND_SIDE."])
def test_bottom_and_side_milling_makes_both(element: str) -> None:
    program = edited((
        "MACHINED_SURFACE(#140,.BOTTOM_AND_SIDE.)",
        f"MACHINED_SURFACE(#140,{element})",
    ))
    assert asked(program, "FINISH POCKET") == pytest.approx(3.2e-3)
