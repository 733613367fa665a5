"""Background jobs, each in its own process: queue, progress, cancellation, result."""
