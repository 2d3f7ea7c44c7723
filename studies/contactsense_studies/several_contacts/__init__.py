"""Contacts at the same time, located together."""
