# Each of these is one command from a fresh clone on Debian 12 or 13; see scripts/setup for what is installed.

# A shell opened before Rust was installed does not know its folder yet.
export PATH := $(PATH):$(HOME)/.cargo/bin

BUILD = cargo build --release --locked
# Says nothing of cargo's: BUILD has come before.
CARGO_RUN = cargo run --release --locked --quiet --
DEMO = forward scenes/demo.xml --param 'occluder.translation=1,0,0'

comma = ,

.PHONY: help deps demo test test-long test-mpi test-python bench bench-backends figures study cornell complex test-bare-debian

help:
	@echo "make demo           a gradient image of a moving soft shadow, and the finite differences it agrees with"
	@echo "make test           the tests"
	@echo "make test-long      the tests with all their samples, and those that take long"
	@echo "make test-mpi       the tests of optimize by many processes; installs Open MPI"
	@echo "make test-python    the tests of python/, in an environment of its own (EXTRAS=torch,jax: those of PyTorch and JAX, too)"
	@echo "make bench          speed, on this machine"
	@echo "make bench-backends Embree against obvhs, on this machine, into out/bench"
	@echo "make figures        the paper's figures beside finite differences, into out/figures (long; QUICK=1: a minute, to try it)"
	@echo "make study          every method on the failure battery: docs/stability.md, and charts into out/study (minutes)"
	@echo "make cornell        smooth and rough balls in a Cornell box: docs/cornell.md (minutes)"
	@echo "make complex        hedges, hair, forests in three densities: docs/complexity_measured.md (more than an hour)"
	@echo "make test-bare-debian  make demo and make test on a bare Debian 12 and a bare Debian 13, in chroots (long)"
	@echo "make deps           only install what the others need"

deps:
	@scripts/setup

demo: deps
	$(BUILD)
	$(CARGO_RUN) $(DEMO) -o out/demo
	$(CARGO_RUN) $(DEMO) --method fd -o out/demo-fd
	@echo
	@echo "The gradient of the picture as the occluder moves is in out/demo,"
	@echo "the finite differences to compare it with are in out/demo-fd:"
	@ls out/demo/*.png out/demo-fd/*.png 2>/dev/null || ls out/demo out/demo-fd

# Examples are left out: they have no tests, and `make test-long` builds them.
test: deps
	cargo test --release --locked --lib --bins --tests

test-long: deps
	cargo test --release --locked --features long-tests
	cargo build --release --locked --no-default-features --features obvhs --target-dir target/without-embree
	target/without-embree/release/warpath check $(wordlist 2,9,$(DEMO)) -D res=48 --quiet

test-mpi:
	@scripts/setup mpi
	cargo test --release --locked --features mpi --test program ranks -- --test-threads 1

# Where Debian has no python3-venv, the message of venv says so.
test-python: deps
	$(BUILD)
	python3 -m venv target/python
	target/python/bin/pip install --quiet './python[test$(if $(EXTRAS),$(comma)$(EXTRAS))]'
	WARPATH=$(CURDIR)/target/release/warpath target/python/bin/python -m pytest python

bench: deps
	scripts/benchmark

bench-backends: deps
	$(BUILD)
	$(CARGO_RUN) bench -o out/bench

figures: deps
	scripts/figures $(if $(QUICK),--quick)

study: deps
	$(BUILD)
	rm -f out/study/study.jsonl
	$(CARGO_RUN) study scenes/failures/study.toml -o out/study --report docs/stability.md
	cp out/study/summary.svg docs/pictures/battery.svg

cornell: deps
	$(BUILD)
	rm -f out/cornell/study.jsonl
	$(CARGO_RUN) study scenes/cornell/study.toml -o out/cornell --report docs/cornell.md

complex: deps
	$(BUILD)
	cargo run --release --locked --quiet --example make_complex_scenes -- all
	rm -f out/complex/study/study.jsonl
	$(CARGO_RUN) study scenes/complex/study.toml -o out/complex/study --report docs/complexity_measured.md
	cp out/complex/study/summary.svg docs/pictures/complexity.svg

test-bare-debian:
	scripts/test-bare-debian
