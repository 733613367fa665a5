"""Virtual machine tool that runs programs and simulates its sensors; holds mutable state."""
