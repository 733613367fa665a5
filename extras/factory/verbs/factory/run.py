"""Run of a shop: its figures, or live for clients."""

from dataclasses import fields

from extras.factory.requests import FactoryRequest, LiveFactoryRequest
from extras.factory.run import run_factory
from extras.factory.serve import serve_shop
from extras.factory.verbs.factory.request import FactoryFiles
from extras.factory.verbs.factory.result import ShopResult
from service.execution.pools import pools_of
from service.files import write_atomically
from service.progress import Tell, silent
from service.requests.fields import fields_of
from service.requests.kind_options import changed_values
from service.verbs.result import ServedResult
from stepnc_model.errors import StepNcError
from stepnc_model.plurals import counted

REPORT = "factory.html"
"""Name of the page in the folder."""


def run(
    request: LiveFactoryRequest, files: FactoryFiles, *, tell: Tell = silent
) -> ShopResult | ServedResult:
    """Run a shop, or serve it live until told to stop.

    Raises
    ------
    StepNcError
        When the file, a program or an option is invalid, or the machines wait for each other.
    """
    if request.is_live:
        if files.output is not None or files.has_report:
            raise StepNcError(
                "--live serves clients and writes nothing: leave out -o, --report"
            )
        serve_shop(files.shop, request, tell=tell)
        return ServedResult()
    _require_not_live(request)
    folder = files.output
    if folder is None and (files.has_report or request.documents or request.has_energy):
        raise StepNcError("--report, --documents and --energy write files: name a folder, -o")
    pools = pools_of(files.cluster)
    found = ShopResult(
        factory=run_factory(files.shop, request, folder=folder, pools=pools, tell=tell)
    )
    if folder is not None:
        tell(f"written: {folder} ({counted(found.factory.parts_written, 'part')})")
    if request.documents:
        tell(f"MTConnect documents: {found.factory.documents_written}")
    if folder is not None and files.has_report:
        write_atomically(folder / REPORT, found.page().encode())
        tell(f"report: {folder / REPORT}")
    return found


def _require_not_live(request: LiveFactoryRequest) -> None:
    """Refuse options that only a live shop uses."""
    flags = {each.name: each.about.flag for each in fields_of(LiveFactoryRequest)}
    for each in fields(FactoryRequest):
        flags.pop(each.name, None)
    for name in changed_values(request):
        if name in flags:
            raise StepNcError(f"{flags[name]} needs --live")
