"""Virtual factory: machines that live in states, batches, buffers, crews and energy."""
