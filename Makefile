# Each target prepares what it needs by itself (see env).

.PHONY: run test build study clean

# make run BAG=path takes another bag.
run:
	./wsn-tracking replay $(or $(BAG),bags/a_loop) --rate max

# pytest comes last, so that its closing line is the last line.
test:
	./env ruff check
	./env mypy
	./env python -m pytest -q --cov

build:
	./env

study:
	./env python -m wsn_tracking.evaluation.study -o docs/results

clean:
	rm -rf .venv .venv-system build install log .coverage .coverage.* .hypothesis .mypy_cache .pytest_cache .ruff_cache
