"""Every public name is documented, and the examples in the docstrings run."""

import doctest
import inspect
import re

import pytest

import contactsense as cs

CLASSES = [getattr(cs, name) for name in cs.__all__ if inspect.isclass(getattr(cs, name))]
IDS = [cls.__name__ for cls in CLASSES]
# Arrays without a unit: directions, numbers of rows, ranks, answers, shares and logarithms of probabilities.
UNITLESS = {
    "hysteresis_std",
    "prior",
    "normal",
    "normals",
    "triangles",
    "triangle",
    "ray",
    "link",
    "log_posterior",
    "rank",
    "detectable",
    "weight",
    "contact",
    "number_probabilities",
    "directions",
    "relative",
    "hysteresis",
    "torque_scale",
}


def members(cls):
    for name, member in inspect.getmembers(cls):
        is_own = any(
            name in vars(base) for base in cls.__mro__[:-1] if base.__module__.startswith("contactsense")
        )
        if is_own and not name.startswith("_"):
            yield name, member


@pytest.mark.parametrize("cls", CLASSES, ids=IDS)
def test_every_public_name_has_a_docstring(cls):
    assert inspect.cleandoc(cls.__doc__)
    for name, member in members(cls):
        doc = inspect.getdoc(member)
        assert doc, f"{cls.__name__}.{name}"
        if name != "model":
            assert doc.splitlines()[0].endswith("."), f"{cls.__name__}.{name}: {doc}"


@pytest.mark.parametrize("cls", CLASSES, ids=IDS)
def test_examples_run(cls):
    tests = [test for test in doctest.DocTestFinder(recurse=False).find(cls) if test.examples]
    if not issubclass(cls, Exception):
        assert tests, f"{cls.__name__} has no example"
    for test in tests:
        result = doctest.DocTestRunner().run(test)
        assert result.attempted > 0
        assert result.failed == 0


def arguments_section(doc):
    """What a docstring says of each argument, in its order."""
    section = re.search(r"^Args:\n(.*?)(?=^\S|\Z)", doc, re.MULTILINE | re.DOTALL)
    if section is None:
        return {}
    entries = re.findall(r"^    (\w+): (.*?)(?=^    \w+: |\Z)", section[1], re.MULTILINE | re.DOTALL)
    return {name: " ".join(text.split()) for name, text in entries}


def callables():
    for cls in CLASSES:
        if issubclass(cls, Exception):
            continue
        if cls not in (cs.Robot, cs.Calibration) and inspect.signature(cls).parameters:
            yield cls.__name__, cls, inspect.getdoc(cls)
        for name, member in members(cls):
            if callable(member):
                yield f"{cls.__name__}.{name}", member, inspect.getdoc(member)


@pytest.mark.parametrize(("name", "obj", "doc"), list(callables()), ids=[name for name, _, _ in callables()])
def test_arguments_are_documented_in_their_order(name, obj, doc):
    parameters = [p for p in inspect.signature(obj).parameters if p != "self"]
    documented = arguments_section(doc)
    assert list(documented) == parameters
    if parameters:
        assert "Raises:" in doc


def arrays():
    """Array arguments and array attributes with what is said of them."""
    for name, _, doc in callables():
        for argument, text in arguments_section(doc).items():
            if re.search(r"\((nq|nv|n|k|n_sensors|3|4|6)\b", text):
                yield f"{name}({argument})", argument, text
    for cls in CLASSES:
        for name, member in members(cls):
            doc = inspect.getdoc(member) or ""
            if (
                not callable(member)
                and re.search("read-only|`\\(", doc)
                and name not in ("particles", "options")
            ):
                yield f"{cls.__name__}.{name}", name, doc


@pytest.mark.parametrize(("where", "name", "text"), list(arrays()), ids=[where for where, _, _ in arrays()])
def test_arrays_state_shape_and_unit(where, name, text):
    assert re.search(r"`\([\w ,-]+\)`|as many|one a", text), "shape"
    # A configuration mixes angles, lengths and quaternions.
    if name not in UNITLESS and name != "q":
        assert re.search(r"\[[^\]]+\]|of `robot.link_names`", text), "unit"
