"""Files of a verification without a program: logs, tool tables and required parts."""

from pathlib import Path

import numpy as np

from simulator.motion.segments import Floats

AXES = ",".join(f"{axis}_axis_position_actual" for axis in "xyz")


def write_stl(path: Path, triangles: Floats) -> Path:
    """Write triangles as a binary STL file."""
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    records = np.zeros(len(triangles), dtype=kind)
    records["corners"] = triangles
    path.write_bytes(bytes(80) + len(triangles).to_bytes(4, "little") + records.tobytes())
    return path


def write_log(path: Path, points: Floats, *, interval: float = 0.01) -> Path:
    """Write positions as CSV."""
    time = interval * np.arange(len(points))
    np.savetxt(
        path, np.column_stack([time, points]), fmt="%.6f", delimiter=",", comments="",
        header=f"time_s,{AXES}",
    )  # fmt: skip
    return path


def write_tools(path: Path, *rows: str) -> Path:
    """Write a tool table."""
    path.write_text("".join(f"[[tool]]\n{row}\n" for row in rows), encoding="utf-8")
    return path
