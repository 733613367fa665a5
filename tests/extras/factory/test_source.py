"""Shops of files, with the times of a request."""

from pathlib import Path

import pytest

from extras.factory.requests import ShopTimes
from extras.factory.shop_sources import chosen_shop, source_of_file
from stepnc_model.errors import StepNcError
from tests.extras.factory.shops import timed_file


def test_times_of_a_request_replace_those_of_the_file(tmp_path: Path) -> None:
    source = source_of_file(timed_file(tmp_path, hours=2.0))
    assert chosen_shop(source, ShopTimes()).duration == 7200.0
    shop = chosen_shop(source, ShopTimes(hours=5.0, warm_up_hours=1.0))
    assert (shop.duration, shop.warm_up) == (18_000.0, 3600.0)


def test_changes_are_made_before_the_shop_is_read(tmp_path: Path) -> None:
    source = source_of_file(timed_file(tmp_path))
    shop = chosen_shop(source, ShopTimes(), {"product[1].batch": 7.0})
    assert shop.products[0].batch == 7


def test_a_warm_up_leaves_some_time(tmp_path: Path) -> None:
    source = source_of_file(timed_file(tmp_path, hours=2.0))
    with pytest.raises(StepNcError, match=r"timed\.toml: warm-up 2 h: it must be below 2 h"):
        chosen_shop(source, ShopTimes(warm_up_hours=2.0))
