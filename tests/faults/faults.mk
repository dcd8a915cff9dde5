# make faults: what tests/faults/campaign.py says. SPDX-License-Identifier: MIT

faults: programs $(FAULTS) venv
	@BRDFFIT_BUILD='$(abspath $(BUILD))' '$(VENV)/bin/python' tests/faults/campaign.py $(if $(filter 1,$(LONG)),--long)
.PHONY: faults
