"""Contacts of simulated arms told apart: clamped, transient or sustained; intended or accidental."""
