# `make bench`: run time against error of the library and its peers, costs, and the targets. Not part of `make all`.
# SPDX-License-Identifier: MIT

# Directories of CSV files (each is a data set); 1 for a run of minutes; a Markdown file that gets the section too;
# 1 to measure everything again, not only what the cache lacks; more options of tools/bench/report.py.
DATA ?=
QUICK ?=
FRESH ?=
BENCH_OPTIONS ?=
NLOPT ?= 1

BENCH_OUT := $(BUILD)/bench
CURVES := $(call object,$(sort $(wildcard tools/bench/curves_*.c)))
CURVES_PEERS := $(call object,tools/bench/peers_problem.c tools/bench/peers_start.c tools/bench/peers_levmar.c)
# The peers' inner loops: as fast as the compiler can make them (see curves_reduced.c).
CURVES_FAST := $(patsubst %,$(OBJ)/tools/bench/curves_%.o,reduced projected varpro grid)
CURVES_REDUCED := $(patsubst %,$(OBJ)/tools/bench/%.o,curves_reduced curves_projected curves_judge peers_problem)

.PHONY: bench bench-programs

bench-programs: $(BUILD)/curves $(BUILD)/libcurves_reduced.so $(BUILD)/families $(BUILD)/scaling $(BUILD)/kernel \
    $(BENCH_PROGRAMS) $(BUILD)/brdffit

$(BUILD)/families $(BUILD)/scaling: $(BUILD)/%: $(OBJ)/tools/bench/%.o $(OBJ)/tools/goniometer/random.o $(STATIC) \
    $(BUILD)/link.flags
	$(call say,LINK,$@)$(LINK) -o $@ $< $(OBJ)/tools/goniometer/random.o $(STATIC) -lm

# The one program that looks into the library.
$(OBJ)/tools/bench/kernel.o: CPPFLAGS += -Isrc
$(BUILD)/kernel: $(OBJ)/tools/bench/kernel.o $(STATIC) $(BUILD)/link.flags
	$(call say,LINK,$@)$(LINK) -o $@ $< $(STATIC) -lm

# 1 or 0; installed by this rule alone.
$(OBJ)/bench.nlopt: FORCE
	@mkdir -p $(@D)
	@$(if $(filter 0,$(NLOPT)),echo 0,CC='$(CC)' sh tools/setup/nlopt.sh install) > $@.tmp
	@cmp -s $@.tmp $@ || cp $@.tmp $@
	@rm -f $@.tmp

$(CURVES_FAST): $(OBJ)/tools/bench/%.o: tools/bench/%.c $(OBJ)/compile.flags
	@mkdir -p $(@D)
	$(call say,CC,$<)$(COMPILE) -O3 -ffp-contract=fast -fno-trapping-math -c $< -o $@

# These know which peers there are.
CURVES_ASKING := $(patsubst %,$(OBJ)/tools/bench/curves_%.o,main local recursive)
$(CURVES_ASKING): $(OBJ)/tools/bench/%.o: tools/bench/%.c \
    $(OBJ)/compile.flags $(OBJ)/bench.nlopt $(OBJ)/peers.ceres
	@mkdir -p $(@D)
	$(call say,CC,$<)$(COMPILE) $$(test "$$(cat $(OBJ)/peers.ceres)" = 1 || echo -DPEERS_NO_CERES) \
	    $$(test "$$(cat $(OBJ)/bench.nlopt)" = 1 || echo -DCURVES_NO_NLOPT) -c $< -o $@

$(OBJ)/tools/bench/curves_nlopt.o: tools/bench/curves_nlopt.c $(wildcard tools/bench/*.h) $(OBJ)/compile.flags $(OBJ)/bench.nlopt
	@mkdir -p $(@D)
	$(call say,CC,$<)if [ "$$(cat $(OBJ)/bench.nlopt)" = 1 ]; then $(COMPILE) -c $< -o $@; \
	else echo > $(OBJ)/peers_none.c && $(CC) -c $(OBJ)/peers_none.c -o $@; fi

$(BUILD)/curves: $(CURVES) $(CURVES_PEERS) $(PEERS_CERES) $(LEVMAR_OBJECTS) $(STATIC_IO) $(STATIC) $(BUILD)/link.flags
	$(call say,LINK,$@)ceres=; [ "$$(cat $(OBJ)/peers.ceres)" = 0 ] || ceres='-lceres -lglog'; \
	nlopt=; [ "$$(cat $(OBJ)/bench.nlopt)" = 0 ] || nlopt=-lnlopt_cxx; \
	driver='$(CC) $(CFLAGS)'; [ -z "$$ceres" ] || driver='$(CXX) $(CXXFLAGS)'; \
	$$driver $(LDFLAGS) -o $@ $(CURVES) $(CURVES_PEERS) $(PEERS_CERES) $(LEVMAR_OBJECTS) $(STATIC_IO) $(STATIC) \
	    $$ceres $$nlopt -lz -lm

$(BUILD)/libcurves_reduced.so: $(CURVES_REDUCED) $(STATIC_IO) $(STATIC) $(BUILD)/link.flags
	$(call say,LINK,$@)$(LINK) -shared -o $@ $(CURVES_REDUCED) $(STATIC_IO) $(STATIC) -lz -lm

# What Python costs beside the same calls from C: both in one process, in turn. PYTHON_BENCH: options of the program.
PYTHON_BENCH ?=
.PHONY: bench-python
$(BUILD)/libpython_direct.so: $(OBJ)/tools/bench/python_direct.o $(STATIC) $(BUILD)/link.flags
	$(call say,LINK,$@)$(LINK) -shared -o $@ $< $(STATIC) -lm -pthread

bench-python: $(BUILD)/libpython_direct.so $(SHARED) $(SHARED_IO)
	@PYTHON='$(PYTHON)' sh tools/setup/venv.sh '$(BUILD)/bench_venv' tools/bench/requirements.txt
	@PYTHONPATH=python/src PYTHONPYCACHEPREFIX='$(BUILD)/pycache' BRDFFIT_LIBRARY='$(abspath $(SHARED))' \
	    '$(BUILD)/bench_venv/bin/python' tools/bench/python_overhead.py $(BUILD)/libpython_direct.so $(PYTHON_BENCH)

bench: bench-programs
	@PYTHON='$(PYTHON)' sh tools/setup/venv.sh '$(BUILD)/bench_venv' tools/bench/requirements.txt
	@PYTHONPYCACHEPREFIX='$(BUILD)/pycache' '$(BUILD)/bench_venv/bin/python' tools/bench/report.py \
	    --build '$(BUILD)' --out '$(BENCH_OUT)' $(if $(filter 1,$(QUICK)),--quick) $(if $(filter 1,$(FRESH)),--fresh) \
	    $(BENCH_OPTIONS) $(if $(RESULTS),--results $(call quote,$(RESULTS))) $(if $(NOTE),--note $(call quote,$(NOTE))) \
	    $(DATA)

clean: clean-bench
clean-bench:
	rm -f $(BUILD)/curves $(BUILD)/families $(BUILD)/scaling $(BUILD)/kernel $(BUILD)/libcurves_reduced.so \
	    $(BUILD)/libpython_direct.so
.PHONY: clean-bench

# These need nothing but the library, and tests run them.
programs: $(BUILD)/families $(BUILD)/scaling
