# make export-errors: each target's error on measured materials (tools/export). SPDX-License-Identifier: MIT

# Packages of the renderers are used where EXPORT_PYTHON has them (python/tests/requirements-renderers.txt).
EXPORT_PYTHON ?= $(VENV)/bin/python

.PHONY: export-errors

export-errors: $(SHARED) $(TOOLS)
	@rm -rf '$(BUILD)/export' && mkdir -p '$(BUILD)/export' && '$(BUILD)/goniometer' '$(BUILD)/export/goniometer'
	@BRDFFIT_LIBRARY='$(abspath $(SHARED))' PYTHONPYCACHEPREFIX='$(BUILD)/pycache' '$(EXPORT_PYTHON)' tools/export/errors.py \
	    $(if $(RESULTS),--results $(call quote,$(RESULTS))) '$(BUILD)/export/goniometer' $(DATA)
