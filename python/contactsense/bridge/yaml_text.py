"""The text of a YAML file, read strictly."""

from __future__ import annotations

from typing import Any

import yaml

from ..errors import InputError


def parsed(file: str, text: str) -> Any:
    """What a YAML text holds.

    Args:
        file: its name, for messages.
        text: what it holds.

    Raises:
        InputError: it is no YAML, or a name stands twice in a mapping.
    """
    try:
        root = yaml.compose(text, yaml.SafeLoader)
        _refuse_twice(file, root, set())
        return yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise InputError(f"{file}: is no YAML: {' '.join(str(error).split())}") from None
    except InputError:
        raise
    except (RecursionError, ValueError) as error:  # too deep; dates that do not exist
        raise InputError(f"{file}: cannot be read: {error}") from None


def _refuse_twice(file: str, node: Any, seen: set[int]) -> None:
    """Refuses a name that stands twice in a mapping, of which YAML would drop the first."""
    if id(node) in seen or not isinstance(node, yaml.CollectionNode):
        return
    seen.add(id(node))
    if isinstance(node, yaml.MappingNode):
        names = [key.value for key, _ in node.value if isinstance(key, yaml.ScalarNode)]
        for name in names:
            if names.count(name) > 1:
                line = node.start_mark.line + 1
                raise InputError(f"{file}: {name!r} stands twice in the mapping at line {line}")
        children = [part for pair in node.value for part in pair]
    else:
        children = node.value
    for child in children:
        _refuse_twice(file, child, seen)
