"""Documents of streams without their device model."""

from pathlib import Path

import pytest

from simulator.client.columns import read_document
from simulator.errors import AgentError
from tests.every_case import every_case

STREAMS = """<MTConnectStreams xmlns="urn:mtconnect.org:MTConnectStreams:1.3">
<Header firstSequence="1" nextSequence="9" instanceId="1"/>
<Streams><DeviceStream name="Mill"><ComponentStream component="Linear" name="X"><Samples>
<Position dataItemId="xp" subType="ACTUAL" sequence="2"
timestamp="2026-01-01T00:00:01Z">2.5</Position>
<Position dataItemId="xp" subType="ACTUAL" sequence="1"
timestamp="2026-01-01T00:00:00Z">1.5</Position>
</Samples></ComponentStream><ComponentStream component="Path" name="path"><Samples>
<PathFeedrate dataItemId="f" subType="ACTUAL" sequence="3"
timestamp="2026-01-01T00:00:01Z">UNAVAILABLE</PathFeedrate>
</Samples><Events>
<Execution dataItemId="e" sequence="0" timestamp="2026-01-01T00:00:00Z">ACTIVE</Execution>
</Events></ComponentStream></DeviceStream></Streams></MTConnectStreams>"""


def written(folder: Path, text: str) -> Path:
    path = folder / "run.xml"
    path.write_text(text, encoding="utf-8")
    return path


def test_rows_have_the_columns_of_a_recorded_run(tmp_path: Path) -> None:
    document = read_document(written(tmp_path, STREAMS))
    assert [each.type for each in document.items] == ["POSITION", "PATH_FEEDRATE", "EXECUTION"]
    first, second = document.rows()
    assert (first["time_s"], second["time_s"]) == (0.0, 1.0)
    assert (first["x_axis_position_actual"], second["x_axis_position_actual"]) == (1.5, 2.5)
    assert first["execution"] == "ACTIVE"


@every_case(
    ("text", "message"),
    [
        ("<MTConnectError/>", "root element MTConnectError; expected MTConnectStreams"),
        (STREAMS.replace("00:00:01Z", "late"), "line 5: Invalid isoformat"),
        (STREAMS[:100], "run.xml"),
    ],
)
def test_what_is_no_document_is_told(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(AgentError, match=message):
        read_document(written(tmp_path, text))
    with pytest.raises(AgentError, match="cannot be read"):
        read_document(tmp_path / "none.xml")


def test_positions_of_two_machines_are_not_mixed(tmp_path: Path) -> None:
    device = STREAMS[STREAMS.index("<DeviceStream") : STREAMS.index("</Streams>")]
    other = device.replace('"Mill"', '"Lathe"').replace('dataItemId="', 'dataItemId="l')
    path = written(tmp_path, STREAMS.replace("<DeviceStream", other + "<DeviceStream", 1))
    with pytest.raises(AgentError, match="tells of 2 devices, 'Lathe', 'Mill': ask"):
        read_document(path)


def test_an_agent_that_tells_of_itself_is_no_second_machine(tmp_path: Path) -> None:
    own = (
        '<DeviceStream name="Agent"><ComponentStream component="Agent" name="a"><Events>'
        '<Availability dataItemId="a" sequence="4" timestamp="2026-01-01T00:00:01Z">AVAILABLE'
        "</Availability></Events></ComponentStream></DeviceStream>"
    )
    path = written(tmp_path, STREAMS.replace("<DeviceStream", own + "<DeviceStream", 1))
    assert len(read_document(path).rows()) == 2
