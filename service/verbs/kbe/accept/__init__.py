"""Accept corrections, which the next plans apply."""
