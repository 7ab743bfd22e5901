"""The value that `tsc live` shows before those of its variables, and that no program shows."""

MARK = -(2**31)  # the smallest number there is
