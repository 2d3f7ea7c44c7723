# `make demo` and `make test` are all the set-up there is: each makes .venv, builds the release code and runs.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: demo test lint types rust-test python-test shared-test bench docs clean toolchain install studies wheel-check licences lowest header

demo: GROUP :=
demo: install
	$(BIN)/contactsense demo

test: lint types rust-test python-test

# What `contactsense study` runs; the groups of tests and benches have its dependencies.
studies: install
	$(BIN)/python -m pip install -q --disable-pip-version-check --no-deps -e studies

lint: install
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --release -- -D warnings
	cargo clippy -p contactsense --no-default-features --all-targets --release -- -D warnings

types: studies
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest contactsense._core
	$(BIN)/python tools/stub_docs.py --check

# The same random cases in every run; another seed draws others.
rust-test: export PROPTEST_RNG_SEED ?= 1
rust-test: toolchain
	cargo test --workspace --release --quiet
	cargo test -p contactsense --quiet --features serde --test suite plain_data
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --release --quiet

# The header of the C interface, from its sources; a test compares them.
header: toolchain
	CONTACTSENSE_WRITE_HEADER=1 cargo test -p contactsense-capi --release --quiet --test header

# On all cores; the tests of a file stay together, since they share what is set up once.
python-test: studies
	$(BIN)/python -m pytest -q --durations=25 -n auto --dist loadfile

# Tests of robots and logs that are not part of the project, in CONTACTSENSE_SHARED or ../shared.
shared-test: studies
	$(BIN)/python -m pytest -q --durations=10 -n auto --dist loadfile -m shared

bench: GROUP := bench
bench: install
	cargo bench --workspace
	$(BIN)/python -m benches.compare

# The documentation as a site, in build/site.
docs: GROUP := docs
docs: install
	$(BIN)/python -m sphinx -q -W --keep-going -b html docs build/site

# Says which version is missing, before anything is built.
toolchain:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2> /dev/null || \
	    { echo "contactsense needs Python 3.10 or newer (found: $$($(PYTHON) --version 2>&1 || echo none)); set PYTHON=..." >&2; exit 1; }
	@sh tools/check_rust.sh

$(BIN)/maturin: | toolchain
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install -q --disable-pip-version-check 'maturin>=1.9.4,<2'

# Installs what is needed, builds the release code, and links it into the environment. Dependency groups need pip 25.1.
# The extras are those that `demo` names: maturin would look for `contactsense[...]` itself in the package index.
EXTRAS := cli,sim,plot
GROUP := test
install: $(BIN)/maturin
	VIRTUAL_ENV=$(CURDIR)/$(VENV) $(BIN)/maturin develop --release --quiet --extras $(EXTRAS)
	@[ -z "$(GROUP)" ] || $(BIN)/python -m pip install -q --disable-pip-version-check 'pip>=25.1'
	@[ -z "$(GROUP)" ] || $(BIN)/python -m pip install -q --disable-pip-version-check --group $(GROUP)

# The wheel as it is released, in bare environments of each Python that is there.
wheel-check: toolchain
	$(PYTHON) -m venv target/wheel-tools
	target/wheel-tools/bin/python -m pip install -q --disable-pip-version-check 'pip>=25.1'
	target/wheel-tools/bin/python -m pip install -q --disable-pip-version-check --group wheels
	target/wheel-tools/bin/python tools/wheels.py

# Licences of all that is shipped and needed, and the lowest versions of dependencies that are allowed.
licences: install
	$(BIN)/python tools/licences.py

lowest: toolchain
	$(PYTHON) tools/lowest.py

clean:
	rm -rf $(VENV) target
