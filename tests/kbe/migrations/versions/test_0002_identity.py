"""The second migration is that of the identity; what it does is in tests/kbe/test_identity."""

import importlib

from kbe.rows import IDENTITY


def test_its_index_is_the_identity() -> None:
    module = importlib.import_module("kbe.migrations.versions.0002_identity")
    assert (module.revision, module.down_revision) == ("0002", "0001")
    assert all(name in module.NO_REPEAT for name in IDENTITY)
