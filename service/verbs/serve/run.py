"""The service, until it is stopped."""

from service.monitor.source import sources_of
from service.processes.process_limits import GIB
from service.progress import Tell, silent
from service.rest.serve import ServerOptions, serve
from service.rest.settings import MIB, Settings
from service.verbs.result import ServedResult
from service.verbs.serve.request import USUAL_RATE, ServeFiles, ServeRequest
from service.web.known_hosts import LOOPBACK
from stepnc_model.errors import StepNcError


def run(request: ServeRequest, files: ServeFiles, *, tell: Tell = silent) -> ServedResult:
    """Serve REST and the dashboard until told to stop.

    Raises
    ------
    StepNcError
        When the service cannot be started.
    """
    if (files.tls_cert is None) != (files.tls_key is None):
        raise StepNcError("--tls-cert and --tls-key must be given together")
    is_loopback = request.host in LOOPBACK
    usual_rate = 0.0 if is_loopback else USUAL_RATE
    settings = Settings(
        data=str(files.folder),
        knowledge=files.kb,
        database=files.database_url,
        files=files.files,
        host=request.host,
        port=request.port,
        names=request.names,
        agents=sources_of(request.agents),
        needs_keys=request.needs_keys or not is_loopback,
        upload_bytes=request.upload_mb * MIB,
        rate=usual_rate if request.rate is None else request.rate,
        level=request.log_level.value,
    )
    serve(
        ServerOptions(
            settings=settings,
            workers=request.workers,
            jobs=request.jobs,
            job_memory=request.job_memory_gb * GIB,
            certificate=files.tls_cert,
            key=files.tls_key,
        )
    )
    return ServedResult()
