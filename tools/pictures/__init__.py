"""The pictures of the documentation, each made by one function: `python -m tools.pictures [NAME ...]`."""
