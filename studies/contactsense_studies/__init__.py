"""Experiments with contactsense that anyone can repeat: `contactsense study NAME`."""
