"""The wheel with the lowest versions of its dependencies that it allows: `python tools/lowest.py [WHEEL]`.

In an environment of its own, with the tests of the core and of what those extras do. Without a wheel, the one
in target/wheels is taken, which `make wheel-check` makes.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
EXTRAS = ("cli", "sim", "plot", "log")
# What these extras do, and the core.
TESTS = (
    *(
        "test_calibration_file.py",
        "test_edge_arrays.py",
        "test_isolator.py",
        "test_monitor.py",
    ),
    *(
        "test_log_text.py",
        "test_log_rosbag2.py",
        "test_observer.py",
        "test_particle_filter.py",
        "test_sim_runs.py",
    ),
)
# Its own dependencies have no upper bounds: older versions come with libraries that they cannot load.
NEWEST = {"pin"}
TOOLS = ("pytest>=9", "pytest-timeout>=2.3", "hypothesis>=6.100")


def main() -> int:
    """Installs, runs the tests, and returns their exit code."""
    wheels = [Path(given).resolve() for given in sys.argv[1:]] or list(
        (ROOT / "target" / "wheels").glob("*.whl")
    )
    if len(wheels) != 1:
        sys.exit("there must be one wheel: make wheel-check, or name it")
    pins = lowest()
    print("lowest:", ", ".join(pins))
    tests = [str(ROOT / "tests" / name) for name in TESTS if (ROOT / "tests" / name).exists()]
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        python = str(Path(folder) / "bin" / "python")
        constraints = Path(folder) / "lowest.txt"
        constraints.write_text("\n".join(pins) + "\n")
        install = [
            python,
            "-m",
            "pip",
            "install",
            "-q",
            "--disable-pip-version-check",
            "-c",
            str(constraints),
        ]
        subprocess.run([*install, f"{wheels[0]}[{','.join(EXTRAS)}]", *TOOLS], check=True)
        # Warnings of versions against each other are none of ours.
        options = [
            "-q",
            "-p",
            "no:cacheprovider",
            "--import-mode=append",
            "-W",
            "default::DeprecationWarning",
        ]
        command = [python, "-m", "pytest", *options, *tests]
        return subprocess.run(command, cwd=folder, check=False).returncode


def lowest() -> list[str]:
    """A pin for each dependency of the package and of the extras."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    project = text[text.index("[project]") : text.index("[dependency-groups]")]
    lines = [line for line in project.splitlines() if line.split(" = ")[0] in ("dependencies", *EXTRAS)]
    pairs = re.findall(r'"([\w.-]+)>=([\w.]+)"', " ".join(lines))
    return sorted({f"{name}=={version}" for name, version in pairs if name not in NEWEST})


if __name__ == "__main__":
    sys.exit(main())
