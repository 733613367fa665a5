"""Configuration of the web processes: uvicorn whose faults are lines of the service's log."""

import signal

import uvicorn

from service.processes import log_lines
from service.rest.settings import handed_on


class WebConfig(uvicorn.Config):
    """Configuration of uvicorn; each web process configures its log with it."""

    def configure_logging(self) -> None:
        """Send the log of this process to stderr, as the settings say that were handed on."""
        super().configure_logging()
        log_lines.configure(handed_on().level)
        log_lines.report_faults()

    def load(self) -> None:
        """Load the application; one of several processes logs why it cannot, and ends.

        As it serves nobody yet, it ends at once when it is told to; uvicorn would load first.
        """
        if self.workers == 1:
            super().load()
            return
        handler = signal.signal(signal.SIGTERM, signal.SIG_DFL)
        try:
            super().load()
        except Exception as error:
            log_lines.tell_fault(error)
            raise SystemExit(log_lines.FAULTY) from None
        finally:
            signal.signal(signal.SIGTERM, handler)
