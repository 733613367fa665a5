"""Model files: the same predictions after reading; nothing but allowed classes is made."""

import json
from io import BytesIO
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest
import skops.io
from sklearn.linear_model import Ridge
from sklearn.preprocessing import FunctionTransformer

import stepnc
from extras.learning.model_file import HEADER, load_model, save_model
from extras.learning.models import LearnedModel, ModelKind
from stepnc_model.errors import StepNcError
from tests.every_case import every_case
from tests.extras.learning.tables import law_table, written


def learned(folder: Path, model: str = "power-law") -> LearnedModel:
    path = written(folder, law_table(60, machines=("a", "b")))
    return stepnc.learn(path, model=model, train=40, test=20).model


def with_header(data: bytes, values: dict[str, object]) -> bytes:
    """A model file with another header."""
    target = BytesIO()
    with ZipFile(BytesIO(data)) as source, ZipFile(target, "w") as archive:
        for name in source.namelist():
            content = source.read(name)
            if name == HEADER:
                content = json.dumps({**json.loads(content), **values}).encode()
            archive.writestr(name, content)
    return target.getvalue()


@pytest.mark.parametrize("kind", list(ModelKind))
def test_a_model_predicts_the_same_after_reading(tmp_path: Path, kind: ModelKind) -> None:
    model, path = learned(tmp_path, kind.value), tmp_path / "model.skops"
    save_model(model, path)
    found = load_model(path)
    assert (found.kind, found.target, found.features) == (kind, model.target, model.features)
    assert (found.low, found.high, found.rows) == (model.low, model.high, 40)
    assert (found.baseline, found.residuals) == (model.baseline, model.residuals)
    values = np.array([[50.0, 100.0, 3.0, 0.0], [60.0, 200.0, 3.0, 1.0]])
    assert found.predictor.predict(values) == pytest.approx(model.predictor.predict(values))


@every_case(
    ("values", "message"),
    [
        ({"scikit_learn": "0.1"}, r"made with scikit-learn 0\.1, but .* is installed"),
        ({"format": "other"}, "no model of this version"),
        ({"kind": "oracle"}, "header: kind"),
        ({"low": {}}, "header: low: missing"),
        ({"target": 3}, "header: target: missing"),
        ({"law": [1.0]}, "header: law: missing"),
        ({"predictor": []}, "header: predictor: missing"),
        ({"residuals": [0.0, None]}, "header: residuals: missing"),
        ({"names": {"machine": 3}}, "header: names: missing"),
        ({"physics": "elsewhere"}, "header: physics: unknown column"),
    ],
)
def test_another_header_is_refused(
    tmp_path: Path, values: dict[str, object], message: str
) -> None:
    path = tmp_path / "model.skops"
    save_model(learned(tmp_path), path)
    path.write_bytes(with_header(path.read_bytes(), values))
    with pytest.raises(StepNcError, match=message):
        load_model(path)


def test_a_file_that_is_no_model_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.skops"
    for content in (b"", b"text", skops.io.dumps(Ridge())):
        path.write_bytes(content)
        with pytest.raises(StepNcError, match="is no model of `stepnc learn`"):
            load_model(path)


def test_classes_outside_the_allow_list_are_never_made(tmp_path: Path) -> None:
    path = tmp_path / "model.skops"
    save_model(learned(tmp_path, "mlp"), path)
    with ZipFile(path) as archive:
        header = archive.read(HEADER)
    crafted = BytesIO(skops.io.dumps(FunctionTransformer(json.dumps)))
    with ZipFile(crafted, "a") as archive:
        archive.writestr(HEADER, header)
    path.write_bytes(crafted.getvalue())
    with pytest.raises(StepNcError, match=r"has json\.dumps, outside the allow-list"):
        load_model(path)
