"""`python -m contactsense COMMAND`, the same as `contactsense COMMAND`."""

from .cli import main

main()
