"""The shapes in a URDF link's <collision> or <visual> elements."""

from __future__ import annotations

from xml.etree.ElementTree import Element

import numpy as np

from ..errors import GeometryError
from .description import GeometryTuple
from .meshes import MeshFinder
from .xml_numbers import number_attribute, origin, parse_numbers, placement

_SHAPES = "mesh, box, cylinder, sphere, capsule"


def link_shapes(link: Element, name: str, role: str, meshes: MeshFinder) -> list[GeometryTuple]:
    """Every shape of `link` in the given role, "collision" or "visual"; `GeometryError` names the link."""
    shapes = []
    for element in link.findall(role):
        owner = f"link '{name}': <{role}>"
        geometry = element.find("geometry")
        if geometry is None or len(geometry) != 1:
            raise GeometryError(f"{owner} needs one <geometry> with one of {_SHAPES}")
        pose = placement(*origin(element, owner, GeometryError))
        shapes.append(_shape(geometry[0], name, owner, meshes)._replace(placement=pose))
    return shapes


def _shape(element: Element, link: str, owner: str, meshes: MeshFinder) -> GeometryTuple:
    def sizes(*names: str) -> tuple[float, ...]:
        values = tuple(number_attribute(element, name, owner, GeometryError) for name in names)
        return _positive(values, element.tag, owner)

    here = np.eye(4)
    match element.tag:
        case "mesh":
            return GeometryTuple("mesh_file", _mesh(element, link, owner, meshes), here)
        case "box":
            size = parse_numbers(element.get("size", ""), 3, f"{owner}: 'size' of <box>", GeometryError)
            return GeometryTuple("box", _positive(tuple(size), "box", owner), here)
        case "cylinder":
            return GeometryTuple("cylinder", sizes("radius", "length"), here)
        case "sphere":
            return GeometryTuple("sphere", sizes("radius"), here)
        case "capsule":
            return GeometryTuple("capsule", sizes("radius", "length"), here)
        case tag:
            raise GeometryError(f"{owner} has the unknown shape <{tag}>; supported: {_SHAPES}")


def _mesh(element: Element, link: str, owner: str, meshes: MeshFinder) -> tuple[str, np.ndarray]:
    filename = element.get("filename", "").strip()
    if not filename:
        raise GeometryError(f"{owner}: <mesh> needs the attribute 'filename'")
    scale = parse_numbers(element.get("scale", "1 1 1"), 3, f"{owner}: 'scale' of <mesh>", GeometryError)
    if 0.0 in scale:
        raise GeometryError(f"{owner}: 'scale' of <mesh> must not be zero, not '{element.get('scale')}'")
    return str(meshes.find(filename, link)), np.array(scale)


def _positive(values: tuple[float, ...], tag: str, owner: str) -> tuple[float, ...]:
    if min(values) <= 0.0:
        raise GeometryError(
            f"{owner}: the sizes of <{tag}> must be positive, not {', '.join(map(str, values))}"
        )
    return values
