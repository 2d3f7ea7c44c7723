"""The demo's humanoid: it stands on the ground and is pushed."""
