"""The experiments of Bimbo 2019 in simulation: where on an arm is it touched, found by a particle filter."""
