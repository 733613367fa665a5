"""The verb ``verify``: the part that logged positions left, against the programmed one."""
