"""Alembic finds its way."""

import importlib
from pathlib import Path

from alembic.config import Config
from alembic.script import ScriptDirectory

from kbe.connection import MIGRATIONS
from kbe.schema import VERSION


def scripts() -> ScriptDirectory:
    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS))
    return ScriptDirectory.from_config(config)


def test_newest_migration_is_the_version_of_the_schema() -> None:
    assert scripts().get_heads() == [VERSION]


def test_migrations_are_numbered_in_order() -> None:
    """A newer schema is known by its greater number."""
    numbers = [script.revision for script in scripts().walk_revisions()][::-1]
    assert numbers == [f"{index + 1:04}" for index in range(len(numbers))]
    assert scripts().get_bases() == ["0001"]


def test_importing_it_migrates_nothing() -> None:
    module = importlib.import_module("kbe.migrations.env")
    assert module.__file__ is not None
    assert Path(module.__file__).parent == MIGRATIONS
