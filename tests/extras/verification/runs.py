"""Logs of the bracket, shared by the tests of a module."""

from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.verification import BRACKET, FAST, SHAFT, SHAFT_REQUEST, SLOW, RunLog, run_log
from extras.verification.preparation import PreparedProgram, prepared
from extras.verification.requests import VerificationRequest
from extras.verification.run import Verification, verified

REQUEST = VerificationRequest(machine="vmc15", cell_mm=0.5)


@cache
def program() -> PreparedProgram:
    return prepared(BRACKET, REQUEST)


@cache
def slow_log() -> RunLog:
    """100 Hz, at most 250 mm/min."""
    return run_log(program(), rate=100.0, feed=lambda speed: np.minimum(speed, SLOW))


@cache
def fast_log() -> RunLog:
    """10 Hz, 1000 mm/min."""
    return run_log(program(), rate=10.0, feed=lambda speed: np.full_like(speed, FAST))


@cache
def shaft() -> PreparedProgram:
    return prepared(SHAFT, SHAFT_REQUEST)


@cache
def shaft_log() -> RunLog:
    return run_log(shaft(), rate=100.0, feed=lambda speed: np.minimum(speed, SLOW))


def clean(folder: Path) -> Verification:
    return verified(fast_log().write(folder / "log.parquet", program()), program(), REQUEST)
