"""The picture of a log's contacts."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from log_files import DT, arm, pushed

import contactsense as cs
from contactsense.errors import InputError

pytest.importorskip("matplotlib")


def replay(log: cs.Log, threshold: float) -> cs.Replay:
    return cs.replay(log, cs.ContactMonitor(arm(), dt=DT, torque_threshold=threshold))


def size(path: Path) -> tuple[int, int]:
    return struct.unpack(">II", path.read_bytes()[16:24])


def test_contacts_are_drawn(tmp_path: Path) -> None:
    none, one = replay(pushed()[:300], 0.6), replay(pushed(), 0.6)
    assert [len(each.contacts) for each in (none, one)] == [0, 1]
    for name, result in (("none", none), ("one", one)):
        path = result.to_png(tmp_path / name, name)
        assert path == (tmp_path / name).with_suffix(".png").resolve()
        assert size(path) == (1300, 975)
        assert len(path.read_bytes()) > 20_000


def test_many_contacts_share_a_drawing(tmp_path: Path) -> None:
    # Six times the push, one after the other.
    log = pushed()
    time = np.arange(6 * len(log)) * DT
    many = cs.Log(time, *(np.tile(rows, (6, 1)) for rows in (log.q, log.v, log.tau)))
    result = replay(many, 0.6)
    assert len(result.contacts) >= 5
    assert size(result.to_png(tmp_path / "many.png")) == (1300, 975)


def test_a_contact_without_a_point_is_drawn(tmp_path: Path) -> None:
    log = pushed()
    q = np.tile(log.q[0], (len(log), 1))
    still = np.zeros_like(q)
    tau = np.tile(arm().inverse_dynamics(q[0], still[0], still[0]), (len(log), 1))
    tau[500:900, 0] -= 20.0  # a moment about the vertical: any link
    result = replay(cs.Log(log.time, q, still, tau), 0.6)
    assert len(result.contacts) == 1
    assert size(result.to_png(tmp_path / "moment.png")) == (1300, 975)


def test_a_picture_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="path: cannot write"):
        replay(pushed()[:300], 0.6).to_png(tmp_path / "nowhere" / "a.png")
