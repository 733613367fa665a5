"""Programs with B-rep of their workpieces, from programs without and STEP files."""

import re
from pathlib import Path

OFFSET = 100_000
"""Added to the instance numbers of the solid."""


def solid_instances(path: Path) -> tuple[list[str], int]:
    """Renumbered instances of a STEP file, and the number of its shape representation."""
    text = re.sub(r"\n\s*", "", path.read_text("latin-1").partition("DATA;")[2])
    instances = [
        re.sub(r"#(\d+)", lambda found: f"#{int(found[1]) + OFFSET}", each) + ";"
        for each in text.partition("ENDSEC")[0].split(";")
        if "=" in each
    ]
    found = [each for each in instances if "ADVANCED_BREP_SHAPE_REPRESENTATION" in each]
    assert len(found) == 1
    return instances, int(found[0].partition(" ")[0][1:])


def with_instances(text: str, instances: list[str]) -> str:
    """Program with more instances at the end of its data."""
    head, mark, tail = text.rpartition("ENDSEC;")
    return head + "\n".join(instances) + "\n" + mark + tail
