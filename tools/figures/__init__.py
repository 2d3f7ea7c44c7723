"""Every figure that README and docs state: its command, its seeds, how it is aggregated, and where it stands.

From the root of the repository, with what `make install` installs and the studies:

    python -m tools.figures list            # all figures and their commands
    python -m tools.figures run NAME...     # measure these anew; without a name, all that take minutes
    python -m tools.figures adopt NAME...   # record the table that stands in the text, with its commit
    python -m tools.figures write           # write the tables and docs/figures.md from docs/figures.json
    python -m tools.figures --check         # compare the text with docs/figures.json

For `franka_touch`, `run` needs the logs of the arm: `--data DIR`, or CONTACTSENSE_FRANKA_TOUCH. Results are
in docs/figures.json, with processor, versions and date. Tables stand between `<!-- figures: NAME -->` and
`<!-- end -->`.
"""
