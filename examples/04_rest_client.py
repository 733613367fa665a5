"""A client of the service in sixty lines: upload, ask for feeds, look one up, download, watch.

Start ``stepnc serve`` first, then ``python examples/04_rest_client.py [URL] [KEY]``. It needs
the standard library only: any language with HTTP and JSON does it the same way.
"""

import json
import sys
import urllib.request
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any

PART = Path(__file__).parent / "parts" / "paper002.stpnc"
URL = sys.argv[1] if len(sys.argv) > 1 else "http://127.0.0.1:8000"
KEY = sys.argv[2] if len(sys.argv) > 2 else ""


def ask(method: str, path: str, body: bytes | None = None) -> Any:
    """Send a request; a POST that is sent again makes nothing twice."""
    headers = {"idempotency-key": str(uuid.uuid4()), "content-type": "application/json"}
    if KEY:
        headers["authorization"] = f"Bearer {KEY}"
    request = urllib.request.Request(URL + path, data=body, headers=headers, method=method)
    return urllib.request.urlopen(request, timeout=60.0)


def post(path: str, **asked: object) -> dict[str, Any]:
    return json.load(ask("POST", path, json.dumps(asked).encode()))


def get(path: str) -> dict[str, Any]:
    return json.load(ask("GET", path))


def events(path: str) -> Iterator[tuple[str, Any]]:
    """Server-sent events: a line with the name, a line with JSON."""
    name = ""
    for line in ask("GET", path):
        field, _, value = line.decode().rstrip("\n").partition(": ")
        name = value if field == "event" else name
        if field == "data":
            yield name, json.loads(value)


program = json.load(ask("POST", f"/v1/programs?name={PART.name}", PART.read_bytes()))
job = post(f"/v1/programs/{program['id']}/advice", mode="TC", machine="vmc15", material="c45")
list(events(f"/v1/jobs/{job['id']}/events"))  # until it is over
step = get(f"/v1/advice/{job['id']}")["workingsteps"][0]
advised = get(f"/v1/advice/{job['id']}/workingsteps/{step['instance'].removeprefix('#')}")
print(f"{advised['id']}: {advised['advised']['feed_mm_min']:.1f} mm/min, {advised['reason']}")
optimised = ask("GET", f"/v1/advice/{job['id']}/file").read()
print(f"optimised program: {len(optimised)} bytes, was {program['size_bytes']}")
run = post("/v1/simulations", advice_id=job["id"], machine="vmc15", material="c45")
told = [name for name, _ in events(f"/v1/jobs/{run['id']}/events")]
total = get(f"/v1/simulations/{run['id']}")["total"]
energy = total["energy_j"]["total"] / 1e3
print(f"simulated: {total['time_s']:.1f} s, {energy:.1f} kJ, told in {len(told)} events")
