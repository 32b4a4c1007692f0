# Each target prepares what it needs by itself (see env).

.PHONY: run test build study reproduce bench clean

# make run BAG=path takes another bag.
run:
	./wsn-tracking replay $(or $(BAG),bags/a_loop) --rate max

# pytest comes last, so that its closing line is the last line. Three workers keep two cores busy: live tests often wait.
test:
	./env ruff check
	./env mypy
	./env python -m pytest -q --cov -n 3 --dist loadfile

build:
	./env

# The last one takes root, and is left out without.
study:
	./env python -m wsn_tracking.studies -o docs/results
	./env python -m wsn_tracking.studies.consensus -o docs/results
	./env python -m wsn_tracking.studies.live -o docs/results
	./env python -m wsn_tracking.studies.serial -o docs/results
	-./env python -m wsn_tracking.studies.live_hosts -o docs/results

# make reproduce ARGS=--quick takes a quarter of the time. The report is reproduction/reproduction.html.
reproduce:
	./wsn-tracking reproduce $(ARGS)

# make bench JSON=path writes the table for machines, too. A peer that cannot be installed is left out of it.
bench:
	-./env python -m pip install -q --disable-pip-version-check --no-deps --no-build-isolation -r requirements-bench.txt
	./wsn-tracking bench $(if $(JSON),--json $(JSON))

clean:
	rm -rf .venv .venv-system build install log .coverage .coverage.* .hypothesis .mypy_cache .pytest_cache .ruff_cache
