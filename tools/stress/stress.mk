# make stress: fits that strain double arithmetic against 50-digit mpmath and Arb references (tools/stress).
# SPDX-License-Identifier: MIT

# Members of each family of problems, lobes and distribution; a Markdown file that gets the table too.
STRESS_MEMBERS ?= 12
STRESS_OPTIONS ?=

.PHONY: stress clean-stress

# --lobes is read as the benchmarks read it.
$(OBJ)/tools/stress/stress_fit.o: EXTRA = -Itools

$(BUILD)/stress_fit: $(OBJ)/tools/stress/stress_fit.o $(STATIC_IO) $(STATIC) $(BUILD)/link.flags
	$(call say,LINK,$@)$(LINK) -o $@ $< $(STATIC_IO) $(STATIC) -lz -lm

check-build: $(BUILD)/stress_fit

# The packages are those of the tests.
stress: $(BUILD)/stress_fit
	@PYTHON='$(PYTHON)' sh tools/setup/venv.sh '$(VENV)' tests/requirements.txt
	@PYTHONPYCACHEPREFIX='$(BUILD)/pycache' '$(VENV)/bin/python' tools/stress/stress.py --build '$(BUILD)' \
	    --members '$(STRESS_MEMBERS)' $(if $(RESULTS),--results $(call quote,$(RESULTS))) $(STRESS_OPTIONS)

clean: clean-stress
clean-stress:
	rm -f $(BUILD)/stress_fit
