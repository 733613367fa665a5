"""The page is whole, honest, and fetches nothing."""

import re
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser

import pytest

from service.plots.buckets import BucketedRun
from service.simulation.facts import CarbonFactor
from service.simulation.run import Simulation
from service.simulation.run_collector import TraceKeeper
from service.verbs.simulate.result import SimulateResult
from simulator.library import load_material
from simulator.machine.totals import Total
from simulator.spec import Certainty, MaterialMatch

VOID = {"meta", "br", "link", "img", "hr", "input"}


class Reader(HTMLParser):
    """Checks that elements nest; gathers tables and attributes."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.attributes: list[tuple[str, str | None]] = []
        self.tables: list[list[list[str]]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.attributes += attrs
        if tag not in VOID:
            self.open.append(tag)
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in {"td", "th"}:
            self.tables[-1][-1].append("")

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] in {"td", "th"}:
            self.tables[-1][-1][-1] += data


@pytest.fixture(scope="module")
def page(simulation: Simulation, trace: BucketedRun) -> str:
    return SimulateResult(simulation=replace(simulation, trace=trace)).page()


@pytest.fixture(scope="module")
def read(page: str) -> Reader:
    reader = Reader()
    reader.feed(own(page))
    reader.close()
    return reader


def own(page: str) -> str:
    """The page without the plotting library."""
    return re.sub(r"<script>.*?</script>", "", page, count=1, flags=re.DOTALL)


def column(table: list[list[str]], name: str) -> list[float]:
    """Numbers under a heading, one a workingstep, then the total."""
    place = table[0].index(name)
    return [float(line[place]) for line in table[1:5]]


def test_elements_nest(read: Reader) -> None:
    assert read.open == []
    assert len(read.tables) == 4


def test_nothing_comes_from_or_goes_to_another_host(page: str, read: Reader) -> None:
    assert not re.search(r"https?:|//\w+\.", own(page))
    assert not [name for name, _ in read.attributes if name in {"src", "href"}]
    assert '"showSendToCloud": false' in own(page)


def test_no_handler_stands_in_an_attribute(read: Reader) -> None:
    assert not [name for name, _ in read.attributes if name.startswith("on")]


def test_names_cannot_become_markup(page: str, read: Reader) -> None:
    text = own(page)
    assert "a&amp;b &lt;i&gt;.stpnc" in text
    assert "<i>" not in text
    assert "<script>alert" not in text
    assert "<b>no" not in text
    assert read.tables[0][2][0] == "<script>alert('a & b')</script>"


def test_the_same_run_has_the_same_page(
    page: str, simulation: Simulation, trace: BucketedRun
) -> None:
    assert SimulateResult(simulation=replace(simulation, trace=trace)).page() == page


def test_times_add_up(read: Reader) -> None:
    table = read.tables[0]
    kinds = ("time s", "cutting", "air", "rapid", "waiting")
    for name in kinds:
        *parts, total = column(table, name)
        assert sum(parts) == pytest.approx(total, abs=0.2)
    whole, *kinds_of_time = (column(table, name) for name in kinds)
    sums = [sum(line) for line in zip(*kinds_of_time, strict=True)]
    assert sums == pytest.approx(whole, abs=0.2)


def test_energies_add_up(read: Reader, simulation: Simulation) -> None:
    table = read.tables[1]
    names = ("X axis", "Y axis", "Z axis", "spindle", "coolant", "base load")
    for name in (*names, "energy kJ"):
        *parts, total = column(table, name)
        assert sum(parts) == pytest.approx(total, abs=0.2)
    assert column(table, "energy kJ")[-1] == pytest.approx(
        simulation.whole.energy.total / 1e3, abs=0.05
    )
    shares = [float(cell.rstrip("%")) for cell in table[5][1:7]]
    assert sum(shares) == pytest.approx(100.0, abs=0.3)


def test_carbon_follows_from_the_factor(simulation: Simulation, trace: BucketedRun) -> None:
    factor = CarbonFactor(grams_per_kwh=36.0, source="our <own> roof")
    text = SimulateResult(simulation=replace(simulation, trace=trace), carbon=factor).page()
    assert "carbon by 36 g CO₂/kWh: our &lt;own&gt; roof" in text
    # 311.8 kJ and 36 g in 3600 kJ.
    assert "<td>3.12</td>" in text


def test_removal_is_that_of_the_totals(read: Reader) -> None:
    """20 cm³ in 60 s, 40 s of them with chips, with 224.3 kJ, 60 kJ at the edge."""
    assert read.tables[2][2][1:] == ["20.00", "30.00", "20.00", "11.21", "3.00"]
    assert read.tables[2][1][1:] == ["0.00", "–", "–", "–", "–"]


def test_peaks_stand_where_they_are(read: Reader) -> None:
    power = read.tables[3][1]
    assert power[:4] == ["spindle power, kW", "4.50", "30.0", "12"]
    assert power[4].startswith("<script>")


def test_limits_and_findings_are_said_once(page: str) -> None:
    text = unescape(own(page))
    assert text.count("2.5 s above the spindle drive's continuous power") == 1
    assert text.count("line 7: spares <b>no</b> tool") == 1


def test_the_material_is_named_when_known(
    page: str, simulation: Simulation, trace: BucketedRun
) -> None:
    assert "material unknown" in page
    match = MaterialMatch(
        material=load_material("c45"), certainty=Certainty.EXACT, reason="read as <C45>"
    )
    assert (
        "read as &lt;C45&gt;"
        in SimulateResult(simulation=replace(simulation, trace=trace, material=match)).page()
    )


def test_an_empty_run_has_a_page(simulation: Simulation) -> None:
    nothing = replace(simulation, totals=(("", Total()),), findings=())
    text = SimulateResult(simulation=replace(nothing, trace=TraceKeeper().trace())).page()
    assert text.count("<p>none</p>") == 2
