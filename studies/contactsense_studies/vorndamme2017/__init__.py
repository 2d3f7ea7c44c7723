"""The experiments of Vorndamme 2017, section VI, on the packaged Atlas: one, two, five contacts at once."""
