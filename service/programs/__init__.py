"""Programs as the user names them: reading, and what they lack."""
