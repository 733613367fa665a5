"""Drilling, boring, reaming and tapping: depths, feeds and moves of hole operations."""
