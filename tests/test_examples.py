"""The examples and the snippets of the README and the pages run; links and named functions exist."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tools.doc_pages import blocks, differences, run_page

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
SNIPPET = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\((?!https?://)([^)#]+)(?:#[^)]*)?\)")
SECTION_LINK = re.compile(r"\]\((?!https?://)([^)#]*)#([^)]+)\)")
HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)
OWN_LINK = re.compile(
    r"https://(?:github\.com/contactsense/contactsense/(?:blob|tree)|raw\.githubusercontent\.com/contactsense/contactsense)/main/([^)#\s]+)"
)
FUNCTION = re.compile(r"`([\w/]+\.rs)::(\w+)`")

# A pattern that the output of each example must match.
FINDINGS = {
    "calibrate_then_detect.py": (
        r"without.* 9\d % of the time\nwith.*: 2 contacts, \d % of the time\n"
        r"push on iiwa_link_5.* ms, iiwa_link_5 .*\n.*\n"
        r"push on iiwa_link_7.* ms, iiwa_link_7 .*, located: True\n  4\d N;.* error [01]\."
    ),
    "classify_and_react.py": (
        r"^wall: clamped \d\d%, intended \d\d?%; retract; [34]\d N at most, \d N at the end\n"
        r"ball: transient \d\d%, intended \d\d?%; stop; 1\d N at most, 0 N at the end\n"
        r"person: sustained \d\d%, intended \d\d%; give way; 30 N at most, 0 N at the end\n$"
    ),
    "control_loop.py": r"(like: .* 1 to \d\d ms, 0 false contacts\n  onset [23]\d ms (.*\n){2}(fri-|$)){2}",
    "explore_a_touch.py": r"_4, 1\d\.\d N\nphysics: 201 samples(.|\n)* 0\.[0-3]\d Nm(.|\n)*within \d mm",
    "first_contact.py": r"at 1\.50\d s\niiwa_link_6, point \[0\.52 0\.01 0\.6 *\] .* \d\.\d cm, (39|4[01]) N",
    "humanoid_with_sensors.py": (
        r"^contact detected \d\d ms .*\n  utorso, .*\n  total force 5[5-9] N, true force 57 N, .* 1[67].. N\n"
        r"contact detected \d\d ms .*\n  l_hand, located: True, by l_hand\n  total force (3[789]|40) N, .*\n$"
    ),
    "contact_memory.py": (
        r"^2\d{3} voxels known, [1-4]\d of them .*\nwall at x = 0\.5[5-8] m, .*\n\d+ boxes .*\n"
        r".*way: free True, known True, .* 0\.01\nnever seen: free False, known False, .* 0\.20\n$"
    ),
    "mujoco_truth.py": (
        r"^0\.5 s: 0 contacts\n  truth    \[0\. 0\. 0\. (.|\n)*1\.4 s: [1-9] contacts(.|\n)*"
        r"torque 1[3-7]\d Nm, mean error 0\.[01]\d\d Nm, "
    ),
    "next_motion.py": (
        r"^motion 1: expected (.|\n)*motion 3: .* error 0\.\d cm, force [1-5]?\d N\n"
        r"iiwa_link_4: ambiguous: False\n$"
    ),
    "own_robot.py": r"warning: .*'elbow'(.|\n)*warning: .*'lower'(.|\n)*refused: link 'upper'",
    "particle_filter_near_the_base.py": (
        r"^0\.0 s: \+- [23]\d cm, (.*\n){3}6\.0 s: \+- \d cm, \{'iiwa_link_2': 0\.[5-9].*\n"
        r"iiwa_link_2: error [0-4]\.\d cm, in the 90 % region: True\nforce (2[89]|3[01]) N, true force 30 N\n"
    ),
    "reaction.py": (
        r"no reaction: 2\d\d N .*\nstop: 2\d N at most, [3-5]\.\d N at the end\n"
        r"retract: 2\d N at most, 0\.\d N at the end\nadmittance: 2\d N at most, [01]\.\d N at the end\n"
    ),
    "replay_a_log.py": (
        r"1400 rows(.|\n)*differences of positions\n"
        r"contact from 3\.0\d to 3\.5\d s: iiwa_link_7, 3[0-4] N, point .*\n"
        r"contact from 5\.0\d to 5\.5\d s: iiwa_link_7, 3[0-4] N, point .*\n"
        r".* 5\.\d\d s\n.*\ncontacts.parquet: 2 rows, \d+ columns\nticks.parquet: 1400 rows"
    ),
    "surface_queries.py": r"watertight: True(.|\n)*ray 0: in .*\nray 0: out .*\n1000 samples",
    "touch_in_simulation.py": r"detected [1-9] ms (.|\n)*iiwa_link_7, located: True\npoint error: [0-4]\.",
    "touch_on_a_log.py": r"from 2\.0.*iiwa_link_7, 3[012] N.*\n.*from 4\.0.*iiwa_link_7, 3[012] N.*\n$",
    "ur_with_currents.py": (
        r"current from 'actual_current_0'(.|\n)*\nCoulomb friction \[ *(9|1\d)\.(.|\n)*"
        r"without.* (100|9\d) % of the time\nwith.*: 2 contacts, 1[01] % of the time\n"
        r"contact at 5\.0\d s: elbow_link .*\ncontact at 11.* wrist_3_link .* 6\d N, point within [1-4] cm"
    ),
}


def run(*arguments: str, folder: Path) -> str:
    """Runs Python with warnings as errors, in an empty folder; what it prints."""
    command = [sys.executable, "-W", "error", *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout


def test_every_example_has_findings() -> None:
    assert [path.name for path in EXAMPLES] == sorted(FINDINGS)


def test_the_page_of_examples_lists_all() -> None:
    page = (ROOT / "docs" / "examples.md").read_text(encoding="utf-8")
    notebooks = [path.name for path in (ROOT / "examples").glob("*.ipynb")]
    listed = re.findall(r"^\| \[(\w+\.(?:py|ipynb))\]", page, re.MULTILINE)
    assert sorted(listed) == sorted([*FINDINGS, *notebooks])


def test_the_notebook_runs_and_prints_what_is_saved() -> None:
    pytest.importorskip("mujoco")
    # In a process of its own, whose warnings are not ours.
    command = [sys.executable, "-m", "tools.notebook", "--check"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_example_runs(path: Path, tmp_path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    for word, package in (("sim", "mujoco"), ("to_parquet", "pyarrow")):
        if re.search(rf"\b{word}\b", text):
            pytest.importorskip(package)
    printed = run(str(path), folder=tmp_path)
    assert re.search(FINDINGS[path.name], printed), printed
    assert list(tmp_path.iterdir()) == []


def test_readme_snippet_finds_the_contact(tmp_path: Path) -> None:
    (snippet,) = SNIPPET.findall(PAGES[0].read_text(encoding="utf-8"))
    printed = run("-c", snippet, folder=tmp_path)
    assert re.search(
        r"^contact detected at 0\.50\d s\niiwa_link_6 \[0\.51\d* +0\.01\d* +0\.60\d*\]", printed
    ), printed


@pytest.mark.parametrize(
    "page",
    [page for page in PAGES[1:] if SNIPPET.search(page.read_text(encoding="utf-8"))],
    ids=lambda page: page.stem,
)
def test_page_snippets_run(page: Path, tmp_path: Path) -> None:
    """And print what the page says."""
    text = page.read_text(encoding="utf-8")
    for import_, package in (("from contactsense import sim", "mujoco"), ("import zenoh", "zenoh")):
        if import_ in text:
            pytest.importorskip(package)
    for block, printed in zip(blocks(page), run_page(page, tmp_path), strict=True):
        if block.stated is not None:
            assert differences(block.stated, printed) == [], printed


def test_the_node_of_ros_publishes_the_force(tmp_path: Path) -> None:
    (printed,) = run_page(ROOT / "docs" / "how_to" / "ros2.md", tmp_path)
    assert re.search(r"^info: contact at .*\n4[5-9]\d messages published\nlast force \[3[789]\.", printed)
    force = [float(number) for number in re.findall(r"-?\d+\.", printed.rsplit("force", 1)[1])]
    assert np.abs(np.subtract(force, [38.0, 0.0, 13.0])).max() < 3.0


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CONTRIBUTING.md"], ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    missing = [link for link in LINK.findall(text) if not (page.parent / link).exists()]
    missing += [link for link in OWN_LINK.findall(text) if not (ROOT / link).exists()]
    missing += [
        f"{link}#{section}"
        for link, section in SECTION_LINK.findall(text)
        if section not in sections(page.parent / link if link else page)
    ]
    assert missing == []


def sections(page: Path) -> list[str]:
    """The names by which links reach the sections of a page."""
    headings = HEADING.findall(page.read_text(encoding="utf-8"))
    return [re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-") for heading in headings]


def test_readme_links_work_outside_the_repository() -> None:
    """The package index shows the README, where a relative link leads nowhere."""
    assert LINK.findall(PAGES[0].read_text(encoding="utf-8")) == []


def test_equations_name_functions_that_exist() -> None:
    named = FUNCTION.findall((ROOT / "docs" / "equations.md").read_text(encoding="utf-8"))
    assert len(named) > 10
    for file, function in named:
        code = (ROOT / "rust" / "core" / "src" / file).read_text(encoding="utf-8")
        assert re.search(rf"\bfn {function}\b", code), f"{file} has no function {function}"
