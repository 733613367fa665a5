"""Checks of the raw part that a request names: numbers, or an uploaded file."""

from collections.abc import Mapping
from typing import Any

from service.errors import Unreadable
from service.numbers import stock_in
from service.part_file import CHOICE
from service.storage import files
from service.storage.files import FileKind
from service.storage.folder import DataFolder


def require_stock(data_folder: DataFolder, words: Mapping[str, Any]) -> None:
    """Refuse a raw part that a job could not read; names of files are never read.

    Parameters
    ----------
    data_folder : DataFolder
    words : mapping
        Fields of the request.

    Raises
    ------
    StepNcError
        When numbers are invalid, the file does not exist, or both are named.
    """
    if words["stock"] and words["stock_id"] is not None:
        raise Unreadable("name stock or stock_id, not both")
    if words["stock"]:
        stock_in(words["stock"])
    if words["stock_id"] is None:
        if words["stock_solid"]:
            raise Unreadable("stock_solid has no effect without stock_id")
        return
    files.require_file(data_folder, words["stock_id"], FileKind.STOCK)
    if any(each in words["stock_solid"] for each in (CHOICE, "/")):
        raise Unreadable(
            f"stock_solid '{words['stock_solid']}' has {CHOICE} or /: choose the solid by its "
            "place in the file, such as 2"
        )
