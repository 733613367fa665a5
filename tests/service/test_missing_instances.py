"""A reference to an instance that is not there: an exit code and its line, no traceback."""

from pathlib import Path
from random import Random

from stepnc_model.ap238.instances import references
from stepnc_model.part21.reader import Part21File
from tests.service.damage import PARTS, PROGRAM_COMMANDS, failures, programs, run, without_each

QUICK = PROGRAM_COMMANDS[:5]
COUNT = 8


def asked_for_by_keyword(data: bytes) -> list[int]:
    """Instances of which a reader asks the keyword before anything else, two of each kind."""
    file = Part21File.from_bytes(data)
    found = []
    for keyword in ("WORKPIECE", "MACHINING_TOOL_BODY_REPRESENTATION"):
        for id in file.ids_of(keyword):
            refs = [int(ref) for value in file.parameters(id) for ref in references(value)]
            found += refs[-2:]
    return found


def test_a_sample_of_instances_that_are_left_out(tmp_path: Path) -> None:
    rng, wrong = Random("missing"), []
    for name, data in programs(tmp_path).items():
        if name not in {"paper002.stpnc", "ap238.stpnc", "shaft.stpnc"}:
            continue
        cases = without_each(data)
        chosen = rng.sample(sorted(cases), COUNT // 2) + asked_for_by_keyword(data)
        for id in chosen:
            commands = (QUICK[0], rng.choice(QUICK[1:]))
            wrong += failures(tmp_path / name, cases[id], commands, f"{name} without #{id}")
    assert not wrong, "\n".join(wrong)


def test_the_message_names_the_line_that_refers_to_it(tmp_path: Path) -> None:
    data = (PARTS / "paper002.stpnc").read_bytes()
    line = next(row for row, text in enumerate(data.splitlines(), 1) if b"#50,#41" in text)
    path = tmp_path / "p.stpnc"
    path.write_bytes(without_each(data)[50])
    code, told = run(["toolpath", str(path)])
    assert code == 3
    assert f"line {line}" in told or "#50" in told
