"""Shops that clients ask for: names, and bounds."""

from pathlib import Path

import pytest

from extras.factory.requests import FactoryOrder
from extras.factory.shop_sources import checked_shop, sample_shops, source_of_order
from service.errors import NotFound, TooLarge, Unreadable
from service.storage import programs
from service.storage.folder import DataFolder, open_data_folder
from stepnc_model.errors import StepNcError
from tests.extras.factory.shops import PARTS, TIMED


@pytest.fixture
def data_folder(tmp_path: Path) -> DataFolder:
    return open_data_folder(tmp_path / "data")


def milled(program: str) -> str:
    return f"""
[[machine]]
name = "mill"
machine = "vmc15"
[[product]]
name = "part"
[[product.step]]
machines = ["mill"]
program = "{program}"
"""


def test_every_sample_shop_can_be_asked_for(data_folder: DataFolder) -> None:
    assert {"line", "paper003"} <= set(sample_shops())
    for name in sample_shops():
        order = FactoryOrder(sample=name)
        shop = checked_shop(source_of_order(data_folder, order), order)
        assert shop.machines


def test_a_program_is_a_sample_or_an_uploaded_one(data_folder: DataFolder) -> None:
    stored = programs.add(
        data_folder, (PARTS / "paper002.stpnc").read_bytes(), name="mine.stpnc", owner="anna"
    )
    for word, name in (
        (stored.id, "mine.stpnc"), ("bracket", "bracket.stpnc"),
        ("../parts/bracket.stpnc", "bracket.stpnc"),
    ):  # fmt: skip
        order = FactoryOrder(shop=milled(word))
        source = source_of_order(data_folder, order)
        step = checked_shop(source, order).products[0].steps[0]
        assert source.programs[step.program] == name


@pytest.mark.parametrize("word", ["/etc/passwd", "nothing.stpnc", "0" * 26, ".."])
def test_no_other_file_is_found(data_folder: DataFolder, word: str) -> None:
    order = FactoryOrder(shop=milled(word))
    with pytest.raises(NotFound):
        checked_shop(source_of_order(data_folder, order), order)


def test_messages_do_not_name_the_folder_of_samples(data_folder: DataFolder) -> None:
    order = FactoryOrder(sample="line")
    with pytest.raises(StepNcError) as caught:
        source_of_order(data_folder, order).read({"machine[9].count": 1.0})
    assert "line.toml" in str(caught.value)
    assert "examples" not in str(caught.value)


def test_a_live_shop_counts_from_its_beginning(data_folder: DataFolder) -> None:
    for order, warm_up in (
        (FactoryOrder(sample="line"), 16.0), (FactoryOrder(sample="line", pace=10.0), 0.0),
        (FactoryOrder(sample="line", pace=10.0, warm_up_hours=2.0), 2.0),
    ):  # fmt: skip
        assert (
            checked_shop(source_of_order(data_folder, order), order).warm_up == warm_up * 3600.0
        )


def test_one_shop_is_named(data_folder: DataFolder) -> None:
    for order in (FactoryOrder(), FactoryOrder(shop=TIMED.format(hours=1), sample="line")):
        with pytest.raises(Unreadable):
            source_of_order(data_folder, order)
    with pytest.raises(TooLarge):
        source_of_order(data_folder, FactoryOrder(shop="#" * 70_000))
