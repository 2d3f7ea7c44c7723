"""What `import contactsense` brings along."""

import subprocess
import sys


def test_importing_brings_numpy_and_pinocchio_and_little_else():
    script = """
import sys, numpy, pinocchio
before = set(sys.modules)
import contactsense
print(*sorted(set(sys.modules) - before))
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=120
    )
    added = done.stdout.split()
    heavy = {
        "matplotlib",
        "mujoco",
        "rich",
        "typer",
        "scipy",
        "example_robot_data",
        "multiprocessing",
        "asyncio",
    }
    assert not heavy & {name.split(".")[0] for name in added}
    # Modules take a millisecond or so each.
    assert len(added) <= 60, added
