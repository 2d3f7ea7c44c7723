"""Builds the wheel and checks it: `python tools/wheels.py [--out FOLDER]`.

The wheel is that of manylinux2014 where Zig is there to link it (`pip install ziglang`). Checked are its
size, that it needs only what manylinux allows (auditwheel) and only the stable interface of Python
(abi3audit), and that it works in bare environments of each Python from 3.10 on that is found.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VERSIONS = ("3.10", "3.11", "3.12", "3.13", "3.14")
LARGEST = 10.0  # [MB]
OLDEST_LINUX = "manylinux2014"


def main() -> int:
    """Builds, checks, and says what was found."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=ROOT / "target" / "wheels", help="where the wheel goes")
    parser.add_argument("--wheel", type=Path, help="one that is built already")
    arguments = parser.parse_args()
    wheel = arguments.wheel or build(arguments.out)
    size = wheel.stat().st_size / 1e6
    print(f"{wheel.name}: {size:.1f} MB")
    if size > LARGEST:
        sys.exit(f"the wheel may have {LARGEST:.0f} MB at most")
    audit(wheel)
    checked = [version for version in VERSIONS if check(wheel, version)]
    if not checked:
        sys.exit(f"no Python of {', '.join(VERSIONS)} is there")
    print(f"works on Python {', '.join(checked)}")
    return 0


def build(out: Path) -> Path:
    """The wheel of this system, in a folder that holds no other."""
    shutil.rmtree(out, ignore_errors=True)
    command = [sys.executable, "-m", "maturin", "build", "--release", "--quiet", "--out", str(out)]
    if platform.system() == "Linux" and importlib.util.find_spec("ziglang"):
        command += ["--zig", "--compatibility", OLDEST_LINUX]
    # maturin looks for the Python that has Zig on the path.
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    subprocess.run(command, cwd=ROOT, check=True, env={**os.environ, "PATH": path})
    (wheel,) = out.glob("*.whl")
    return wheel


def audit(wheel: Path) -> None:
    """What the tools that are installed say of the wheel."""
    if platform.system() == "Linux" and importlib.util.find_spec("auditwheel"):
        command = [sys.executable, "-m", "auditwheel", "show", str(wheel)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        print(" ".join(done.stdout.split()))
    if importlib.util.find_spec("abi3audit"):
        subprocess.run([sys.executable, "-m", "abi3audit", "--strict", str(wheel)], check=True)


def check(wheel: Path, version: str) -> bool:
    """Whether this Python is there; the wheel works in an environment that holds nothing else."""
    own = version == f"{sys.version_info[0]}.{sys.version_info[1]}"
    python = sys.executable if own else shutil.which(f"python{version}")
    # A program of this name may stand for a version that is not installed.
    if python is None or subprocess.run([python, "-c", ""], capture_output=True, check=False).returncode:
        print(f"Python {version}: not there")
        return False
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([python, "-m", "venv", folder], check=True)
        bare = Path(folder) / "bin" / "python"
        install = [str(bare), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", str(wheel)]
        subprocess.run(install, check=True)
        print(f"Python {version}:", flush=True)
        subprocess.run([str(bare), "-I", str(ROOT / "tools" / "check_wheel.py")], check=True)
    return True


if __name__ == "__main__":
    sys.exit(main())
