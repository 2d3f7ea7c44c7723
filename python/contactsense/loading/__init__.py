"""From a URDF or a Pinocchio model to the plain, checked arrays that the core takes."""
