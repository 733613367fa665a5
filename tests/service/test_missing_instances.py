"""A reference to an instance that is not there: an exit code and its line, no traceback."""

from pathlib import Path
from random import Random

from tests.service.damage import PARTS, PROGRAM_COMMANDS, failures, programs, run, without_each

QUICK = PROGRAM_COMMANDS[:5]
COUNT = 8


def test_a_sample_of_instances_that_are_left_out(tmp_path: Path) -> None:
    rng, wrong = Random("missing"), []
    for name, data in programs(tmp_path).items():
        if name not in {"paper002.stpnc", "ap238.stpnc", "shaft.stpnc"}:
            continue
        cases = without_each(data)
        for id in rng.sample(sorted(cases), COUNT // 2):
            commands = rng.sample(QUICK, 2)
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
