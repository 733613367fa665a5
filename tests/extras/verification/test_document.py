"""Documents and SHDR lines as tables."""

from pathlib import Path

import numpy as np
import pytest

from extras.verification.log import LogFile, table_of
from service.recording.table import POSITIONS
from simulator.library import load_machine
from stepnc_model.errors import StepNcError
from tests.extras.verification.test_log import ONE

VMC15 = load_machine("vmc15")
LINES = """\
2026-01-01T00:00:00.000Z|xpos|1.0|ypos|2.0|zpos|3.0
2026-01-01T00:00:00.100Z|xpos|1.5
2026-01-01T00:00:00.200Z|ypos|2.5
2026-01-01T00:00:00.300Z|xpos|UNAVAILABLE
2026-01-01T00:00:00.400Z|xpos|2.5|ypos|2.5
"""


def lines_of(folder: Path, text: str = LINES) -> Path:
    path = folder / "run.log"
    path.write_text(text, encoding="utf-8")
    return path


def test_values_are_held_until_the_next_one(tmp_path: Path) -> None:
    table = table_of(lines_of(tmp_path), VMC15, POSITIONS)
    assert table.column("time_s").to_pylist() == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4])
    x, y, z = (table.column(name).to_numpy() for name in POSITIONS)
    assert x[[0, 1, 2, 4]].tolist() == [1.0, 1.5, 1.5, 2.5]
    assert np.isnan(x[3])
    assert y.tolist() == [2.0, 2.0, 2.5, 2.5, 2.5]
    assert z.tolist() == [3.0] * 5


def test_a_log_of_lines_is_read_like_a_table(tmp_path: Path) -> None:
    (samples,) = LogFile(path=lines_of(tmp_path), names=ONE, machine=VMC15).pieces()
    assert samples.position[:, 0].tolist() == pytest.approx([1.0, 1.5, 1.5, 2.0, 2.5])


def test_a_log_without_positions_says_so(tmp_path: Path) -> None:
    path = lines_of(tmp_path, "2026-01-01T00:00:00.000Z|exec|ACTIVE\n")
    with pytest.raises(StepNcError):
        list(LogFile(path=path, names=ONE, machine=VMC15).pieces())


def test_lines_of_another_machine_name_the_option_that_verify_has(tmp_path: Path) -> None:
    path = lines_of(tmp_path, "2026-01-01T00:00:00.000Z|elsewhere|1.0\n")
    with pytest.raises(StepNcError) as refused:
        table_of(path, VMC15, POSITIONS)
    assert "(elsewhere): name the machine with --machine" in str(refused.value)
    assert "--device" not in str(refused.value)


def test_a_damaged_document_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.xml"
    path.write_text("<a>", encoding="utf-8")
    with pytest.raises(StepNcError, match=r"run\.xml"):
        table_of(path, VMC15, POSITIONS)


OTHER = """\
<MTConnectStreams xmlns="urn:mtconnect.org:MTConnectStreams:1.7"><Streams>
<DeviceStream name="m">
<ComponentStream component="Path" name="path" componentId="p"><Samples>
<PathPosition dataItemId="tip" sequence="1"
 timestamp="2026-01-01T00:00:00Z">1 2 3</PathPosition>
<PathPosition dataItemId="tip" sequence="2"
 timestamp="2026-01-01T00:00:01Z">2 2 3</PathPosition>
</Samples><Events>
<ToolNumber dataItemId="t" sequence="3" timestamp="2026-01-01T00:00:00Z">3</ToolNumber>
</Events></ComponentStream></DeviceStream></Streams></MTConnectStreams>
"""


def test_a_document_of_another_agent_is_read_by_its_types(tmp_path: Path) -> None:
    path = tmp_path / "run.xml"
    path.write_text(OTHER, encoding="utf-8")
    file = LogFile(path=path, names=ONE, machine=VMC15)
    (samples,) = file.pieces()
    assert samples.position.tolist() == [[1.0, 2.0, 3.0], [2.0, 2.0, 3.0]]
    assert "PATH_POSITION" in file.zero_source
