"""Golden data for the Rust tests: contacts, dynamics and filter runs, made without contactsense.

Pinocchio makes kinematics and dynamics, trimesh says what a line meets and which point is nearest. Run it
from the root of the repository, with the dependency group `bench` installed: `python -m tools.golden`.
"""
