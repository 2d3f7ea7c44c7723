"""Commands that hear Ctrl-C whatever the shell has told."""

# Shells let what runs in the background ignore Ctrl-C, and its children inherit that.
HEARS_CTRL_C = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from contactsense.cli.app import run
sys.exit(run(sys.argv[1:]))
"""
