"""Closest points, ray casting and samples on the surface of a link, in the link frame."""

import numpy as np

import contactsense as cs

robot = cs.Robot.named("iiwa14")
link = "iiwa_link_4"
surface = robot.surface(link)
print(f"{link}: {surface.area:.3f} m^2, watertight: {surface.watertight}")

# Points in the world frame must be transformed to the link frame first.
q = robot.neutral()
pose = robot.link_pose(q, link)
world = np.array([[0.3, 0.0, 0.8], [0.0, -0.4, 0.75]])
nearest = surface.closest_points((world - pose[:3, 3]) @ pose[:3, :3])
for distance, point in zip(nearest.distances, nearest.points @ pose[:3, :3].T + pose[:3, 3], strict=True):
    print(f"{distance:.3f} m from the surface, closest point {np.round(point, 3)}")

# All intersections in their order along each ray; `ray` is the index of the ray.
hits = surface.cast_rays([[0.5, 0.0, 0.0], [0.5, 1.0, 0.0]], [[-1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
for ray, distance, normal in zip(hits.ray, hits.distance, hits.normal, strict=True):
    print(f"ray {ray}: {'in' if normal[0] > 0 else 'out'} after {distance:.3f} m")

# Samples are uniform by area over the outside. The same seed gives the same points.
samples = surface.sample(1000, seed=1)
reach = np.linalg.norm(samples.points, axis=1).max()
print(f"{len(samples.points)} samples, at most {reach:.3f} m from the origin of the link")
