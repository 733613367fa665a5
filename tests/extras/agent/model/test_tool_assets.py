"""Tools of programs as assets, in every schema version."""

from math import pi

from lxml import etree

from extras.agent.model.documents import DocumentWriter
from extras.agent.model.tool_assets import tool_asset
from simulator.client.document_choices import SchemaVersion
from simulator.machine.cutting import CuttingEdge
from simulator.machine.virtual import LoadedTool, Shape
from simulator.removal.cutter import Cutter, Holder, Insert
from simulator.spec import Kienzle
from tests.every_case import every_case
from tests.extras.agent.model.conftest import mill, require_valid

EDGE = CuttingEdge(teeth=4, kienzle=Kienzle(k_c11=1500.0, m_c=0.22))
SHAPES = (
    Cutter(diameter=20.0, corner_radius=2.0, teeth=4, edge_length=38.0),
    Cutter(diameter=9.8, point_angle=0.75 * pi, is_drill=True,
           holder=Holder(diameter=40.0, overhang=90.0)),
    Insert(nose_radius=0.8),
    None,
)  # fmt: skip


def asset_of(shape: Shape | None) -> str:
    tool = LoadedTool(number=3, id="END MILL <20> MM", shape=shape, edge=EDGE)
    return tool_asset(tool, device="vmc15", uuid="u-1", index=1, time=10**15).text


@every_case("version", list(SchemaVersion))
@every_case("shape", SHAPES)
def test_a_tool_is_a_valid_asset(version: SchemaVersion, shape: Shape | None) -> None:
    writer = DocumentWriter(
        model=mill(version.value), sender="t", instance=1, changed="2026-01-01T00:00:00Z"
    )
    root = require_valid(writer.assets([asset_of(shape)], count=1), version.value)
    (tool,) = (each for each in root.iter() if each.get("assetId"))
    assert (tool.get("assetId"), tool.get("toolId")) == ("vmc15.T3", "END_MILL__20__MM")


def test_edges_and_lengths_are_told() -> None:
    tool = etree.fromstring(asset_of(SHAPES[0]))
    assert tool.xpath("string(.//CuttingItems/@count)") == "4"
    assert tool.findtext(".//CuttingDiameterMax") == "20"
    assert tool.findtext(".//CornerRadius") == "2"
    assert tool.findtext(".//CuttingEdgeLength") == "38"
    drill = etree.fromstring(asset_of(SHAPES[1]))
    assert drill.findtext(".//PointAngle") == "135"
    assert drill.findtext(".//ProtrudingLength") == "90"
