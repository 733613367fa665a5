"""Examples in docstrings print what they show."""

import doctest
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("stepnc_model", "simulator", "optimiser", "controller", "kbe", "service", "extras")


def with_examples() -> list[str]:
    """Modules of the product that have examples."""
    return sorted(
        ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
        if ">>> " in path.read_text(encoding="utf-8")
    )


def test_examples_of_docstrings_print_what_they_show() -> None:
    """The report of doctest is in the captured output."""
    results = {
        module: doctest.testmod(import_module(module), optionflags=doctest.ELLIPSIS)
        for module in with_examples()
    }
    assert [module for module, result in results.items() if result.attempted == 0] == []
    assert [module for module, result in results.items() if result.failed] == []
    assert len(results) > 50
