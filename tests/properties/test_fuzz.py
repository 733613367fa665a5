"""Whatever the bytes: the verbs answer, or raise an error of the project, and soon."""

import re
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.verbs.optimise import program as advising
from stepnc_model.errors import StepNcError
from tests.asking import asked_advice
from tests.checked import check

ROOT = Path(__file__).parents[2]
SAMPLES = sorted((ROOT / "examples" / "parts").glob("*.stpnc"))
CORPUS = sorted((ROOT.parent / "shared" / "corpus").glob("*/*"))
FILES = {path.name: path.read_bytes() for path in [*SAMPLES, *CORPUS]}

PIECES = (
    b"(", b")", b"'", b"$", b"*", b",", b";", b"#", b".", b"/*", b"*/", b"#1", b"#999999",
    b"0.", b"-1.", b"1.E400", b"1.E-300", b"NAN", b"0", b"-7", b".T.", b"()", b"''",
    b"\\X2\\D800\\X0\\", b"\\S", b"\x00", b"\xff", b"ENDSEC;", b"DATA;", b"\n",
)  # fmt: skip
"""what is put into a file where it does not belong"""

REFERENCE = re.compile(rb"#\d+(?=[,)])")
NUMBER = re.compile(rb"-?\d+\.\d*(?:E[+-]?\d+)?")

UNITS = ("iso", "rpm-mmin", "rpm-mmtooth")

Place = st.floats(0.0, 1.0, exclude_max=True)
Edit = st.one_of(
    st.tuples(st.just("flip"), Place, st.integers(1, 255)),
    st.tuples(st.just("delete"), Place, st.integers(1, 60)),
    st.tuples(st.just("insert"), Place, st.integers(0, len(PIECES) - 1)),
    st.tuples(st.just("swap"), Place, st.integers(0, 10_000)),
    st.tuples(st.just("number"), Place, st.integers(0, len(PIECES) - 1)),
    st.tuples(st.just("truncate"), Place, st.just(0)),
    st.tuples(st.just("double"), Place, st.integers(1, 400)),
)

bounded = settings(
    max_examples=60,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)


def edited(data: bytes, kind: str, place: float, amount: int) -> bytes:
    """Data with one fault."""
    at = int(place * len(data))
    piece = PIECES[amount % len(PIECES)]
    match kind:
        case "flip":
            return data[:at] + bytes([data[at] ^ amount]) + data[at + 1 :] if data else data
        case "delete":
            return data[:at] + data[at + amount :]
        case "insert":
            return data[:at] + piece + data[at:]
        case "truncate":
            return data[:at]
        case "double":
            return data[: at + amount] + data[at:]
        case "swap":
            return swapped(data, REFERENCE, place, amount)
        case _:
            return swapped(data, NUMBER, place, piece)


def swapped(data: bytes, pattern: re.Pattern[bytes], place: float, new: int | bytes) -> bytes:
    """Data with one match replaced by a text, or by another match."""
    found = list(pattern.finditer(data))
    if not found:
        return data
    match = found[int(place * len(found))]
    text = new if isinstance(new, bytes) else found[new % len(found)][0]
    return data[: match.start()] + text + data[match.end() :]


def read_and_optimise(data: bytes, units: str = "iso") -> None:
    """Both verbs on the bytes; errors of the project are answers."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "part.stpnc"
        path.write_bytes(data)
        with suppress(StepNcError):
            check(path, units=units)
        with suppress(StepNcError):
            advising.advise_program(*asked_advice(file=path, units=units, dry_run=True))
        assert [each.name for each in Path(folder).iterdir()] == ["part.stpnc"]


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("units", UNITS)
def test_a_file_as_it_is_answers_or_refuses_in_every_unit_profile(
    name: str, units: str
) -> None:
    read_and_optimise(FILES[name], units)


@bounded
@given(name=st.sampled_from(sorted(FILES)), edits=st.lists(Edit, min_size=1, max_size=4))
def test_a_damaged_file_answers_or_refuses(
    name: str, edits: list[tuple[str, float, int]]
) -> None:
    data = FILES[name]
    for kind, place, amount in edits:
        data = edited(data, kind, place, amount)
    read_and_optimise(data)


@bounded
@given(
    name=st.sampled_from([path.name for path in SAMPLES]),
    places=st.lists(st.tuples(Place, st.integers(0, 10_000)), min_size=1, max_size=3),
)
def test_swapped_references_answer_or_are_refused(
    name: str, places: list[tuple[float, int]]
) -> None:
    data = FILES[name]
    for place, other in places:
        data = swapped(data, REFERENCE, place, other)
    read_and_optimise(data)


@settings(bounded, max_examples=25)
@given(data=st.binary(max_size=400), has_opening=st.booleans())
def test_any_bytes_answer_or_are_refused(data: bytes, has_opening: bool) -> None:
    read_and_optimise(b"ISO-10303-21;HEADER;ENDSEC;DATA;" + data if has_opening else data)
