"""Response bodies of runs of shops, and of the sample shops."""

from pydantic import Field

from service.rest.views import View


class SampleShopView(View):
    """Sample shop."""

    name: str
    title: str
    text: str = Field(description="content of the shop file, TOML")


class MachineStatesView(View):
    """States of a machine, one after another without gaps."""

    name: str
    state: list[str]
    begin_s: list[float]
    end_s: list[float]


class StatesView(View):
    """States of the machines of a live shop over a time range."""

    begin_s: float
    end_s: float
    machines: list[MachineStatesView]
