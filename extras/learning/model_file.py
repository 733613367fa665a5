"""Files of learned models: skops, never pickle, with a header that is read first.

The file is what skops writes, a ZIP archive of JSON and arrays, with one more member: the
header in JSON. It has target, columns, trained box, baselines, residuals and the version of
scikit-learn, which has to be the one that is installed, for other versions may compute
otherwise. A power law is in the header alone. Only the classes of ``ALLOWED``, beside those
that skops itself trusts, are ever made from a file.
"""

import json
import warnings
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

import sklearn
import skops.io

from extras.learning.models import Baseline, LearnedModel, ModelKind, PowerLaw
from extras.learning.table import PHYSICS, Features
from service.files import read_bytes, write_atomically
from service.rendering.columns import dump
from stepnc_model.errors import StepNcError
from stepnc_model.zip_member import DAMAGES, read_member, require_sizes

HEADER = "stepnc.json"
FORMAT = "stepnc-model-2"

MOST_BYTES = 1 << 30
"""Bytes of a model once it is unpacked."""

FREE_BYTES, BYTES_PER_BYTE = 1 << 27, 64
"""Bytes to which a file of any size may unpack, and further ones for each byte of the file."""

MOST_OF_HEADER = 1 << 25
"""Bytes of the header once it is unpacked."""

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
    predictor = None if model.kind is ModelKind.POWER_LAW else model.predictor
    buffer = BytesIO(skops.io.dumps(predictor, compression=ZIP_DEFLATED))
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
    data = read_bytes(path, most=MOST_BYTES)
    header = _read_header(data, path)
    version = header["scikit_learn"]
    if version != sklearn.__version__:
        raise StepNcError(
            f"{path}: made with scikit-learn {version}, but {sklearn.__version__} is "
            "installed: train it again"
        )
    features = Features(
        numbers=tuple(header["numbers"]),
        names={name: tuple(values) for name, values in header["names"].items()},
    )
    kind, law = ModelKind(header["kind"]), _law(header["law"], features)
    is_law = kind is ModelKind.POWER_LAW
    return LearnedModel(
        kind=kind,
        target=header["target"],
        features=features,
        physics=header["physics"],
        low=header["low"],
        high=header["high"],
        rows=header["rows"],
        predictor=_law(header["predictor"], features) if is_law else _predictor(data, path),
        baseline=Baseline(mean=header["mean"], law=law),
        residuals=tuple(header["residuals"]),
        manifest=header["manifest"],
    )


def _header(model: LearnedModel) -> dict[str, object]:
    return {
        "format": FORMAT,
        "scikit_learn": sklearn.__version__,
        "kind": model.kind.value,
        "target": model.target,
        "physics": model.physics,
        "numbers": model.features.numbers,
        "names": dict(model.features.names),
        "low": dict(model.low),
        "high": dict(model.high),
        "rows": model.rows,
        "mean": model.baseline.mean,
        "law": _law_values(model.baseline.law),
        "predictor": (
            _law_values(model.predictor) if isinstance(model.predictor, PowerLaw) else []
        ),
        "residuals": list(model.residuals),
        "manifest": model.manifest,
    }


def _law_values(law: PowerLaw) -> list[float]:
    """Constant and coefficients of a power law."""
    return [law.constant, *law.coefficients]


def _law(values: list[float], features: Features) -> PowerLaw:
    return PowerLaw(features=features, constant=values[0], coefficients=tuple(values[1:]))


def _read_header(data: bytes, path: Path) -> dict[str, Any]:
    """Header of a model file, with all its keys."""
    try:
        with ZipFile(BytesIO(data)) as archive:
            size = sum(each.file_size for each in archive.infolist())
            most = min(MOST_BYTES, FREE_BYTES + BYTES_PER_BYTE * len(data))
            if size > most:
                raise StepNcError(
                    f"{path}: unpacks to {size} bytes; at most {most} are accepted of a file "
                    f"of {len(data)} bytes"
                )
            member = archive.getinfo(HEADER)
            header = json.loads(read_member(archive, member, most=MOST_OF_HEADER))
            # skops reads members as a whole, also those of which the directory lies.
            require_sizes(archive, most=most)
    except KeyError as error:
        raise StepNcError(f"{path}: is no model of `stepnc learn`") from error
    except DAMAGES as error:
        raise StepNcError(f"{path}: is no model of `stepnc learn`: {error}") from error
    kinds = {"scikit_learn": str, "kind": str, "target": str, "physics": str, "numbers": list,
             "names": dict, "low": dict, "high": dict, "rows": int, "mean": float, "law": list,
             "predictor": list, "residuals": list, "manifest": str}  # fmt: skip
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise StepNcError(f"{path}: is no model of this version: train it again")
    for key, kind in kinds.items():
        if not isinstance(header.get(key), kind):
            raise StepNcError(f"{path}: header: {key}: missing or damaged")
    if header["kind"] not in list(ModelKind):
        raise StepNcError(f"{path}: header: kind: unknown model")
    if header["physics"] not in {"", *PHYSICS.values()}:
        raise StepNcError(f"{path}: header: physics: unknown column")
    _require_numbers(header, path)
    return header


def _require_numbers(header: Mapping[str, Any], path: Path) -> None:
    """Refuse a header whose numbers are not those of its columns.

    Raises
    ------
    StepNcError
        With the first key that is damaged.
    """
    numbers, names = header["numbers"], header["names"]
    if not all(isinstance(each, list) for each in names.values()):
        raise StepNcError(f"{path}: header: names: missing or damaged")
    columns = 1 + len(numbers) + sum(len(each) - 1 for each in names.values())
    found = {
        "law": (header["law"], columns),
        "low": ([header["low"].get(name) for name in numbers], len(numbers)),
        "high": ([header["high"].get(name) for name in numbers], len(numbers)),
        "residuals": (header["residuals"], max(2, len(header["residuals"]))),
    }
    if header["kind"] == ModelKind.POWER_LAW:
        found["predictor"] = (header["predictor"], columns)
    for key, (values, count) in found.items():
        if len(values) != count or not all(isinstance(each, float) for each in values):
            raise StepNcError(f"{path}: header: {key}: missing or damaged")


def _built(data: bytes) -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return skops.io.loads(data, trusted=sorted(ALLOWED))


def _require_intact(data: bytes, path: Path) -> None:
    """Refuse an archive of which a member does not have the check sum that it should have."""
    try:
        with ZipFile(BytesIO(data)) as archive:
            bad = archive.testzip()
    except DAMAGES as error:
        raise StepNcError(f"{path}: is damaged: {error}") from error
    if bad is not None:
        raise StepNcError(f"{path}: is damaged: {bad} has a wrong check sum")


def _predictor(data: bytes, path: Path) -> Any:
    """The pipeline, of allowed classes only."""
    _require_intact(data, path)
    try:
        unknown = sorted(set(skops.io.get_untrusted_types(data=data)) - ALLOWED)
        model = None if unknown else _built(data)
    except Exception as error:
        # skops, scikit-learn and numpy build objects from the file and fail in many ways; no
        # code of this project runs in between.
        raise StepNcError(f"{path}: is damaged: {type(error).__name__}") from error
    if unknown:
        raise StepNcError(f"{path}: has {', '.join(unknown)}, outside the allow-list of models")
    if not hasattr(model, "predict"):
        raise StepNcError(f"{path}: is no model of `stepnc learn`")
    return model
