"""`python -m contactsense.cli`."""

from . import main

main()
