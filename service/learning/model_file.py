"""Files of learned models: skops, never pickle, with a header that is read first.

The file is what skops writes, a ZIP archive of JSON and arrays, with one more member: the
header in JSON. It names target, columns, trained box and the version of scikit-learn, which has
to be the one that is installed, for other versions may compute otherwise. Only the classes of
``ALLOWED``, beside those that skops itself trusts, are ever made from a file.
"""

import json
import warnings
from io import BytesIO
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, BadZipFile, ZipFile

import sklearn
import skops.io

from service.files import read_bytes, write_atomically
from service.learning.learned import LearnedModel
from service.learning.models import ModelKind
from service.learning.table import Features
from service.rendering.records import dump
from stepnc_model.errors import StepNcError

HEADER = "stepnc.json"
FORMAT = "stepnc-model-1"

MOST_BYTES = 1 << 30
"""Bytes of a model once it is unpacked."""

ALLOWED = frozenset({
    "sklearn.gaussian_process.kernels.ConstantKernel",
    "sklearn.gaussian_process.kernels.Product",
    "sklearn.gaussian_process.kernels.RBF",
    "sklearn.gaussian_process.kernels.Sum",
    "sklearn.gaussian_process.kernels.WhiteKernel",
    "sklearn.tree._tree.Tree",
})
"""Classes and functions of the models of this project that skops does not trust by itself."""


def save_model(model: LearnedModel, path: Path) -> None:
    """Write a model, whole or not at all.

    Raises
    ------
    WriteError
        When the disk refuses.
    """
    buffer = BytesIO(skops.io.dumps(model.predictor, compression=ZIP_DEFLATED))
    with ZipFile(buffer, "a", ZIP_DEFLATED) as archive:
        archive.writestr(HEADER, dump(_header(model)))
    write_atomically(path, buffer.getvalue())


def load_model(path: Path) -> LearnedModel:
    """Read a model.

    Raises
    ------
    StepNcError
        When the file is no model, is of another version of scikit-learn, or has a class outside
        the allow-list.
    """
    data = read_bytes(path)
    header = _read_header(data, path)
    version = header["scikit_learn"]
    if version != sklearn.__version__:
        raise StepNcError(
            f"{path}: made with scikit-learn {version}, but {sklearn.__version__} is "
            "installed: train it again"
        )
    return LearnedModel(
        kind=ModelKind(header["kind"]),
        target=header["target"],
        features=Features(
            numbers=tuple(header["numbers"]),
            names={name: tuple(values) for name, values in header["names"].items()},
        ),
        low=header["low"],
        high=header["high"],
        rows=header["rows"],
        predictor=_predictor(data, path),
    )


def _header(model: LearnedModel) -> dict[str, object]:
    return {
        "format": FORMAT,
        "scikit_learn": sklearn.__version__,
        "kind": model.kind.value,
        "target": model.target,
        "numbers": model.features.numbers,
        "names": dict(model.features.names),
        "low": dict(model.low),
        "high": dict(model.high),
        "rows": model.rows,
    }


def _read_header(data: bytes, path: Path) -> dict[str, Any]:
    """Header of a model file, with all its keys."""
    try:
        with ZipFile(BytesIO(data)) as archive:
            size = sum(each.file_size for each in archive.infolist())
            if size > MOST_BYTES:
                raise StepNcError(f"{path}: {size} bytes exceed {MOST_BYTES} bytes, the most")
            header = json.loads(archive.read(HEADER))
    except (BadZipFile, KeyError, ValueError, NotImplementedError) as error:
        raise StepNcError(f"{path}: is no model of `stepnc learn`") from error
    kinds = {"scikit_learn": str, "kind": str, "target": str, "numbers": list, "names": dict,
             "low": dict, "high": dict, "rows": int}  # fmt: skip
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise StepNcError(f"{path}: is no model of this version: train it again")
    for key, kind in kinds.items():
        if not isinstance(header.get(key), kind):
            raise StepNcError(f"{path}: header: {key}: missing or damaged")
    if header["kind"] not in list(ModelKind):
        raise StepNcError(f"{path}: header: kind: unknown model")
    for key in ("low", "high"):
        if any(not isinstance(header[key].get(name), float) for name in header["numbers"]):
            raise StepNcError(f"{path}: header: {key}: missing or damaged")
    return header


def _predictor(data: bytes, path: Path) -> Any:
    """The pipeline, of allowed classes only."""
    try:
        unknown = sorted(set(skops.io.get_untrusted_types(data=data)) - ALLOWED)
        if unknown:
            raise StepNcError(
                f"{path}: has {', '.join(unknown)}, outside the allow-list of models"
            )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model = skops.io.loads(data, trusted=sorted(ALLOWED))
    except (KeyError, TypeError, ValueError, AttributeError, ImportError, BadZipFile) as error:
        raise StepNcError(f"{path}: is damaged: {type(error).__name__}") from error
    if not hasattr(model, "predict"):
        raise StepNcError(f"{path}: is no model of `stepnc learn`")
    return model
