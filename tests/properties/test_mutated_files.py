"""Files with random faults: a reader answers, or raises an error of the project.

Faults are seeded: bytes flipped, cut out, doubled and exchanged for words that hurt.
``STEPNC_SEEDED`` sets how many files are read of each kind (``STEPNC_SEEDED=1000``).
"""

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from random import Random

import pytest

import stepnc
from extras.calibration.model.measured_run import read_run
from extras.calibration.model.modal_fit import read_response
from extras.factory.model.shop_file import read_shop
from kbe.store import open_store
from service.knowledge.outcome_import import add_outcomes
from simulator.files.grade_file import read_grades
from simulator.files.holding_file import read_holding_file
from simulator.files.machine_file import read_machine
from simulator.files.machine_xml import read_machine_xml
from simulator.files.material_file import read_material
from simulator.spec import MachineKind, ToolKind
from stepnc_model.errors import StepNcError
from tests.checked import check
from tests.service.shop import shop

SEEDED = int(os.environ.get("STEPNC_SEEDED", "40"))
ROOT = Path(__file__).parents[2]
DATA = ROOT / "simulator" / "data"
WORDS = (
    b"", b"-1", b"0", b"1e308", b"-1e308", b"1e-320", b"nan", b"inf", b"99999999999999999999",
    b'"', b"'", b"[", b"]", b"{", b"}", b",", b"=", b"\n", b"\x00", b"\xff", b"<", b">", b"&",
    b"null", b"true", b"(", b")", b"#", b";", b"$",
)  # fmt: skip

HOLDING = b"""[[holding]]
kind = "chuck"
source = "a test"
jaws = 3
"""

RUN = b"time_s,x_mm,spindle_power_w\n" + b"".join(
    f"{0.1 * row:.1f},{row},{100 + row}\n".encode() for row in range(30)
)

RESPONSE = b"frequency_hz,real_um_n,imag_um_n\n" + b"".join(
    f"{100 + row},{0.01 * row},{-0.01 * row}\n".encode() for row in range(30)
)

MACHINE_XML = (ROOT / "tests" / "simulator" / "data" / "paper003.xml").read_bytes()


def mutated(data: bytes, rng: Random) -> bytes:
    """Data with one to three faults."""
    for _ in range(rng.randint(1, 3)):
        if not data:
            break
        at = rng.randrange(len(data))
        size = rng.randint(1, 30)
        match rng.randrange(5):
            case 0:
                data = data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1 :]
            case 1:
                data = data[:at] + data[at + size :]
            case 2:
                data = data[:at] + data[at : at + size] * 2 + data[at + size :]
            case 3:
                data = data[:at] + rng.choice(WORDS) + data[at:]
            case _:
                data = _other_number(data, at, rng)
    return data


def _other_number(data: bytes, at: int, rng: Random) -> bytes:
    """Data with the next number exchanged."""
    digits = b"0123456789.eE+-"
    begin = next((place for place in range(at, len(data)) if data[place] in digits), len(data))
    end = next(
        (place for place in range(begin, len(data)) if data[place] not in digits), len(data)
    )
    return data[:begin] + rng.choice(WORDS) + data[end:]


Reader = Callable[[Path], object]

READERS: dict[str, tuple[str, bytes, Reader]] = {
    "machine": ("m.toml", (DATA / "machines" / "vmc15.toml").read_bytes(), read_machine),
    "lathe": ("m.toml", (DATA / "machines" / "lathe22.toml").read_bytes(), read_machine),
    "machine xml": ("m.xml", MACHINE_XML, read_machine_xml),
    "material": (
        "m.toml", sorted((DATA / "materials").glob("*.toml"))[0].read_bytes(), read_material,
    ),
    "grades": (
        "g.toml", (DATA / "tools" / "endmill.toml").read_bytes(),
        lambda path: read_grades(path, ToolKind.ENDMILL),
    ),
    "holding": ("h.toml", HOLDING, lambda path: read_holding_file(path, MachineKind.LATHE)),
    "shop": ("s.toml", (ROOT / "examples" / "shops" / "line.toml").read_bytes(), read_shop),
    "run": ("r.csv", RUN, read_run),
    "response": ("f.csv", RESPONSE, read_response),
    "program": ("p.stpnc", (ROOT / "examples/parts/paper002.stpnc").read_bytes(), check),
}  # fmt: skip


@pytest.mark.parametrize("kind", READERS)
def test_a_reader_answers_or_says_what_is_wrong(kind: str, tmp_path: Path) -> None:
    name, data, read = READERS[kind]
    rng, path = Random(kind), tmp_path / name
    for _ in range(SEEDED):
        path.write_bytes(mutated(data, rng))
        with suppress(StepNcError):
            read(path)


def test_outcomes_are_added_or_refused(tmp_path: Path) -> None:
    source, path = tmp_path / "source.db", tmp_path / "outcomes.json"
    with open_store(str(source)) as store:
        store.add(list(shop(1)))
    stepnc.kbe_export("outcomes", kb=str(source), output=path)
    data, rng = path.read_bytes(), Random("outcomes")
    for _ in range(SEEDED):
        path.write_bytes(mutated(data, rng))
        with suppress(StepNcError):
            add_outcomes(str(tmp_path / "kb.db"), path)


def test_a_feed_of_1e308_is_refused_with_its_outcome(tmp_path: Path) -> None:
    source, path = tmp_path / "source.db", tmp_path / "outcomes.json"
    with open_store(str(source)) as store:
        store.add(list(shop(1)))
    stepnc.kbe_export("outcomes", kb=str(source), output=path)
    text = path.read_text()
    old = '"feed_measured_mm_s": '
    begin = text.index(old) + len(old)
    end = text.index(",", begin)
    path.write_text(text[:begin] + "1e308" + text[end:])
    with pytest.raises(StepNcError, match=r"outcome 1: feed: implausible deviation"):
        add_outcomes(str(tmp_path / "kb.db"), path)
    assert not (tmp_path / "kb.db").exists()
