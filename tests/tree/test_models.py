"""Every displayed equation has a number, every section its sources, every source is used."""

import re

from tests.docs.pages import DOCS, ROOT

TEXT = (DOCS / "models.md").read_text(encoding="utf-8")
BODY, _, REFERENCES = TEXT.partition("\n## References\n")
WITHOUT_FORMULAS = {"How far to trust it"}


def test_displayed_equations_are_numbered_one_after_another() -> None:
    lines = [line for line in BODY.splitlines() if re.match(r"    \S", line)]
    numbers = [re.search(r"  \((\d+)\)$", line) for line in lines]
    assert [line for line, found in zip(lines, numbers, strict=True) if not found] == []
    assert [int(found[1]) for found in numbers if found] == list(range(1, len(lines) + 1))


def test_every_displayed_equation_names_its_source() -> None:
    source = re.compile(r"  (?:.*\[\d+\].*|worked here|\(\d+\) along a path)  \(\d+\)$")
    lines = [line for line in BODY.splitlines() if re.match(r"    \S", line)]
    assert [line for line in lines if not source.search(line)] == []


def test_every_section_ends_with_its_sources() -> None:
    without = {
        section.splitlines()[0]
        for section in BODY.split("\n## ")[1:]
        if not section.strip().split("\n\n")[-1].startswith("*Sources.* ")
    }
    assert without == WITHOUT_FORMULAS


def test_sources_exist_and_are_all_used() -> None:
    listed = [int(number) for number in re.findall(r"^(\d+)\. ", REFERENCES, flags=re.M)]
    used = {int(number) for number in re.findall(r"\[(\d+)\]", BODY)}
    assert listed == list(range(1, len(listed) + 1))
    assert used == set(listed)


def test_modules_that_the_page_names_exist() -> None:
    names = re.findall(r"`((?:\w+/)+\w+\.py)`", TEXT)
    assert [name for name in names if not (ROOT / name).exists()] == []
