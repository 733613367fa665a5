"""Packages that only some verbs need, and how to install them.

The core works without them; what needs one says so in one line.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

from stepnc_model.errors import StepNcError

EXTRAS = {
    "OCP": "brep",
    "dask": "cluster",
    "distributed": "cluster",
    "fsspec": "files",
    "matplotlib": "plot",
    "paho": "mqtt",
    "pandas": "notebook",
    "psycopg": "postgres",
    "pyarrow": "parquet",
    "sklearn": "learn",
    "skops": "learn",
}
"""extra of each package, by the name under which it is imported"""

OF_VERBS = {"dataset": "learn", "learn": "learn", "predict": "learn", "score": "learn"}
"""extra that holds all that a verb needs"""

NAMES = {"OCP": "cadquery-ocp-novtk", "sklearn": "scikit-learn", "paho": "paho-mqtt"}
"""names of packages that are installed under another one"""


class MissingExtra(StepNcError):
    """A package of an extra is not installed."""


def has_package(package: str) -> bool:
    """True if a package of an extra is installed."""
    return find_spec(package) is not None


def how_to_install(package: str, *, verb: str = "") -> str:
    """Command that installs the extra of a package, or all that a verb needs.

    >>> how_to_install("pyarrow")
    "pip install 'stepnc-optimiser[parquet]'"
    """
    return f"pip install 'stepnc-optimiser[{OF_VERBS.get(verb, EXTRAS[package])}]'"


@contextmanager
def missing_extras_named(what: str = "this") -> Iterator[None]:
    """Turn the failed import of a package of an extra into an error that helps.

    Raises
    ------
    MissingExtra
    """
    try:
        yield
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package not in EXTRAS:
            raise
        name = NAMES.get(package, package)
        remedy = how_to_install(package, verb=what)
        raise MissingExtra(f"{what} needs the package {name}: {remedy}") from error
