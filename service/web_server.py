"""Web server that the first signal ends in order, within the time for open requests."""

from types import FrameType

from uvicorn.server import Server


class WebServer(Server):
    """Server of uvicorn that ignores all signals but the first. Running state.

    Launchers pass on what the terminal has sent to all, and uvicorn would break off its
    application at a second SIGINT, whose traceback it logs.
    """

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Begin to end."""
        if not self.should_exit:
            super().handle_exit(sig, frame)
