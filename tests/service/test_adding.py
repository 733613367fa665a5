"""A dialect, a machine and a limit are added in the files that CONTRIBUTING names, no other.

A verb is added by :mod:`tests.service.verbs.test_verb`.
"""

from collections.abc import Iterator
from enum import StrEnum
from pathlib import Path
from shutil import copytree
from typing import TypeVar

import pytest

import stepnc
from optimiser.bounds import limits
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut
from optimiser.solver.problem import Limit, LimitName, Monomial
from service.verbs.result import Result
from simulator import library
from stepnc_model.post import dialects
from stepnc_model.post.dialect import SUFFIXES, Dialect
from stepnc_model.post.fanuc import Fanuc

E = TypeVar("E", bound=StrEnum)

PART = Path("examples/parts/paper002.stpnc").resolve()


def added(kind: type[E], value: str, patch: pytest.MonkeyPatch) -> E:
    """Member that stands in an enumeration as if it were written there."""
    member = str.__new__(kind, value)
    member._name_, member._value_ = value.upper(), value
    patch.setitem(kind._member_map_, member._name_, member)
    patch.setitem(kind._value2member_map_, value, member)
    patch.setattr(kind, "_member_names_", [*kind._member_names_, member._name_])
    return member


class Okuma(Fanuc):
    """A control whose programs begin with the name of their file."""

    def start(self, name: str) -> Iterator[str]:
        yield "$PART.MIN%"
        yield from list(super().start(name))[1:]


def test_a_dialect_is_a_name_and_a_writer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    okuma = added(Dialect, "okuma", monkeypatch)
    monkeypatch.setitem(SUFFIXES, okuma, ".min")
    monkeypatch.setitem(dialects.WRITERS, okuma, Okuma)
    monkeypatch.setitem(dialects.PLACES, okuma, 3)
    output = tmp_path / "part.min"
    stepnc.post(PART, control="okuma", output=output)  # type: ignore[arg-type]
    stepnc.post(PART, control="fanuc", output=tmp_path / "part.nc")
    first, *lines = output.read_text("ascii").splitlines()
    assert first == "$PART.MIN%"
    assert lines == (tmp_path / "part.nc").read_text("ascii").splitlines()[1:]


def test_a_machine_is_one_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = copytree(library.DATA, tmp_path / "data")
    text = (data / "machines" / "vmc15.toml").read_text("utf-8")
    weak = text.replace("max_cutting_force_n = 8_000", "max_cutting_force_n = 500")
    (data / "machines" / "weak9.toml").write_text(weak, "utf-8")
    monkeypatch.setattr(library, "DATA", data)
    assert "weak9" in stepnc.machines().to_pandas()["name"].to_list()
    plan = stepnc.optimise(PART, machine="weak9", material="c45", dry_run=True)
    assert plan.record()["machine"] == "weak9"
    assert plan.record()["workingsteps"][0]["active_limit"] == "cutting_force"


def test_a_limit_is_a_name_a_load_and_a_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    def feed(plan: Result) -> float:
        return float(plan.record()["workingsteps"][0]["advised"]["feed_mm_min"])

    free = stepnc.optimise(PART, machine="vmc15", material="c45", dry_run=True)
    name, usual = added(LimitName, "removal_rate", monkeypatch), limits.allowance_limits

    def with_removal_rate(cut: Cut, at: CuttingConditions) -> Iterator[Limit]:
        yield from usual(cut, at)
        load = Monomial(
            coefficient=cut.radial_width * cut.tool.teeth,
            feed_exponent=1.0,
            depth_exponent=1.0,
            speed_exponent=1.0,
        )
        yield Limit(name=name, load=load, bound=100.0, unit="mm³/s")

    monkeypatch.setattr(limits, "allowance_limits", with_removal_rate)
    held = stepnc.optimise(PART, machine="vmc15", material="c45", dry_run=True)
    row = held.record()["workingsteps"][0]
    assert row["active_limit"] == "removal_rate"
    assert feed(held) < feed(free)
    assert "removal rate" in str(held)
