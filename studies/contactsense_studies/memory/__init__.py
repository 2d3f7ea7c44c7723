"""Contacts on a moving arm, located by what forgets, what remembers, and what sees one pose."""
