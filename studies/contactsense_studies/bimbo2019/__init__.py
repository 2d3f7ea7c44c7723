"""The experiments of Bimbo 2019 in simulation: contacts on an arm, located by a particle filter."""
