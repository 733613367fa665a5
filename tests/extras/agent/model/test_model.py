"""Device models that somebody else wrote."""

from pathlib import Path

import pytest
from lxml import etree

from extras.agent.model.model import DeviceModel, model_of, read_model
from simulator.client.xml_text import parsed
from simulator.errors import AgentError
from tests.every_case import every_case

SHARED = Path(__file__).parents[5] / "shared" / "mtconnect"

TYPES = """<Devices><Device id="d" uuid="u" name="D"><DataItems>
<DataItem id="avail" type="AVAILABILITY" category="EVENT"/>
<DataItem id="series" name="s" type="WATTAGE" category="SAMPLE" units="WATT"
 nativeUnits="KILOWATT" representation="TIME_SERIES" sampleRate="100"/>
<DataItem id="set" type="VARIABLE" category="EVENT" representation="DATA_SET"/>
<DataItem id="feed" type="PATH_FEEDRATE" category="SAMPLE" units="MILLIMETER/SECOND"
 nativeUnits="INCH/MINUTE"><Filters><Filter type="MINIMUM_DELTA">0.5</Filter>
 <Filter type="PERIOD">2</Filter></Filters></DataItem>
<DataItem id="temp" type="TEMPERATURE" category="SAMPLE" units="CELSIUS"
 nativeUnits="FAHRENHEIT"/>
<DataItem id="cond" type="SYSTEM" category="CONDITION"/>
<DataItem id="msg" type="MESSAGE" category="EVENT"/>
</DataItems></Device></Devices>"""


def model_from(text: str, version: str = "2.7") -> DeviceModel:
    return model_of(etree.fromstring(text), version)


def test_items_are_read_with_units_filters_and_representation() -> None:
    model = model_from(TYPES)
    feed = model.items[model.index["feed"]]
    assert feed.scale == pytest.approx(25.4 / 60.0)
    assert (feed.minimum_delta, feed.period) == (0.5, 2.0)
    temperature = model.items[model.index["temp"]]
    assert 212.0 * temperature.scale + temperature.offset == pytest.approx(100.0)
    assert model.items[model.index["series"]].element == "WattageTimeSeries"
    assert model.index["s"] == model.index["series"]


@pytest.mark.parametrize(
    ("file", "items"), [("devices-mill.xml", 93), ("devices-lathe.xml", 86)]
)
def test_models_of_others_are_read(file: str, items: int) -> None:
    if not (SHARED / file).is_file():
        pytest.skip(f"{file} is not in ../shared/mtconnect")
    model = read_model(SHARED / file)
    assert (model.version, len(model.items)) == ("2.7", items)


def test_ids_are_unique() -> None:
    with pytest.raises(AgentError, match="'avail': missing or not unique"):
        model_from(TYPES.replace('"set"', '"avail"'))


@every_case(
    ("text", "message"),
    [
        (b"<a", "not well-formed"),
        (b"<a>" * 50 + b"</a>" * 50, "nested more than"),
        (b'<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', "document type"),
        (b"<a>" + b" " * (1 << 22) + b"</a>", "more than"),
        (b'<?xml version="1.0" encoding="no-such"?><a/>', "not well-formed"),
    ],
)
def test_hostile_xml_is_refused(text: bytes, message: str) -> None:
    with pytest.raises(AgentError, match=message):
        parsed(text, what="model.xml")


@every_case(
    ("text", "message"),
    [
        ("<MTConnectDevices/>", "expected MTConnectDevices"),
        ('<MTConnectStreams xmlns="urn:mtconnect.org:MTConnectStreams:2.7"/>', "expected MTC"),
        ('<MTConnectDevices xmlns="urn:mtconnect.org:MTConnectDevices:2.7"/>', "no Devices"),
    ],
)
def test_other_documents_are_refused(text: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "model.xml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(AgentError, match=message):
        read_model(file)
    with pytest.raises(AgentError, match="cannot be read"):
        read_model(tmp_path / "absent.xml")
