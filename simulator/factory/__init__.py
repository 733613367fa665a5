"""Virtual factory: machining cycles of parts, and the flow of batches through machines."""
