"""Small URDF texts for the loader's tests."""

from pathlib import Path

SOLID = (
    '<inertial><origin xyz="0 0 0.1"/><mass value="1"/>'
    '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>'
)


def link(name: str, inside: str = SOLID) -> str:
    return f'<link name="{name}">{inside}</link>'


def joint(name: str, parent: str, child: str, kind: str = "revolute", inside: str | None = None) -> str:
    if inside is None:
        inside = '<axis xyz="0 1 0"/><limit lower="-1" upper="2" effort="30" velocity="3"/>'
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0 0 0.3" rpy="0.1 0.2 0.3"/>{inside}</joint>'
    )


def shape(inside: str, role: str = "collision") -> str:
    return f'<{role}><origin xyz="0 0 0.1" rpy="0 0.5 0"/><geometry>{inside}</geometry></{role}>'


def robot(*parts: str) -> str:
    return f'<?xml version="1.0"?><robot name="arm">{"".join(parts)}</robot>'


ARM = robot(
    link("base"),
    link("upper", SOLID + shape('<box size="0.1 0.2 0.3"/>')),
    link("lower", SOLID + shape('<cylinder radius="0.05" length="0.3"/>') + shape('<sphere radius="0.1"/>')),
    link("tool", shape('<capsule radius="0.02" length="0.1"/>')),
    link("slide"),
    joint("shoulder", "base", "upper"),
    joint("elbow", "upper", "lower", "continuous", '<axis xyz="0 0.6 0.8"/>'),
    joint("flange", "lower", "tool", "fixed", ""),
    joint("rail", "tool", "slide", "prismatic"),
)


def write(folder: Path, text: str | bytes, name: str = "arm.urdf") -> Path:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path
