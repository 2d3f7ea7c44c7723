"""`python -m benches.compare`: times contactsense beside its peers on one core and prints a table."""

from __future__ import annotations

import argparse
import json
import sys
import time

from .machine import describe, use_one_core

NAMES = (
    *("observer", "compensation", "monitor", "noisy", "contact_map", "closest", "rays", "particle_filter"),
    *("log", "view", "bridge", "c_interface"),
)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benches.compare", description=__doc__)
    parser.add_argument("only", nargs="*", help=f"comparisons to run, of {', '.join(NAMES)}; default all")
    parser.add_argument("--quick", action="store_true", help="a few short rounds: a smoke test, not a figure")
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    parser.add_argument("--wall", action="store_true", help="time on the wall instead of time on the core")
    parser.add_argument("--core", type=int, help="the core to run on; default the last")
    arguments = parser.parse_args()
    if unknown := sorted(set(arguments.only) - set(NAMES)):
        parser.error(f"there is no comparison {unknown[0]!r}; there are {', '.join(NAMES)}")
    note = use_one_core(arguments.core)

    # Not before: libraries read the number of threads when they are loaded.
    import contactsense as cs

    from . import (
        bridge,
        c_interface,
        closest,
        compensation,
        contact_map,
        log,
        monitor,
        noisy,
        observer,
        particle_filter,
        rays,
        table,
        view,
    )
    from .timing import Pace

    if cs.build_profile != "release":
        print(f"contactsense is a {cs.build_profile} build; build with `maturin develop -r`", file=sys.stderr)
        return 2
    clock = time.perf_counter if arguments.wall else time.process_time
    pace = Pace(3, 0.002, 2, 2, clock, 12_000) if arguments.quick else Pace(60, 0.005, 20, 40, clock)
    all_modules = (
        observer,
        compensation,
        monitor,
        noisy,
        contact_map,
        closest,
        rays,
        particle_filter,
        log,
        view,
        bridge,
        c_interface,
    )
    modules = dict(zip(NAMES, all_modules, strict=True))
    comparisons = []
    for name in arguments.only or NAMES:
        print(f"{name} ...", file=sys.stderr)
        comparisons += modules[name].compare(pace)
    about = {**describe(), "affinity": note, "clock": clock.__name__, "rounds": str(pace.rounds)}
    if arguments.json:
        print(json.dumps(table.as_json(comparisons, about), indent=2))
    else:
        table.show(comparisons, about)
    return 0


if __name__ == "__main__":
    sys.exit(main())
