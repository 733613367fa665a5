"""Requests of the commands: filled by the command line, validated by REST, stored with jobs."""
