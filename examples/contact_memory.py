"""An arm without a camera learns where a wall is: from contacts, and from the space that it moves through.

A planner then asks which places are free, which are occupied, and of which nothing is known.
"""

import numpy as np

import contactsense as cs

WALL = 0.55  # the plane x = WALL is the front of a wall [m]

robot = cs.Robot.named("iiwa14")
memory = cs.ContactMemory(robot, resolution=0.03, prior=0.2)

# Contact-free motion: the space that the body has swept is free.
memory.add_free(np.linspace(robot.neutral(), [0.0, 0.4, 0.0, -1.0, 0.0, 0.6, 0.0], 15))

# Contacts with the wall. On your robot they are contacts of a report, or estimates of a particle filter.
rng = np.random.default_rng(0)
for _ in range(25):
    point = np.array([WALL, rng.uniform(-0.15, 0.15), rng.uniform(0.5, 0.8)]) + 0.005 * rng.normal(size=3)
    memory.add_contact((point, [1.0, 0.0, 0.0], 0.005**2 * np.eye(3)))

centres, probabilities = memory.points()
occupied = centres[probabilities > 0.5]
print(f"{len(memory)} voxels known, {len(occupied)} of them rather occupied than free")
print(f"wall at x = {occupied[:, 0].mean():.2f} m, true front at {WALL:.2f} m")

lower, upper = memory.boxes(least=0.5)
print(f"{len(lower)} boxes for a planner")

places = {"in the arm's way": [0.0, 0.0, 0.4], "never seen": [-0.6, 0.0, 0.5]}
for name, place in places.items():
    free, known = memory.is_free([place])[0], memory.known([place])[0]
    print(
        f"{name}: free {free}, known {known}, occupied with probability {memory.probability([place])[0]:.2f}"
    )
