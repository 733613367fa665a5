"""Check of the uploaded raw part that a request names."""

from collections.abc import Mapping
from typing import Any

from service.errors import Unreadable
from service.storage import files
from service.storage.files import FileKind
from service.storage.folder import DataFolder


def require_stock(data_folder: DataFolder, words: Mapping[str, Any]) -> None:
    """Refuse a raw part that a job could not read.

    Parameters
    ----------
    data_folder : DataFolder
    words : mapping
        Fields of the request.

    Raises
    ------
    StepNcError
        When the file does not exist, or numbers are given beside it.
    """
    if words["stock"] and words["stock_id"] is not None:
        raise Unreadable("name stock or stock_id, not both")
    if words["stock_id"] is None:
        if words["stock_solid"]:
            raise Unreadable("stock_solid has no effect without stock_id")
        return
    files.require_file(data_folder, words["stock_id"], FileKind.STOCK)
