"""Surfaces through the public API: watertight rays, closest points, samples, repair, bad meshes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from robots import BY_NAME, parameters

import contactsense as cs

URDF = """<robot name="block"><link name="base"/>
<link name="block"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
{collision}</link>
<joint name="turn" type="revolute"><parent link="base"/><child link="block"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="10" velocity="1"/></joint></robot>"""


def surface_of(folder: Path, geometry: str) -> tuple[cs.Surface, tuple[str, ...]]:
    path = folder / "block.urdf"
    path.write_text(URDF.format(collision=f"<collision><geometry>{geometry}</geometry></collision>"))
    robot = cs.Robot.from_urdf(path)
    return robot.surface("block"), robot.warnings


def icosphere(levels: int, bumps: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and outward triangles of a sphere of radius 1, perhaps with bumps."""
    golden = (1 + 5**0.5) / 2
    vertices = [
        np.array(v, dtype=float)
        for a in (-1, 1)
        for b in (-golden, golden)
        for v in ((0, a, b), (a, b, 0), (b, 0, a))
    ]
    points = np.array(vertices)
    close = np.linalg.norm(points[:, None] - points[None], axis=2)
    near = (close > 0) & (close < 2.1)
    faces = [
        (i, j, k)
        for i in range(12)
        for j in range(i + 1, 12)
        for k in range(j + 1, 12)
        if near[i, j] and near[j, k] and near[i, k]
    ]
    faces = [f if np.linalg.det(points[list(f)]) > 0 else (f[0], f[2], f[1]) for f in faces]
    verts = [p / np.linalg.norm(p) for p in points]
    for _ in range(levels):
        middle: dict[tuple[int, int], int] = {}

        def between(a: int, b: int, middle: dict[tuple[int, int], int] = middle) -> int:
            key = (min(a, b), max(a, b))
            if key not in middle:
                p = verts[a] + verts[b]
                verts.append(p / np.linalg.norm(p))
                middle[key] = len(verts) - 1
            return middle[key]

        finer = []
        for a, b, c in faces:
            ab, bc, ca = between(a, b), between(b, c), between(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    result = np.array(verts)
    result *= 1 + bumps * np.sin(5 * result[:, :1]) * np.cos(7 * result[:, 1:2])
    return result, np.array(faces)


def write_obj(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    lines = [f"v {x:.17g} {y:.17g} {z:.17g}" for x, y, z in vertices]
    path.write_text("\n".join(lines + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]) + "\n")


def mesh_surface(folder: Path, vertices: np.ndarray, faces: np.ndarray) -> tuple[cs.Surface, tuple[str, ...]]:
    write_obj(folder / "block.obj", vertices, faces)
    return surface_of(folder, '<mesh filename="block.obj"/>')


def random_directions(rng: np.random.Generator, count: int) -> np.ndarray:
    directions = rng.standard_normal((count, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def odd_counts(surface: cs.Surface, origins: np.ndarray, directions: np.ndarray) -> int:
    hits = surface.cast_rays(origins, directions)
    return int(np.sum(np.bincount(hits.ray, minlength=len(origins)) % 2))


@pytest.mark.parametrize("bumps", [0.0, 0.3])
def test_rays_of_a_closed_mesh_enter_as_often_as_they_leave(tmp_path: Path, bumps: float) -> None:
    vertices, faces = icosphere(4, bumps)
    surface, warnings = mesh_surface(tmp_path, 0.2 * vertices, faces)
    assert len(surface.triangles) == 5120
    assert surface.watertight
    assert warnings == ()
    rng = np.random.default_rng(0)
    v, t = surface.vertices, surface.triangles
    edges = t[rng.integers(len(t), size=1500)]
    aims = {
        "generic": rng.uniform(-0.2, 0.2, (1500, 3)),
        "vertices": v[rng.integers(len(v), size=1500)],
        "edge midpoints": 0.5 * (v[edges[:, 0]] + v[edges[:, 1]]),
    }
    for what, aim in aims.items():
        directions = random_directions(rng, 1500)
        assert odd_counts(surface, aim - 2.0 * directions, directions) == 0, what


@pytest.mark.parametrize("name", parameters(["panda", "iiwa14_mesh", "talos", "atlas_hull"]))
def test_rays_through_vertices_of_real_meshes(name: str) -> None:
    robot = BY_NAME[name].robot()
    rng = np.random.default_rng(1)
    checked = 0
    for link in robot.link_names:
        surface = robot.surface(link)
        if not surface.watertight:
            continue
        v, t = surface.vertices, surface.triangles
        corner = t[rng.integers(len(t), size=200)]
        for aim in (v[corner[:, 0]], 0.5 * (v[corner[:, 0]] + v[corner[:, 1]])):
            directions = random_directions(rng, 200)
            assert odd_counts(surface, aim - 5.0 * directions, directions) == 0, link
        checked += 1
    assert checked >= 5


def test_hits_are_sorted_and_on_the_surface(tmp_path: Path) -> None:
    surface, _ = mesh_surface(tmp_path, *icosphere(3, 0.3))
    rng = np.random.default_rng(2)
    origins, directions = rng.uniform(-0.5, 0.5, (300, 3)), 3.0 * random_directions(rng, 300)
    hits = surface.cast_rays(origins, directions)
    assert np.all(np.diff(hits.ray) >= 0)
    same = np.diff(hits.ray) == 0
    assert np.all(np.diff(hits.distance)[same] >= 0)
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    np.testing.assert_allclose(
        hits.point, origins[hits.ray] + hits.distance[:, None] * unit[hits.ray], atol=1e-12
    )
    np.testing.assert_allclose(surface.closest_points(hits.point).distances, 0.0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(hits.normal, axis=1), 1.0)


def test_closest_points_against_all_triangles(tmp_path: Path) -> None:
    vertices, faces = icosphere(2, 0.3)
    surface, _ = mesh_surface(tmp_path, vertices, faces)
    rng = np.random.default_rng(3)
    queries = rng.uniform(-1.5, 1.5, (200, 3))
    found = surface.closest_points(queries)
    # Dense barycentric samples of every triangle bound the distance from above, up to their spacing.
    n = 24
    u, w = np.array([(i / n, j / n) for i in range(n + 1) for j in range(n + 1 - i)]).T
    corners = surface.vertices[surface.triangles]
    dense = (
        (1 - u - w)[None, :, None] * corners[:, None, 0]
        + u[None, :, None] * corners[:, None, 1]
        + w[None, :, None] * corners[:, None, 2]
    ).reshape(-1, 3)
    brute = np.array([np.min(np.linalg.norm(dense - query, axis=1)) for query in queries])
    assert np.all(found.distances <= brute + 1e-12)
    assert np.all(found.distances >= brute - 0.03)
    np.testing.assert_allclose(np.linalg.norm(queries - found.points, axis=1), found.distances, atol=1e-12)
    on = surface.closest_points(found.points)
    np.testing.assert_allclose(on.distances, 0.0, atol=1e-12)


PRIMITIVES = {
    '<box size="0.2 0.4 0.6"/>': 2 * (0.08 + 0.12 + 0.24),
    '<sphere radius="0.3"/>': 4 * np.pi * 0.09,
    '<cylinder radius="0.1" length="0.5"/>': 2 * np.pi * 0.1 * 0.6,
    '<capsule radius="0.1" length="0.5"/>': 2 * np.pi * 0.1 * 0.5 + 4 * np.pi * 0.01,
}


@pytest.mark.parametrize("geometry", PRIMITIVES)
def test_primitives_are_exact(tmp_path: Path, geometry: str) -> None:
    surface, _ = surface_of(tmp_path, geometry)
    assert surface.area == pytest.approx(PRIMITIVES[geometry], rel=1e-12)
    assert surface.watertight
    samples = surface.sample(2000, seed=4)
    closest = surface.closest_points(samples.points)
    np.testing.assert_allclose(closest.distances, 0.0, atol=1e-14)
    hits = surface.cast_rays(samples.points + 2.0 * samples.normals, -samples.normals)
    first = np.unique(hits.ray, return_index=True)[1]
    assert len(first) == 2000
    np.testing.assert_allclose(hits.distance[first], 2.0, atol=1e-13)
    rng = np.random.default_rng(5)
    directions = random_directions(rng, 3000)
    assert odd_counts(surface, rng.uniform(-0.3, 0.3, (3000, 3)) - 3.0 * directions, directions) == 0
    # Uniform by area: the mean over octants is even (the shapes are symmetric).
    octants = np.bincount((samples.points > 0) @ [1, 2, 4], minlength=8)
    assert np.all(np.abs(octants - 250) < 5 * np.sqrt(250))


def test_samples_repeat_for_a_seed(tmp_path: Path) -> None:
    surface, _ = mesh_surface(tmp_path, *icosphere(1))
    np.testing.assert_array_equal(surface.sample(50, seed=7).points, surface.sample(50, seed=7).points)
    assert not np.array_equal(surface.sample(50, seed=7).points, surface.sample(50, seed=8).points)
    assert surface.sample(0).points.shape == (0, 3)


def test_repairs_are_reported(tmp_path: Path) -> None:
    vertices, faces = icosphere(1)
    inward, warnings = mesh_surface(tmp_path, vertices, faces[:, ::-1])
    assert any("inward" in text or "outward" in text for text in warnings)
    samples = inward.sample(100)
    assert np.all(np.sum(samples.normals * samples.points, axis=1) > 0)
    # A corner for every triangle, as STL has them: exact copies go without saying, near ones are told.
    soup = vertices[faces].reshape(-1, 3)
    soup[::2] += 1e-13
    doubled = np.vstack([np.arange(len(soup)).reshape(-1, 3), [[0, 0, 1]]])
    welded, warnings = mesh_surface(tmp_path, soup, doubled)
    assert len(welded.vertices) == len(vertices)
    assert any("duplicate" in text for text in warnings)
    assert any("degenerate" in text for text in warnings)
    opened, warnings = mesh_surface(tmp_path, vertices, faces[1:])
    assert not opened.watertight
    assert any("open" in text for text in warnings)


@pytest.mark.parametrize(
    ("text", "suffix"),
    [
        ("", ".obj"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", ".obj"),
        ("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", ".obj"),
        ("v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n", ".obj"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", ".obj"),
        ("solid empty\nendsolid empty\n", ".stl"),
        ("\0" * 40, ".stl"),
        ("<COLLADA/>", ".dae"),
        ("<COLLADA", ".dae"),
    ],
)
def test_bad_meshes_are_refused(tmp_path: Path, text: str, suffix: str) -> None:
    (tmp_path / f"bad{suffix}").write_text(text)
    with pytest.raises(cs.GeometryError, match="block"):
        surface_of(tmp_path, f'<mesh filename="bad{suffix}"/>')


@settings(max_examples=100, deadline=None)
@given(data=st.binary(max_size=400), suffix=st.sampled_from([".obj", ".stl", ".dae"]))
def test_noise_is_no_mesh(tmp_path_factory: pytest.TempPathFactory, data: bytes, suffix: str) -> None:
    folder = tmp_path_factory.mktemp("noise")
    (folder / f"bad{suffix}").write_bytes(data)
    with pytest.raises(cs.GeometryError):
        surface_of(folder, f'<mesh filename="bad{suffix}"/>')


@pytest.mark.parametrize(
    ("origins", "directions", "name"),
    [
        (np.zeros((2, 2)), np.ones((2, 3)), "origins"),
        (np.zeros((2, 3)), np.ones((3, 3)), "directions"),
        (np.full((2, 3), np.nan), np.ones((2, 3)), "origins"),
        (np.zeros((2, 3)), np.zeros((2, 3)), "directions"),
        ("a", np.ones((2, 3)), "origins"),
    ],
)
def test_bad_rays_are_named(tmp_path: Path, origins: object, directions: object, name: str) -> None:
    surface, _ = surface_of(tmp_path, '<sphere radius="0.3"/>')
    with pytest.raises(cs.InputError, match=name):
        surface.cast_rays(origins, directions)
    with pytest.raises(cs.InputError, match="points"):
        surface.closest_points(np.zeros((3, 4)))
    with pytest.raises(cs.InputError, match="points"):
        surface.closest_points([[0.0, 0.0, np.inf]])


def test_a_link_without_surface_says_so() -> None:
    robot = cs.Robot.named("iiwa14")
    with pytest.raises(cs.InputError, match="iiwa_link_7"):
        robot.surface("iiwa_link_ee")
    with pytest.raises(cs.InputError, match="iiwa_link_7"):
        robot.surface("nowhere")


@pytest.mark.parametrize("arguments", [{"n": -1}, {"n": 2.5}, {"n": 10**18}, {"n": 3, "seed": -1}])
def test_bad_sample_counts_are_named(tmp_path: Path, arguments: dict[str, object]) -> None:
    surface, _ = surface_of(tmp_path, '<sphere radius="0.3"/>')
    with pytest.raises(cs.InputError, match=list(arguments)[-1]):
        surface.sample(**arguments)


@settings(max_examples=200, deadline=None)
@given(
    origin=st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=3, max_size=3),
    direction=st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=3, max_size=3),
)
def test_any_finite_ray_has_an_answer(origin: list[float], direction: list[float]) -> None:
    surface = cs.Robot.named("iiwa14").surface("iiwa_link_3")
    sizes = [max(abs(x) for x in vector) for vector in (origin, direction)]
    if max(sizes) >= 1e60 or sizes[1] < np.finfo(float).tiny:
        with pytest.raises(cs.InputError, match=r"origins|directions"):
            surface.cast_rays(origin, direction)
        return
    hits = surface.cast_rays(origin, direction)
    assert np.isfinite(hits.point).all()
    assert np.isfinite(surface.closest_points(origin).points).all()


@pytest.mark.parametrize("thickness", [1e-3, 1e-5])
def test_closest_points_of_slivers(tmp_path: Path, thickness: float) -> None:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, thickness)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([f for a, b, c, d in quads for f in ((a, b, c), (a, c, d))])
    surface, _ = mesh_surface(tmp_path, corners, faces)
    v = surface.vertices  # OBJ numbers are read in single precision
    rng = np.random.default_rng(6)
    weights = rng.dirichlet(np.ones(3), size=(len(surface.triangles), 50))
    on_surface = np.einsum("tkc,tcx->tkx", weights, v[surface.triangles]).reshape(-1, 3)
    assert surface.closest_points(on_surface).distances.max() < 1e-9 * thickness / 1e-5


def test_deeply_nested_collada_is_refused(tmp_path: Path) -> None:
    (tmp_path / "deep.dae").write_text("<COLLADA>" * 100_000 + "</COLLADA>" * 100_000)
    with pytest.raises(cs.GeometryError, match="nested"):
        surface_of(tmp_path, '<mesh filename="deep.dae"/>')
