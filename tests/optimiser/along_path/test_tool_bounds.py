"""Bounds of tools of a table, and what is told of tools without windows of their own."""

from dataclasses import replace
from math import inf

import numpy as np

from optimiser.along_path.caps import CutBounds
from optimiser.along_path.stretch import met_caps
from optimiser.along_path.tool_bounds import bounds_of_tool, window_findings
from simulator.library import load_machine, load_material
from simulator.removal.cutter import Cutter, Holder, Insert
from simulator.removal.stations import StationKind
from simulator.spec import CuttingMaterial, ToolKind, WorkMaterial
from simulator.tools.tool_table import TableTool
from stepnc_model.errors import Severity
from tests.every_case import every_case
from tests.optimiser.along_path.stretches import BOUNDS, half_cut, straight, stretch_of

C45 = load_material("c45")
HARD = load_material("hardened_55hrc")
HSS, CERAMIC = CuttingMaterial.HSS, CuttingMaterial.CERAMIC
MILL = TableTool(
    number=1,
    id="mill",
    kind=ToolKind.ENDMILL,
    cutting_material=CuttingMaterial.CARBIDE,
    teeth=4,
    shape=Cutter(diameter=12.0, teeth=4, edge_length=inf),
)


def bounds(tool: TableTool, material: WorkMaterial, machine: str = "vmc15") -> CutBounds:
    found = bounds_of_tool(
        tool,
        load_machine(machine),
        material,
        quantile=0.9,
        is_finishing=False,
        roughness=None,
    )
    assert found is not None
    return found


TURNING = TableTool(
    number=2,
    id="insert",
    kind=ToolKind.TURNING,
    cutting_material=CuttingMaterial.CARBIDE,
    teeth=1,
    shape=Insert(nose_radius=0.8),
)


@every_case(
    ("tool", "material", "keeps"),
    [
        (MILL, C45, False),
        (MILL, replace(C45, iso_group=""), False),
        (replace(MILL, cutting_material=HSS), HARD, True),
        (replace(MILL, kind=ToolKind.FACEMILL, cutting_material=CERAMIC), C45, True),
        (replace(MILL, cutting_material=CERAMIC), C45, True),
    ],
)
def test_a_tool_without_windows_raises_no_feed(
    tool: TableTool, material: WorkMaterial, *, keeps: bool
) -> None:
    assert bounds(tool, material).keeps_programmed is keeps


def test_the_stiffness_of_a_mill_counts_without_a_group() -> None:
    assert bounds(MILL, replace(C45, iso_group="")).at.grade is not None


def test_a_stated_overhang_is_that_of_the_cut() -> None:
    held = Cutter(diameter=12.0, teeth=4, holder=Holder(diameter=24.0, overhang=90.0))
    assert bounds(replace(MILL, shape=held), C45).cut.tool.overhang == 90.0
    assert bounds(MILL, C45).cut.tool.overhang is None


def test_a_kept_feed_is_that_of_each_block_where_there_is_material() -> None:
    met = half_cut([5.0, 10.0], [True, False])
    path = replace(stretch_of(straight([10.0], speed=2.0)), met=met, bounds=BOUNDS)
    free = met_caps(path).caps.feed
    kept = met_caps(replace(path, bounds=replace(BOUNDS, keeps_programmed=True))).caps.feed
    assert free[0] > 2.0
    assert kept[0] == 2.0
    assert np.isinf(kept[1])


@every_case(
    ("tool", "material", "severity", "words"),
    [
        (replace(MILL, cutting_material=HSS), HARD, Severity.ERROR, "high-speed steel"),
        (replace(MILL, cutting_material=CERAMIC), C45, Severity.WARNING, "max_feed_mm"),
        (MILL, replace(C45, iso_group=""), Severity.WARNING, "ISO group S"),
    ],
)
def test_windows_that_are_not_the_tool_s_own_are_told(
    tool: TableTool, material: WorkMaterial, severity: Severity, words: str
) -> None:
    machine = load_machine("vmc15")
    (found,) = window_findings([tool], machine, material)
    assert found.severity is severity
    assert words in found.message
    assert list(window_findings([MILL], machine, C45)) == []


def test_a_place_deeper_than_the_insert_may_cut_keeps_its_feed() -> None:
    """At a shoulder the whole edge meets what is left on its face."""
    of_library = bounds(TURNING, C45, "lathe22")
    told = bounds(replace(TURNING, max_depth=3.0), C45, "lathe22")
    assert (of_library.deepest, told.deepest) == (6.0, 3.0)
    assert bounds(MILL, C45).deepest is None
    met = half_cut([5.0, 10.0], [True, True])
    met = replace(
        met,
        kind=np.full(2, int(StationKind.TURNING)),
        axial_depth=np.array([0.5, 4.0]),
        section=np.array([0.5, 4.0]),
        diameter=np.full(2, 40.0),
    )
    path = replace(stretch_of(straight([10.0], speed=0.5)), met=met)
    shallow, deep = met_caps(replace(path, bounds=told)).caps.feed
    assert shallow > 0.5
    assert deep == 0.5
    assert met_caps(replace(path, bounds=of_library)).caps.feed[1] > 0.5
