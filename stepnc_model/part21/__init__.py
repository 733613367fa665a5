"""Reading and writing of ISO 10303-21 clear text, independent of machining."""
