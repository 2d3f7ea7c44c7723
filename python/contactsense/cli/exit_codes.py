"""How commands end, beside 0 (all is well), 1 (no output) and 2 (an error of the user's)."""

INTERRUPTED = 130  # as shells give to what Ctrl-C ended
DAMAGED = 3  # a log is broken; what could be read of it was used
FAILED = 4  # some of many logs could not be replayed; the others were
