"""What is odd in a URDF though usable: one warning per concern."""

from __future__ import annotations

import math

from .description import name_list
from .urdf_tree import UrdfTree


def oddities(tree: UrdfTree) -> list[str]:
    """Warnings that name the joints and links concerned and say what is done about them."""
    mimics = [f"'{joint.name}' ('{joint.mimics}')" for joint in tree.moving if joint.mimics is not None]
    warnings = (
        [f"Joints that mimic another (kept as independent joints): {', '.join(mimics)}"] if mimics else []
    )
    concerns = {
        "The axes of these joints are not of unit length (normalised)": [
            joint.name for joint in tree.moving if abs(math.hypot(*joint.axis) - 1.0) > 1e-3
        ],
        "The limits of these joints leave no range (kept as given)": [
            joint.name
            for joint in tree.moving
            if joint.kind != "continuous"
            and joint.limit is not None
            and joint.limit["lower"] >= joint.limit["upper"]
        ],
        "These links move with a joint but have no <inertial> (taken as massless)": _without_inertial(tree),
        "These links move with a joint but have zero mass (used as given)": _massless(tree),
    }
    return warnings + [f"{concern}: {name_list(names)}" for concern, names in concerns.items() if names]


def _without_inertial(tree: UrdfTree) -> list[str]:
    # Frames behind fixed joints rarely have one and need none.
    return [joint.child for joint in tree.moving if tree.links[joint.child].inertial is None]


def _massless(tree: UrdfTree) -> list[str]:
    links = [tree.links[joint.child] for joint in tree.moving]
    return [link.name for link in links if link.inertial is not None and link.inertial.mass == 0.0]
