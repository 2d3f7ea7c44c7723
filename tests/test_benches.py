"""The comparison with peers runs, its contestants agree, and its JSON says what it should."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import contactsense as cs

ROOT = Path(__file__).resolve().parents[1]
PEERS = ("trimesh", "embreex", "igl", "fcpw", "idyntree", "scipy", "rosbags", "mcap", "viser", "zenoh")
LEAST = {
    "observer": 2,
    "compensation": 2,
    "monitor": 6,
    "noisy": 12,
    "contact_map": 8,
    "closest": 2,
    "rays": 2,
    "particle_filter": 5,
    "sampler": 1,
    "log": 4,
    "view": 1,
    "bridge": 1,
    "c_interface": 1,
}


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "benches.compare", *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=540, check=False)


@pytest.fixture(scope="module")
def report() -> dict:
    absent = [name for name in PEERS if importlib.util.find_spec(name) is None]
    if absent:
        pytest.skip(f"{', '.join(absent)} not installed (dependency group `bench`)")
    if cs.build_profile != "release":
        pytest.skip("a debug build is not timed")
    done = run("--quick", "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize("name", sorted(LEAST))
def test_every_comparison_times_ours_beside_peers(report: dict, name: str) -> None:
    starts = {
        "observer": "observer",
        "compensation": "compensation",
        "monitor": "monitor",
        "noisy": "noisy tick",
        "contact_map": "contact map",
        "closest": "closest point",
        "rays": "all hits",
        "particle_filter": "particle filter",
        "sampler": "sampler",
        "log": "log, 12,000 JointStates",
        "view": "view",
        "bridge": "bridge",
        "c_interface": "tick of the C interface",
    }
    found = [c for c in report["comparisons"] if c["task"].startswith(starts[name])]
    assert len(found) >= LEAST[name]
    for comparison in found:
        ours, *peers = comparison["timings"]
        assert ours["name"].startswith("contactsense")
        assert ours["ratio"] == 1.0
        assert isinstance(comparison["passed"], bool)
        for timing in (ours, *peers):
            low, high = timing["spread_us"]
            assert 0.0 < low <= timing["median_us"] <= high
            assert np.isclose(timing["ratio"], timing["median_us"] / ours["median_us"])


def test_report_names_the_machine_and_versions(report: dict) -> None:
    assert {"cpu", "cores", "python", "numpy", "pin", "contactsense"} <= set(report["about"])


@pytest.mark.parametrize("name", ["observer", "compensation"])
def test_comparisons_without_the_peers_run(name: str) -> None:
    """What the other tests skip without the group `bench` runs here as far as it needs nothing of it."""
    if name == "compensation":
        pytest.importorskip("idyntree", reason="idyntree has wheels for Linux only")
    code = (
        "import sys, time\n"
        "for absent in ('trimesh', 'scipy', 'fcpw', 'igl', 'embreex'):\n"
        "    sys.modules[absent] = None\n"
        f"from benches.compare import {name}\n"
        "from benches.compare.timing import Pace\n"
        f"print(len({name}.compare(Pace(3, 0.002, 2, time.process_time))))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) >= LEAST[name]


def test_unknown_comparison_is_refused() -> None:
    done = run("nothing")
    assert done.returncode == 2
    names = "compensation, monitor, noisy, contact_map, closest, rays, particle_filter, log, view, bridge"
    assert names in done.stderr
