"""Options that several commands share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import Any, get_type_hints


def with_shared_options(command: Callable[..., None]) -> Callable[..., None]:
    """A command in which each argument that is a dataclass becomes the options that its fields are."""
    hints = get_type_hints(command, include_extras=True)
    groups: dict[str, Any] = {name: kind for name, kind in hints.items() if is_dataclass(kind)}

    @wraps(command)
    def wrapper(**given: Any) -> None:
        for name, kind in groups.items():
            given[name] = kind(**{field.name: given.pop(field.name) for field in fields(kind)})
        command(**given)

    parameters: list[Parameter] = [
        it for it in signature(command).parameters.values() if it.name not in groups
    ]
    for kind in groups.values():
        parameters += signature(kind).parameters.values()
        hints |= get_type_hints(kind, include_extras=True)
    by_name = [it.replace(kind=it.KEYWORD_ONLY, annotation=hints[it.name]) for it in parameters]
    wrapper.__signature__ = Signature(by_name)  # type: ignore[attr-defined]
    wrapper.__annotations__ = {it.name: it.annotation for it in by_name}
    return wrapper
