"""Configuration of the web processes: uvicorn whose faults are lines of the service's log."""

import uvicorn

from service import log_lines
from service.rest.settings import handed_on


class WebConfig(uvicorn.Config):
    """Configuration of uvicorn; each web process configures its log with it."""

    def configure_logging(self) -> None:
        """Send the log of this process to stderr, as the settings say that were handed on."""
        super().configure_logging()
        log_lines.configure(handed_on().level)
        log_lines.report_faults()

    def load(self) -> None:
        """Load the application; one of several processes logs why it cannot, and ends."""
        try:
            super().load()
        except Exception as error:
            if self.workers == 1:
                raise
            log_lines.tell_fault(error)
            raise SystemExit(log_lines.FAULTY) from None
