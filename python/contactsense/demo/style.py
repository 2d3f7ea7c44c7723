"""Colours that stay apart for colour-blind eyes (Okabe and Ito 2008)."""

TRUTH = "#000000"
ESTIMATE = "#D55E00"
DETECTED = "#0072B2"
GREY = "#999999"
TEXT = "#444444"
BODY = "#C9CDD2"
NAMED = "#56B4E9"
WRONG = "#CC79A7"
# By joint, base to tip.
JOINTS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#8A8200")
