"""List the outcomes and corrections stored in a program file."""
