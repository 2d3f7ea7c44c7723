"""The table of all figures."""

from __future__ import annotations

from . import demos, identifiability, long_studies, real_arm, studies
from .entry import Figure

PYTHON = ("python", "-m")
CONTACTSENSE = (*PYTHON, "contactsense.cli")
STUDY = (*CONTACTSENSE, "study")
NOISE = ("--noise", "2", "0.1")

FIGURES = (
    Figure(
        "franka_touch",
        "Contacts by hand on a Franka arm at rest, from public logs.",
        (*STUDY, "franka_touch", "--data", "{data}", "--json", "--png", "franka_touch.png"),
        "All contacts of the six logs on which no setting was chosen, pooled.",
        "README.md",
        reduce=studies.franka_touch,
        table=studies.franka_touch_table,
    ),
    Figure(
        "single_contacts",
        "Single contacts with ideal torques, 100 on every link, in random poses.",
        (*STUDY, "single_contacts", "--json"),
        "Counts over all links; worst error of the points that are exact.",
        "docs/figures.md",
        settings={"Atlas": ("--robot", "atlas"), "iiwa14": ("--robot", "iiwa14")},
        reduce=studies.single_contacts,
        table=studies.single_contacts_table,
    ),
    Figure(
        "noisy_isolation",
        "Single contacts of 10 to 60 N with 0.1 Nm of noise on every torque, thresholds of 0.3 Nm.",
        (*PYTHON, "tools.figures.noisy_isolation"),
        "Of 300 contacts; a located point is wrong if it is off by more than 1 cm and three `point_std`.",
        "docs/figures.md",
        reduce=studies.noisy_isolation,
        table=studies.noisy_isolation_table,
    ),
    Figure(
        "demo_arm",
        "A simulated arm in fast motion, nine contacts a seed.",
        (*CONTACTSENSE, "demo", "--json", "--out", "demo.png", "--seed", "{seed}"),
        "Contacts of all seeds, pooled; errors are those of located contacts.",
        "docs/figures.md",
        settings={"none": (), "2 % and 0.1 Nm": (*NOISE, "--no-imperfect")},
        seeds={"none": range(10), "2 % and 0.1 Nm": range(10)},
        reduce=demos.reduce,
        table=demos.table,
    ),
    Figure(
        "demo_atlas",
        "A standing humanoid, five contacts a seed.",
        (*CONTACTSENSE, "demo", "--robot", "atlas", "--json", "--out", "demo.png", "--seed", "{seed}"),
        "Contacts of all seeds, pooled; errors are those of located contacts.",
        "docs/figures.md",
        settings={
            "none": (),
            "2 % and 0.1 Nm; sensors 1 N and 0.05 Nm": (*NOISE, "--sensor-noise", "1", "0.05"),
        },
        seeds={"none": range(201, 209), "2 % and 0.1 Nm; sensors 1 N and 0.05 Nm": range(201, 207)},
        reduce=demos.reduce,
        table=demos.table,
    ),
    Figure(
        "identifiability",
        "What joint torques tell of contacts of 10 N anywhere on a robot, without a measurement.",
        (*STUDY, "identifiability", "--json"),
        "All samples of a link in 20 random poses; the most frequent rank.",
        "docs/contact_map.md",
        reduce=identifiability.reduce,
        table=identifiability.study_table,
    ),
    Figure(
        "point_errors",
        "The posterior of contacts of 10 N on a known link, beside the deviation stated without it.",
        (*PYTHON, "tools.figures.point_errors"),
        "Root mean squares over 300 contacts a link, each in a random pose.",
        "docs/contact_map.md",
        reduce=identifiability.point_errors,
        table=identifiability.point_errors_table,
    ),
    Figure(
        "vorndamme2017",
        "One, two and five simultaneous contacts on Atlas.",
        (*STUDY, "vorndamme2017", "--json"),
        "Shares of all scenes of a kind; default counts, seed 0.",
        "docs/vorndamme2017.md",
        reduce=long_studies.vorndamme2017,
        table=long_studies.vorndamme2017_table,
        long=True,
    ),
    Figure(
        "vorndamme2017_time",
        "Time of a call of the isolator.",
        (*STUDY, "vorndamme2017", "--json"),
        "Mean over 1,000 scenes, and greatest of the fastest of three calls.",
        "docs/vorndamme2017.md",
        reduce=long_studies.vorndamme2017,
        table=long_studies.vorndamme2017_time_table,
        long=True,
    ),
    Figure(
        "bimbo2019",
        "A contact anywhere on an arm, by the particle filter.",
        (*STUDY, "bimbo2019", "--seed", "1", "--json"),
        "Mean and median of the error over five trials a link.",
        "docs/bimbo2019.md",
        reduce=long_studies.bimbo2019,
        table=long_studies.bimbo2019_table,
        long=True,
    ),
    Figure(
        "real_arm",
        "Contacts on simulated arms with the errors of real ones, before and after calibration.",
        (*STUDY, "real_arm", "--json"),
        "180 contacts an arm, 12 minutes of free motion; three arms of each kind, pooled.",
        "docs/real_arm.md",
        reduce=real_arm.reduce,
        table=real_arm.table,
        long=True,
    ),
    Figure(
        "real_arm_localization",
        "Where the calibrated monitor finds contacts on simulated arms with the errors of real ones.",
        (*STUDY, "real_arm", "--json"),
        "Shares of the detected of 180 contacts an arm; three arms of each kind, pooled.",
        "docs/real_arm.md",
        reduce=real_arm.reduce_localization,
        table=real_arm.localization_table,
        long=True,
    ),
    Figure(
        "speed",
        "Time of a call beside other libraries, on an idle machine.",
        (*PYTHON, "benches.compare", "--wall", "--json"),
        "Median of 60 rounds in alternating order; ratio of the medians.",
        "README.md",
        reduce=long_studies.speed,
        table=long_studies.speed_table,
        long=True,
    ),
)
BY_NAME = {figure.name: figure for figure in FIGURES}
