"""Sources of the product as the checks of the tree read them."""

from functools import cache

from benchmarks.house import PRODUCT, ROOT, House


@cache
def house() -> House:
    """The product, parsed."""
    return House(ROOT, PRODUCT)


@cache
def modules() -> dict[str, str]:
    """Text of each module of the product by its path, without those of whole packages."""
    return {
        path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8")
        for package in PRODUCT
        for path in sorted((ROOT / package).rglob("*.py"))
        if path.name != "__init__.py"
    }
