"""Contacts on simulated arms with the errors of real ones: what a calibration does for their detection."""
