"""How many small motions in contact it takes to locate it: chosen by `next_motion`, or at random."""
