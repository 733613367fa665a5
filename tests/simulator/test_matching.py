"""Which material a STEP-NC program means."""

from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.errors import UnknownMaterial
from simulator.files.toml_file import read_toml
from simulator.library import (
    DATA,
    GuessFile,
    load_material,
    match_material,
    material_names,
    normalised,
)
from simulator.spec import Certainty
from tests.every_case import every_case


@every_case(
    ("texts", "name"),
    [
        (["paper002"], "paper002"),
        (["ST-50"], "st50"),
        (["ST-50", "STEEL"], "st50"),
        (["Stahl", "St50"], "st50"),
        (["FC", "200"], "gg20"),
        (["C45"], "c45"),
        (["c 45"], "c45"),
        (["1.1191"], "c45"),
        (["1.0503"], "c45"),
        (["SAE 1045"], "c45"),
        (["AISI 1045"], "c45"),
        (["Steel C45 (1.1191)"], "c45"),
        (["DIN 1.2344"], "h13"),
        (["AlMg1SiCu"], "al6061"),
        (["EN AW-6061"], "al6061"),
        (["Ti-6Al-4V"], "ti6al4v"),
        (["X5 CrNi 18-10"], "aisi304"),
        (["42CrMo4+QT"], "42crmo4_qt"),
        (["", "  ", "Inconel 718"], "inconel718"),
    ],
)
def test_a_name_of_a_material_finds_it_exactly(texts: list[str], name: str) -> None:
    match = match_material(texts)
    assert (match.material.name, match.certainty) == (name, Certainty.EXACT)


@every_case(
    ("texts", "name"),
    [
        (["SAE 1015", "id"], "aisi1018"),
        (["SAE 1020", "ACO SEM LIGA"], "aisi1018"),
        (["SAE", "1055"], "c60"),
        (["St52-3"], "st50"),
        (["S355J2"], "st50"),
        (["C35"], "c45"),
        (["EN AW-6082"], "al6061"),
        (["Al 2024-T3"], "al2007"),
        (["GGG50"], "ggg40"),
        (["FC", "350"], "gg30"),
        (["STEEL"], "c45"),
        (["P"], "c45"),
        (["AÇO SEM LIGA"], "c45"),
        (["stainless steel"], "aisi304"),
        (["hardened steel"], "hardened_55hrc"),
        (["cast iron"], "gg25"),
        (["Aluminium"], "al6061"),
        (["ALUMINUM"], "al6061"),
        (["Titanlegierung"], "ti6al4v"),
        (["id", "Messing"], "brass"),
    ],
)
def test_a_name_that_is_in_no_file_is_guessed_and_said_to_be(
    texts: list[str], name: str
) -> None:
    match = match_material(texts)
    assert (match.material.name, match.certainty) == (name, Certainty.GUESS)
    assert "guessed" in match.reason


@pytest.mark.parametrize("texts", [["STEEL", "C60"], ["SAE 1020", "steel", "1.0601"]])
def test_an_exact_name_beats_every_guess_before_it(texts: list[str]) -> None:
    assert match_material(texts).material.name == "c60"


def test_the_reason_names_what_was_read_and_what_it_was_taken_for() -> None:
    assert match_material(["ST-50"]).reason == (
        "the material is read as E295 / St50-2: 'ST-50' is one of its names"
    )
    assert match_material(["SAE 1015"]).reason == (
        "the material is guessed to be AISI 1018: 'SAE 1015' is not in the library; the "
        "nearest of the family SAE carbon steel is used"
    )


@every_case("text", ["wood", "crystal", "Nylon 6", "unobtainium", "CARBIDE"])
def test_what_cannot_be_guessed_is_an_error_with_near_names(text: str) -> None:
    with pytest.raises(UnknownMaterial) as caught:
        match_material([text])
    assert caught.value.name == text
    assert set(caught.value.near) <= set(material_names())
    assert caught.value.near


def test_a_slip_of_the_pen_is_answered_with_the_name_meant() -> None:
    with pytest.raises(UnknownMaterial) as caught:
        match_material(["16MnCrr5"])
    assert caught.value.near[0] == "16mncr5"


@every_case(
    ("text", "near"),
    [
        ("titanum", "titanium2"),
        ("titaniun", "titanium2"),
        ("Titanuim alloy", "titanium2"),
        ("stainles steel", None),
        ("aluminim", None),
        ("steell", None),
        ("inconell", "inconel625"),
        ("cooper", "copper"),
    ],
)
def test_a_misspelt_kind_of_metal_is_refused_not_guessed(text: str, near: str | None) -> None:
    with pytest.raises(UnknownMaterial, match=text) as caught:
        match_material([text])
    assert near is None or near in caught.value.near


@every_case("text", ["Titan", "titanio", "Titanlegierung", "steels", "Edelstahl", "aluminio"])
def test_kinds_of_metal_in_other_languages_are_guessed(text: str) -> None:
    assert match_material([text]).certainty is Certainty.GUESS


@pytest.mark.parametrize("texts", [[], [""], ["  ", ""]])
def test_a_program_that_names_no_material_is_an_error_that_lists_all(texts: list[str]) -> None:
    with pytest.raises(UnknownMaterial) as caught:
        match_material(texts)
    assert caught.value.near == material_names()


@every_case("name", material_names())
def test_every_name_of_a_material_leads_to_it_and_to_no_other(name: str) -> None:
    material = load_material(name)
    for text in (name, material.title, *material.title.split(" / "), *material.equivalents):
        match = match_material([text])
        assert (match.material.name, match.certainty) == (name, Certainty.EXACT)


def test_every_guess_names_a_material_of_the_library() -> None:
    guesses = read_toml(DATA / "material_guesses.toml", GuessFile)
    materials = {kind.material for kind in guesses.kind}
    for family in guesses.family:
        materials |= {member.material for member in family.members}
    assert materials <= set(material_names())


@settings(deadline=None, max_examples=50)
@given(st.lists(st.text(max_size=12), max_size=3))
def test_any_texts_give_a_material_or_the_error_and_nothing_else(texts: list[str]) -> None:
    with suppress(UnknownMaterial):
        assert match_material(texts).reason


@given(st.text())
def test_normalising_twice_changes_nothing(text: str) -> None:
    assert normalised(normalised(text)) == normalised(text)
