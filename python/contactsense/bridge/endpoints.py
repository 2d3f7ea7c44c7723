"""With whom a session of Zenoh speaks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import InputError

# Nobody is looked for in the network. Sixteen messages may wait to be sent, in place of two: where the thread
# that sends them does not get a core for a millisecond, Zenoh would leave some out.
SETTINGS = {"scouting/multicast/enabled": "false", "transport/link/tx/queue/size/data": "16"}
# Where others reach a bridge that connects to nobody: this machine only.
LISTEN = "tcp/127.0.0.1:7448"
# Of one that connects to others, at any port.
_LISTEN_ANYWHERE = "tcp/127.0.0.1:0"


@dataclass(frozen=True)
class Endpoints:
    """With whom Zenoh speaks.

    Args:
        connect: addresses of others, such as `tcp/127.0.0.1:7447` of a router.
        listen: own addresses; by default one that only this machine reaches.
        file: configuration of Zenoh with all the rest, such as certificates; nothing is added to it but
            what is given here.
    """

    connect: Sequence[str] = ()
    listen: Sequence[str] = ()
    file: Path | None = None

    @property
    def own(self) -> list[str]:
        """Where others reach the bridge; of a file, only what is given beside it."""
        if self.listen or self.file is not None:
            return list(self.listen)
        return [_LISTEN_ANYWHERE if self.connect else LISTEN]

    def configuration(self) -> Any:
        """For Zenoh: nobody is looked for in the network.

        Raises:
            InputError: an address or the file cannot be used.
        """
        import json

        import zenoh

        given = {"connect": self.connect, "listen": self.own}
        if self.file is None:
            settings = zenoh.Config()
            for name, value in SETTINGS.items():
                settings.insert_json5(name, value)
        else:
            try:
                settings = zenoh.Config.from_file(self.file)
            except zenoh.ZError as error:
                raise InputError(f"zenoh-config: cannot use {self.file}: {error}") from error
        for name, addresses in given.items():
            if addresses:
                try:
                    settings.insert_json5(f"{name}/endpoints", json.dumps(list(addresses)))
                except zenoh.ZError as error:
                    raise InputError(f"{name}: {error}") from error
        return settings
