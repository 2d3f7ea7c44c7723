"""The table on noisy measurements."""

from __future__ import annotations

from rich.table import Table

from ..harness import scaled, sheet
from .noise import Noise
from .noisy_score import NoisyScore, noisy_score
from .study import Study
from .wording import NAMES, percent

LABELS = ("noise", "contacts", "measured", "stated as")
FIGURES = ("n", "num-\nber", "links", "loca-\nted", "of these\nwrong", "point\nmm", "force\n%")
NOTE = (
    "Noise: standard deviation on every component; 0.01 Nm stands for 0.05 N, 0.005 Nm\n"
    "at sensors, 0.1 Nm for 0.5 N, 0.05 Nm. Thresholds: three standard deviations at\n"
    "usual torques and wrenches; noise model: of the torques, wrenches as before.\n"
    "Number, links: as many, just the true ones; wrong: off by more than 1 cm and three\n"
    "point_std; point, force: median errors of the located contacts."
)


def noise_table(study: Study) -> Table:
    """One row a set of scenes, noise, and way to state the noise."""
    table = sheet("Noisy measurements, shares in %", LABELS, FIGURES, NOTE)
    before = ""
    for run in sorted(
        (run for run in study.runs if run.setting.stated != "nothing"),
        key=lambda run: noise_name(run.setting.noise),
    ):
        setting = run.setting
        for determined in (True, False):
            verdicts = [each for each in run.verdicts if (each.rank_deficit == 0) == determined]
            if not verdicts or (len(run.scenes[0].touches) == 1 and not determined):
                continue
            noise = noise_name(setting.noise)
            if before not in ("", noise):
                table.add_section()
            table.add_row(
                "" if noise == before else noise,
                contacts_name(len(run.scenes[0].touches), determined),
                NAMES[setting.method],
                setting.stated,
                *_cells(noisy_score(verdicts)),
            )
            before = noise
    return table


def noise_name(noise: Noise) -> str:
    """A case of noise in the first column."""
    relative = f"{100 * noise.relative:g} %, " if noise.relative else ""
    return f"{relative}{noise.torque:g} Nm"


def contacts_name(contacts: int, determined: bool) -> str:
    """A set of scenes."""
    return f"{contacts}" if contacts == 1 or determined else f"{contacts}, deficit"


def _cells(figures: NoisyScore) -> list[str]:
    shares = (figures.counted, figures.links_right, figures.located, figures.wrong)
    return [
        str(figures.scenes),
        *map(percent, shares),
        scaled(figures.point_error, 1e3, 1),
        scaled(figures.force_error, 1e2, 1),
    ]
