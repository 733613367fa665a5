"""ISO 10303-21 clear text, ignorant of machining."""
