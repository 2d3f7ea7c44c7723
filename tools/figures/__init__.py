"""The figures in README.md and docs/: their commands, results and places in the text.

From the root of the repository, with the extra `study` and the dependency group `bench` installed:

    python -m tools.figures [NAME ...]     # run the commands, record the results and write the text
    python -m tools.figures --check        # compare the text with docs/figures.json
"""
