# build/peers: local least-squares solvers beside the certified optimum; and the paper's experiments.
# Not part of `make all`: levmar is GPL and Ceres is large, and the library needs neither.
# SPDX-License-Identifier: MIT

CXX ?= c++
CXXFLAGS ?= -O2 -g
CERES ?= 1

LEVMAR_ROOT := $(THIRD_PARTY)/levmar-2.6
LEVMAR_SOURCES := lm lmbc Axb misc
LEVMAR_OBJECTS := $(LEVMAR_SOURCES:%=$(OBJ)/levmar/%.o)
PEERS := $(call object,$(sort $(wildcard tools/bench/peers_*.c)))
PEERS_CERES := $(OBJ)/tools/bench/peers_ceres.o

.PHONY: peers paper clean-peers

peers: $(BUILD)/peers

$(LEVMAR_ROOT)/.verified:
	@PYTHON='$(PYTHON)' sh tools/setup/fetch_levmar.sh '$(THIRD_PARTY)'

# 1 or 0; installed by this rule alone, and only when levmar's program is asked for.
$(OBJ)/peers.ceres: FORCE
	@mkdir -p $(@D)
	@$(if $(filter 0,$(CERES)),echo 0,CXX='$(CXX)' sh tools/setup/ceres.sh install) > $@.tmp
	@cmp -s $@.tmp $@ || cp $@.tmp $@
	@rm -f $@.tmp

# Not ours: warnings off.
$(OBJ)/levmar/%.o: $(OBJ)/compile.flags | $(LEVMAR_ROOT)/.verified
	@mkdir -p $(@D)
	$(call say,CC,$@)$(CC) $(CPPFLAGS) $(CFLAGS) -std=gnu11 $(filter-out -std=c11,$(REQUIRED)) -w \
	    -c $(LEVMAR_ROOT)/$*.c -o $@

$(OBJ)/tools/bench/peers_levmar.o: tools/bench/peers_levmar.c $(OBJ)/compile.flags | $(LEVMAR_ROOT)/.verified
	@mkdir -p $(@D)
	$(call say,CC,$<)$(COMPILE) -isystem $(LEVMAR_ROOT) -c $< -o $@

$(OBJ)/tools/bench/peers_main.o: tools/bench/peers_main.c $(OBJ)/compile.flags $(OBJ)/peers.ceres
	$(call say,CC,$<)$(COMPILE) $$(test "$$(cat $(OBJ)/peers.ceres)" = 1 || echo -DPEERS_NO_CERES) -c $< -o $@

# Eigen takes a while to compile.
$(PEERS_CERES): tools/bench/peers_ceres.cc $(wildcard tools/bench/peers_*.h) $(OBJ)/compile.flags $(OBJ)/peers.ceres
	$(call say,CXX,$<)if [ "$$(cat $(OBJ)/peers.ceres)" = 1 ]; then \
	    $(CXX) $(CPPFLAGS) -Iinclude -isystem /usr/include/eigen3 $(CXXFLAGS) -std=c++17 -Wall -Wextra -c $< -o $@; \
	else echo > $(OBJ)/peers_none.c && $(CC) -c $(OBJ)/peers_none.c -o $@; fi

$(BUILD)/peers: $(PEERS) $(PEERS_CERES) $(LEVMAR_OBJECTS) $(STATIC_IO) $(STATIC) $(BUILD)/link.flags
	$(call say,LINK,$@)if [ "$$(cat $(OBJ)/peers.ceres)" = 1 ]; then \
	    $(CXX) $(CXXFLAGS) $(LDFLAGS) -o $@ $(PEERS) $(PEERS_CERES) $(LEVMAR_OBJECTS) $(STATIC_IO) $(STATIC) \
	        -lceres -lglog -lz -lm; \
	else \
	    $(LINK) -o $@ $(PEERS) $(LEVMAR_OBJECTS) $(STATIC_IO) $(STATIC) -lz -lm; \
	fi

# ---- The paper's experiments -------------------------------------------------

PAPER := $(BUILD)/paper
STARTS ?= 100
# More options of tools/paper/paper.py; a Markdown file that gets the table too; what the data are.
PAPER_OPTIONS ?=
RESULTS ?=
NOTE ?=

paper: $(BUILD)/peers $(BUILD)/brdffit $(BUILD)/bench_boxes $(BUILD)/tests/ref/brute
	@[ -n $(call quote,$(DATA)) ] || { echo 'usage: make paper DATA=directory [STARTS=100]: MERL .binary[.gz] or CSV files' >&2; exit 2; }
	@PYTHON='$(PYTHON)' sh tools/setup/venv.sh '$(BUILD)/paper_venv' tools/paper/requirements.txt
	@PYTHONPYCACHEPREFIX='$(BUILD)/pycache' '$(BUILD)/paper_venv/bin/python' tools/paper/paper.py \
	    --build '$(BUILD)' --out '$(PAPER)' --starts '$(STARTS)' $(PAPER_OPTIONS) \
	    $(if $(RESULTS),--results $(call quote,$(RESULTS))) $(if $(NOTE),--note $(call quote,$(NOTE))) $(call quote,$(DATA))

# Keeps build/paper: its cache is hours of work.
clean: clean-peers
clean-peers:
	rm -f $(BUILD)/peers
