"""A thousand files that are nearly programs: each is taken or refused, nothing else."""

import random
import re
from collections.abc import Callable
from pathlib import Path

import httpx

from tests.service.rest.samples import PARTS
from tests.service.rest.server import Server
from tests.service.waiting import rss_mib

COUNT = 400

GROWTH = 24.0
"""MiB that the second half may add to the memory of the first"""


def flipped(data: bytes, chance: random.Random) -> bytes:
    found = bytearray(data)
    for _ in range(chance.randrange(1, 40)):
        found[chance.randrange(len(found))] = chance.randrange(256)
    return bytes(found)


def cut(data: bytes, chance: random.Random) -> bytes:
    begin = chance.randrange(len(data)) if chance.random() < 0.3 else 0
    return data[begin : chance.randrange(begin, len(data))]


def shuffled(data: bytes, chance: random.Random) -> bytes:
    lines = data.splitlines(keepends=True)
    for _ in range(chance.randrange(1, 30)):
        one, other = chance.randrange(len(lines)), chance.randrange(len(lines))
        lines[one], lines[other] = lines[other], lines[one]
    return b"".join(lines)


def doubled(data: bytes, chance: random.Random) -> bytes:
    lines = data.splitlines(keepends=True)
    at = chance.randrange(len(lines))
    return b"".join([*lines[:at], *lines[at:] * 2])


NUMBER = re.compile(rb"(?<=[(,])-?\d+\.\d*(?=[,)])")

NUMBERS = (
    b"1.E400", b"-1.E308", b"1.E-400", b"9" * 400 + b".", b"0.", b"-0.", b"NAN", b"1e5",
    b"1.7976931348623157E308",
)  # fmt: skip


def numbered(data: bytes, chance: random.Random) -> bytes:
    found = list(NUMBER.finditer(data))
    for match in sorted(
        chance.sample(found, min(8, len(found))), key=lambda each: -each.start()
    ):
        data = data[: match.start()] + chance.choice(NUMBERS) + data[match.end() :]
    return data


def referred(data: bytes, chance: random.Random) -> bytes:
    """References that lead in circles, nowhere, or to something else."""
    found = sorted(set(re.findall(rb"#\d+", data)))
    if not found:
        return data
    for _ in range(chance.randrange(1, 6)):
        one, other = chance.choice(found), chance.choice([*found, b"#99999999999999999999"])
        data = re.sub(one + rb"(?=[,)])", other, data, count=chance.randrange(1, 4))
    return data


def nested(data: bytes, chance: random.Random) -> bytes:
    depth = chance.choice([50, 5000, 100_000])
    deep = b"(" * depth + chance.choice([b"1.", b"", b"#2", b"'x'"]) + b")" * depth
    return data.replace(b"DATA;", b"DATA;\n#900001=DEEP(" + deep + b");", 1)


def long(data: bytes, chance: random.Random) -> bytes:
    word = chance.choice([b"'" + b"x" * 300_000 + b"'", b"(" + b"1.," * 60_000 + b"1.)"])
    return data.replace(b"DATA;", b"DATA;\n#900001=LONG(" + word + b");", 1)


def spoiled(data: bytes, chance: random.Random) -> bytes:
    bad = chance.choice(
        [b"\0", b"\xff\xfe", b"\xc3\x28", b"\xed\xa0\x80", b"'", b"/*", b"\\X2\\D800\\X0\\",
         b"\\X4\\00110000\\X0\\", b"\\S\\", b"\r", b"\x1b[31m", "\u202e".encode()]
    )  # fmt: skip
    at = chance.randrange(len(data))
    return data[:at] + bad * chance.randrange(1, 5) + data[at:]


MUTATIONS: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    flipped, cut, shuffled, doubled, numbered, referred, nested, long, spoiled,
)  # fmt: skip


def mutated(number: int) -> bytes:
    """The same file for the same number, on each computer."""
    chance = random.Random(number)
    files = sorted(PARTS.glob("*.stpnc"))
    data = files[number % len(files)].read_bytes()
    for _ in range(chance.choice([1, 1, 2])):
        data = chance.choice(MUTATIONS)(data, chance) or b"x"
    return data


def files_outside(server: Server) -> set[Path]:
    """What lies beside the data folder, where the server runs and has its home."""
    return {
        path for path in server.folder.rglob("*")
        if server.data not in (path, *path.parents) and path != server.log
    }  # fmt: skip


def test_hundreds_of_files_that_are_nearly_programs_do_no_harm(service: Server) -> None:
    outside = files_outside(service)
    memory: list[float] = []
    taken = refused = 0
    with service.client() as client:
        for number in range(COUNT):
            answer = sent(client, mutated(number))
            taken, refused = taken + (answer == 201), refused + (answer != 201)
            if number + 1 in {COUNT // 2, COUNT}:
                memory.append(rss_mib(service.pid))
        assert client.get("/readyz").status_code == 200
    assert taken > 100
    assert refused > 100
    assert memory[1] < memory[0] + GROWTH
    assert files_outside(service) == outside
    known = {path.name for path in service.data.iterdir()}
    assert known <= {
        "programs", "files", "jobs", "machines", "materials", "runner.lock", "server.lock",
        "service.db", "service.db-wal", "service.db-shm", "knowledge.db", "knowledge.db-wal",
        "knowledge.db-shm", "metrics", "runs",
    }  # fmt: skip


def sent(client: httpx.Client, data: bytes) -> int:
    """Upload a file, ask for its findings if it was taken, and delete it."""
    answer = client.post("/v1/programs", content=data)
    assert answer.status_code in {201, 400, 413, 422}, answer.text
    if answer.status_code == 201:
        id = answer.json()["id"]
        findings = client.get(f"/v1/programs/{id}/findings")
        assert findings.status_code in {200, 422}, findings.text
        assert client.delete(f"/v1/programs/{id}").status_code == 204
    return answer.status_code
