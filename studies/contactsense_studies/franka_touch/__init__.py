"""Touches of a real Franka arm: are they felt, how soon, and on which link.

The logs are those of MindLabZHAW/tactileGestureDetection: the arm holds still while a person touches one
marked point about fifteen times; touches were labelled by hand. The letter of a file's name says the link.
"""
