"""The command line: help, errors, exit codes."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.metadata import requires, version
from pathlib import Path

import pytest

from contactsense import __version__
from contactsense._pictures import picture_file
from contactsense.cli.app import run
from contactsense_studies.bimbo2019.study import Trial

STUDY = ["study", "franka_touch"]


@pytest.mark.parametrize("command", [[], ["study"], STUDY])
def test_help(command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*command, "--help"]) == 0
    assert "Usage" in capsys.readouterr().out


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--version"]) == 0
    assert capsys.readouterr().out == f"contactsense {__version__}\n"


@pytest.mark.parametrize("arguments", [["nosuch"], ["study", "nosuch"], STUDY, [*STUDY, "--nosuch"]])
def test_wrong_command_line(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(arguments) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_an_error_is_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*STUDY, "--data", str(tmp_path / "absent")]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("contactsense: data: there is no folder")
    assert told.err.count("\n") == 1


@pytest.mark.parametrize(
    ("hidden", "arguments", "extra"),
    [
        ("typer", ["--help"], "contactsense[cli]"),
        ("rich", ["--help"], "contactsense[cli]"),
        ("matplotlib", [*STUDY, "--data", ".", "--png", "x.png"], "contactsense[plot]"),
        ("mujoco", ["study", "bimbo2019"], "contactsense[sim]"),
        ("mujoco", ["study", "vorndamme2017"], "contactsense[sim]"),
        ("mujoco", ["study", "single_contacts"], "contactsense[sim]"),
        ("mujoco", ["demo"], "contactsense[demo]"),
    ],
)
def test_a_missing_package_is_named(hidden: str, arguments: list[str], extra: str) -> None:
    hide = f"import sys; sys.modules[{hidden!r}] = None; from contactsense.cli import main; main()"
    ended = subprocess.run(
        [sys.executable, "-c", hide, *arguments], capture_output=True, text=True, timeout=60, check=False
    )
    assert ended.returncode == 2
    assert extra in ended.stderr
    assert "Traceback" not in ended.stderr


def test_a_study_without_the_studies_says_what_to_install() -> None:
    hide = (
        "import importlib.metadata as m; m.entry_points = lambda **_: ();"
        "from contactsense.cli import main; main()"
    )
    for arguments in (["study"], ["study", "bimbo2019", "--trials", "1"], ["study", "--help"]):
        ended = subprocess.run(
            [sys.executable, "-c", hide, *arguments], capture_output=True, text=True, timeout=60, check=False
        )
        assert ended.returncode == 2
        missing, remedy = ended.stderr.split("; ")
        assert missing == "contactsense: contactsense-studies is not installed"
        assert remedy == "get it with: pip install contactsense-studies\n"


def test_the_studies_have_the_version_of_the_package() -> None:
    assert version("contactsense-studies") == __version__
    assert f"contactsense[cli,plot,sim]=={__version__}" in (requires("contactsense-studies") or ())


LAYERS = {
    "python/contactsense/demo": ("contactsense_studies",),
    "studies": ("contactsense.demo",),
    "python/contactsense/sim": ("contactsense.demo", "contactsense_studies"),
    "docs": ("contactsense.demo", "contactsense_studies"),
    "examples": ("contactsense.demo", "contactsense_studies"),
}
ABOVE = (
    "test_calibration_recovery",
    "test_memory_study",
    "test_cli",
    "test_contact_classes_study",
    "test_demo",
    "test_bimbo2019",
    "test_franka_touch",
    "test_identifiability_study",
    "test_next_motion",
    "test_real_arm",
    "test_particle_filter_contacts",
    "test_several_contacts_study",
    "test_single_contacts",
    "test_vorndamme2017",
)


def test_what_lies_below_imports_nothing_above() -> None:
    """Demo and studies know nothing of each other; the library, its tests and its pages know neither."""
    root = Path(__file__).resolve().parents[1]
    forbidden = {
        file: names
        for folder, names in LAYERS.items()
        for file in (root / folder).rglob("*")
        if file.suffix in (".py", ".md")
    }
    forbidden |= {
        file: ("contactsense.demo", "contactsense_studies", "import demo")
        for file in (root / "tests").glob("*.py")
        if not file.stem.startswith(ABOVE)
    }
    for file, names in forbidden.items():
        imports = [line for line in file.read_text().splitlines() if "import" in line]
        assert not [line for line in imports for name in names if name in line], file


def test_single_contacts_prints_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["study", "single_contacts", "--robot", "iiwa14", "--points", "5", "--json"]) == 0
    results = {entry["link"]: entry for entry in json.loads(capsys.readouterr().out)}
    assert results["iiwa_link_7"]["outcomes"] == {"located": 5}
    assert results["iiwa_link_7"]["point_error_m"] < 1e-9


def test_single_contacts_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["study", "single_contacts", "--points", "2"]) == 0
    assert "l_hand" in capsys.readouterr().out


@pytest.mark.parametrize("options", [["--robot", "nowhere.urdf"], ["--points", "0"]])
def test_single_contacts_refuses(options: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["study", "single_contacts", *options]) == 2
    assert "contactsense:" in capsys.readouterr().err


@pytest.mark.parametrize(
    "study",
    [
        ["single_contacts", "--robot", "iiwa14", "--points", "1"],
        ["vorndamme2017", "--singles", "1", "--pairs", "1", "--fives", "1", "--hits", "1"],
        ["bimbo2019", "--trials", "1"],
    ],
)
def test_negative_seeds_are_refused(study: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["study", *study, "--seed", "-1"]) == 2
    assert capsys.readouterr().err.startswith("contactsense: seed: must not be negative")


def _refused_at_once(arguments: list[str], monkeypatch: pytest.MonkeyPatch) -> int:
    """The exit code of a command whose work must not begin."""

    def work(*_: object, **__: object) -> None:
        raise AssertionError("the work began")

    for module in (
        "contactsense.demo.command",
        "contactsense_studies.franka_touch.study",
        "contactsense_studies.vorndamme2017.study",
        "contactsense_studies.bimbo2019.study",
    ):
        monkeypatch.setattr(f"{module}.run", work)
    return run(arguments)


FOLDERS = [["study", name] for name in ("vorndamme2017", "bimbo2019")]


@pytest.mark.parametrize(
    ("command", "option"),
    [(["demo"], "out"), ([*STUDY, "--data", "."], "png"), *((folder, "png") for folder in FOLDERS)],
)
def test_where_pictures_go_is_checked_first(
    command: list[str],
    option: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "file.png").touch()
    if command in FOLDERS:
        targets = ["file.png", "file.png/folder"]
    else:
        (tmp_path / "folder").mkdir()
        targets = ["folder", "absent/a.png", "a.nosuch"]
    for target in targets:
        path = str(tmp_path / target)
        assert _refused_at_once([*command, f"--{option}", path], monkeypatch) == 2
        told = capsys.readouterr().err
        assert told.startswith(f"contactsense: {option}: ")
        assert path in told
        assert told.count("\n") == 1
    assert not (tmp_path / "folder.png").exists()


def test_a_picture_without_suffix_is_a_png(tmp_path: Path) -> None:
    assert picture_file("out", tmp_path / "a") == tmp_path / "a.png"
    assert picture_file("out", tmp_path / "a.svg") == tmp_path / "a.svg"


@pytest.mark.parametrize(
    "arguments",
    [["--help"], ["--version"], ["study", "single_contacts", "--robot", "iiwa14", "--points", "1"]],
)
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_output_is_a_line(arguments: list[str]) -> None:
    with open("/dev/full", "w") as full:
        ended = subprocess.run(
            [sys.executable, "-m", "contactsense", *arguments],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120,
            check=False,
        )
    assert ended.returncode == 1
    assert ended.stderr.startswith("contactsense: cannot write the output: ")
    assert ended.stderr.count("\n") == 1


def test_an_interrupt_is_a_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("contactsense_studies.single_contacts.run", interrupt)
    assert run(["study", "single_contacts", "--robot", "iiwa14"]) == 130
    assert capsys.readouterr().err == "contactsense: interrupted\n"


@pytest.mark.parametrize(
    ("study", "stage", "figures"),
    [
        ("vorndamme2017", "isolating", "--json"),
        ("vorndamme2017", "isolating", "One contact"),
        ("vorndamme2017", "impacts over time", "An impact of 20 ms"),
        ("bimbo2019", "trials", "--json"),
        ("bimbo2019", "trials", "estimate says of itself"),
    ],
)
def test_an_interrupted_study_shows_what_it_has(
    study: str,
    stage: str,
    figures: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Ctrl-C after the first results of a stage."""
    sizes = {
        "vorndamme2017": "--singles 2 --pairs 1 --fives 1 --hits 1",
        "bimbo2019": "--trials 2 --particles 50 --experiment random --link iiwa_link_7",
    }[study]

    @contextmanager
    def progress() -> Iterator[Callable[[str, int, int], None]]:
        def show(name: str, done: int, total: int) -> None:
            if name == stage and done == 2:
                raise KeyboardInterrupt

        yield show

    def trial(item: tuple[object, str, str, int]) -> Trial:
        return Trial(*item[1:], outcomes=())

    monkeypatch.setattr("contactsense_studies.bimbo2019.study._trial", trial)  # the real ones take seconds
    monkeypatch.setattr("contactsense_studies.harness.progress_bars", progress)
    command = ["study", study, *sizes.split(), "--processes", "1"]
    assert run([*command, "--json"] if figures == "--json" else command) == 130
    told = capsys.readouterr()
    assert told.err == "contactsense: interrupted\n"
    if figures == "--json":
        assert json.loads(told.out)["complete"] is False
    else:
        assert figures in told.out


INTERRUPTED = """
import os, signal, sys, threading, time
from contactsense_studies.parallel import run_trials

def interrupt(stage, done, total):
    # The whole group, as a terminal does, or this process alone.
    os.killpg(0, signal.SIGINT) if sys.argv[1] == "group" else os.kill(os.getpid(), signal.SIGINT)

if __name__ == "__main__":
    # A shell's background jobs ignore the signal, and so would this process.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    print(*run_trials(time.sleep, [0.1, 0.0, 10_000.0, 10_000.0], "asleep", 2, interrupt), flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("whom", ["group", "parent"])
def test_an_interrupt_stops_other_processes(whom: str, tmp_path: Path) -> None:
    """Items of hours are not waited for, and no worker stays or complains."""
    script = tmp_path / "study.py"
    script.write_text(INTERRUPTED)
    ended = subprocess.run(
        [sys.executable, str(script), whom],
        capture_output=True,  # ends only when all who hold the pipe have ended
        text=True,
        timeout=60,
        check=False,
        start_new_session=True,
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "[] False\n", "")
