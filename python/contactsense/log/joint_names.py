"""Which joint of a robot a log means by a name."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

Tokens = tuple[str, ...]

# Words that names of joints have or lack at will.
_FILLERS = frozenset({"joint", "jnt", "j"})


def words(name: str) -> Tokens:
    """Words and numbers of a name, in lower case: of `Wrist 1` and `wrist_1` the same."""
    apart = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).lower()
    return tuple(re.findall(r"[^\W\d_]+|\d+", apart))


def tokens(name: str) -> Tokens:
    """The words that tell joints apart."""
    all_words = words(name)
    return tuple(word for word in all_words if word not in _FILLERS) or all_words


def match(joints: Sequence[str], names: Sequence[str]) -> dict[str, str]:
    """The name in a log of each joint of a robot; joints without one are left out.

    Names are compared as they are; then without regard to case, blanks and the word "joint"; then one may
    have a namespace or prefix that the other lacks; then each side's common prefix is left out, as in
    `fer_joint1` and `panda_joint1`. A name is only taken where no other would fit as well.
    """
    found: dict[str, str] = {}
    rounds: tuple[Callable[[list[str], list[str]], dict[str, str]], ...] = (
        lambda a, b: _unique(a, b, lambda joint, name: joint == name),
        lambda a, b: _unique(a, b, lambda joint, name: tokens(joint) == tokens(name)),
        lambda a, b: _unique(a, b, lambda joint, name: _is_tail(tokens(joint), tokens(name))),
        _without_prefixes,
    )
    for matching in rounds:
        open_joints = [joint for joint in joints if joint not in found]
        open_names = [name for name in names if name not in found.values()]
        found.update(matching(open_joints, open_names))
    return {joint: found[joint] for joint in joints if joint in found}


def _unique(joints: list[str], names: list[str], fits: Callable[[str, str], bool]) -> dict[str, str]:
    pairs = [(joint, name) for joint in joints for name in names if fits(joint, name)]
    alone = [pair for pair in pairs if sum(pair[0] == it[0] or pair[1] == it[1] for it in pairs) == 1]
    return dict(alone)


def _is_tail(a: Tokens, b: Tokens) -> bool:
    shorter, longer = sorted((a, b), key=len)
    return longer[len(longer) - len(shorter) :] == shorter


def _without_prefixes(joints: list[str], names: list[str]) -> dict[str, str]:
    """Both sides have a prefix of their own; of the log's, the one that leaves names for most joints."""
    own = _common_prefix(list(map(tokens, joints)))
    prefixes = {tokens(name)[:length] for name in names for length in range(1, len(tokens(name)))}
    found = []
    for prefix in sorted(prefixes):
        having = [name for name in names if tokens(name)[: len(prefix)] == prefix]

        def fits(joint: str, name: str, length: int = len(prefix)) -> bool:
            return tokens(joint)[own:] == tokens(name)[length:]

        found.append(_unique(joints, having, fits))
    most = max(map(len, found), default=0)
    best = [matched for matched in found if len(matched) == most]
    return best[0] if len(best) == 1 else {}


def _common_prefix(names: Sequence[Tokens]) -> int:
    """Number of first words that all have, at most all but the last."""
    shortest = min(map(len, names), default=1)
    return next((k for k in range(shortest - 1) if len({name[k] for name in names}) > 1), shortest - 1)
