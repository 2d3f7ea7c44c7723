"""The table on noisy measurements."""

from __future__ import annotations

from rich.table import Table

from ..harness import scaled, sheet
from .isolation import Stated
from .noise import Noise
from .noisy_score import NoisyScore, noisy_score
from .study import Study
from .wording import NAMES, percent

LABELS = ("noise", "con-\ntacts", "rank", "meas-\nured", "stated as")
FIGURES = ("n", "num-\nber", "links", "loca-\nted", "of these\nwrong", "point\nmm", "force\n%")
NOTE = (
    "Noise: a share of each component and a floor, 0.01 Nm (sensors: 0.05 N,\n"
    "0.005 Nm), or 0.1 Nm (0.5 N, 0.05 Nm). Thresholds: three standard deviations\n"
    "at usual torques and wrenches; model: a NoiseModel of the torques instead.\n"
    "Number: as many contacts as there are; links: just the true ones; wrong: off\n"
    "by more than 1 cm and 3 point_std; point, force: medians of the located ones."
)

STATED: dict[Stated, str] = {"nothing": "nothing", "thresholds": "thresholds", "noise model": "model"}


def noise_table(study: Study) -> Table:
    """One row a set of scenes, noise, and way to state the noise."""
    table = sheet("Noisy measurements, shares in %", LABELS, FIGURES, NOTE)
    before = ""
    for run in sorted(
        (run for run in study.runs if run.setting.stated != "nothing"),
        key=lambda run: noise_name(run.setting.noise),
    ):
        setting = run.setting
        determined = [verdict for verdict in run.verdicts if verdict.rank_deficit == 0]
        groups = [("full", determined), ("all", run.verdicts)]
        for rank, verdicts in groups if len(determined) < len(run.verdicts) else groups[1:]:
            noise = noise_name(setting.noise)
            if before not in ("", noise):
                table.add_section()
            table.add_row(
                "" if noise == before else noise,
                f"{len(run.scenes[0].touches)}",
                rank,
                NAMES[setting.method],
                STATED[setting.stated],
                *_cells(noisy_score(verdicts)),
            )
            before = noise
    return table


def noise_name(noise: Noise) -> str:
    """A case of noise in the first column."""
    relative = f"{100 * noise.relative:g} %, " if noise.relative else ""
    return f"{relative}{noise.torque:g} Nm"


def _cells(figures: NoisyScore) -> list[str]:
    shares = (figures.counted, figures.links_right, figures.located, figures.wrong)
    return [
        str(figures.scenes),
        *map(percent, shares),
        scaled(figures.point_error, 1e3, 1),
        scaled(figures.force_error, 1e2, 1),
    ]
