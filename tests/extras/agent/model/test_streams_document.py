"""Documents of streams that are read back."""

from pathlib import Path

import numpy as np
import pytest
from lxml import etree

from extras.agent.model.agent import Agent, StreamQuery
from extras.agent.model.buffer import ConditionValue, TimeSeriesValue, Value
from extras.agent.model.model import DeviceModel, model_of
from extras.agent.model.streams_document import read_streams
from tests.extras.agent.model.conftest import require_valid

BEGIN = 1_760_000_000_000_000
VALUES: list[tuple[str, Value]] = [
    ("x", 1.5),
    ("x", None),
    ("place", "1.5 2 3"),
    ("program", "a | b <c> & d"),
    ("hot", ConditionValue(level="FAULT", native_code="E7", qualifier="HIGH", text="too hot")),
    ("hot", ConditionValue(level="NORMAL", native_code="E7")),
    ("vars", {"a": "1", "b": "two words"}),
    ("vars", {"a": None}),
    ("shake", TimeSeriesValue(values=(0.5, -1.0, 2.0), rate=100.0)),
]


@pytest.fixture
def model() -> DeviceModel:
    rows: tuple[tuple[str, str, str, dict[str, str]], ...] = (
        ("SAMPLE", "x", "POSITION", {"units": "MILLIMETER"}),
        ("SAMPLE", "place", "PATH_POSITION", {"units": "MILLIMETER_3D"}),
        ("SAMPLE", "shake", "ACCELERATION", {"representation": "TIME_SERIES"}),
        ("EVENT", "program", "PROGRAM", {}),
        ("EVENT", "vars", "VARIABLE", {"representation": "DATA_SET"}),
        ("CONDITION", "hot", "TEMPERATURE", {}),
    )
    devices = etree.Element("Devices")
    device = etree.SubElement(devices, "Device", id="d", uuid="u", name="d")
    holder = etree.SubElement(device, "DataItems")
    for category, id, kind, words in rows:
        etree.SubElement(holder, "DataItem", {"category": category, "id": id, "type": kind}
                         | words)  # fmt: skip
    return model_of(devices, "2.7")


def test_what_was_written_is_read(model: DeviceModel, tmp_path: Path) -> None:
    agent = Agent(model=model, clock=lambda: BEGIN)
    begun = agent.buffer.next
    items = np.array([model.index[id] for id, _ in VALUES])
    times = BEGIN + 1000 * np.arange(len(VALUES))
    agent.add(items, times, [value for _, value in VALUES])
    file = tmp_path / "run.xml"
    query = StreamQuery(chosen=None, start=begun, count=100)
    file.write_bytes(agent.sample(query)[0])
    require_valid(file.read_bytes(), "2.7")
    found = read_streams(file, model)
    assert found.items.tolist() == items.tolist()
    assert found.times.tolist() == times.tolist()
    assert found.values == [value for _, value in VALUES]
    assert found.unknown == ()
