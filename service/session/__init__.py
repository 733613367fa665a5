"""Live sessions, watched and changed as they go on: controlled runs and trial cuts."""
