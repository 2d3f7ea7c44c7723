"""What `calibrate` finds of the known errors of simulated arms, and whether its uncertainty covers them."""
