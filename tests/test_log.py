"""A log is plain, checked arrays."""

import pickle

import numpy as np
import pytest

import contactsense as cs

TIME = np.arange(4) * 0.01
ROWS = np.arange(28.0).reshape(4, 7)


def test_columns_are_read_only_copies() -> None:
    tau = ROWS.copy()
    log = cs.Log(TIME, ROWS, ROWS, tau, wrenches=np.zeros((4, 2, 6)))
    tau[0, 0] = 5.0
    assert log.tau is not None
    assert log.tau[0, 0] == 0.0
    assert not log.tau.flags.writeable
    assert len(log) == 4
    assert log.external_torque is None
    assert repr(log) == "Log(4 rows, 0.030 s: time, q, v, tau, wrenches)"


def test_a_slice_is_a_log_of_those_rows() -> None:
    part = cs.Log(TIME, ROWS, ROWS, external_torque=ROWS)[1:3]
    np.testing.assert_array_equal(part.external_torque, ROWS[1:3])
    np.testing.assert_array_equal(part.time, TIME[1:3])
    assert part.tau is None


def test_it_crosses_processes() -> None:
    log = cs.Log(TIME, ROWS, ROWS, ROWS)
    copy = pickle.loads(pickle.dumps(log))
    np.testing.assert_array_equal(copy.tau, log.tau)


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"time": [0.0, 0.01, 0.01, 0.02]}, "time: .* row 2"),
        ({"q": ROWS[:3]}, "q: .* as many rows as time, 4, not 3"),
        ({"v": ROWS[0]}, "v: .* 2 dimensions"),
        ({"tau": np.where(ROWS == 14.0, np.nan, ROWS)}, "tau: .* row 2"),
        ({"tau": None}, "tau: .*external_torque"),
        ({"wrenches": np.zeros((4, 1, 3))}, "wrenches"),
        ({"q": "no"}, "q: .*array of numbers"),
        ({"time": None}, "^time: must have 1 dimensions"),
        ({"time": 1.0}, "^time: must have 1 dimensions"),
        ({"q": None}, "^q: must have 2 dimensions"),
        ({"v": None}, "^v: must have 2 dimensions"),
        ({"time": [0, 1, 2, 10**400]}, "^time: has a number that is too large"),
        ({"tau": [[10**400] * 7] * 4}, "^tau: has a number that is too large"),
    ],
)
def test_what_is_no_log_is_refused(change: dict[str, object], name: str) -> None:
    columns: dict[str, object] = {"time": TIME, "q": ROWS, "v": ROWS, "tau": ROWS, **change}
    with pytest.raises(cs.InputError, match=name):
        cs.Log(**columns)  # type: ignore[arg-type]
