# make fuzz SECONDS=60: every target under the sanitizers, from the inputs in tests/fuzz/corpus on. SPDX-License-Identifier: MIT
#
# A compiler that has libFuzzer (Clang: make fuzz CC=clang) gets it; for any other, tests/fuzz/standalone.h looks for new
# ground itself, by the coverage that GCC tells. An input that breaks something stays in BUILD/fuzz/findings.

SECONDS ?= 60
FUZZ_TREE := $(BUILD)/fuzz
LIBFUZZER := $(shell echo 'int LLVMFuzzerTestOneInput(void) { return 0; }' | \
    $(CC) -fsanitize=fuzzer -x c -o /dev/null - 2> /dev/null && echo yes)
FUZZ_COVERAGE := $(if $(LIBFUZZER),-fsanitize=fuzzer-no-link -DBRDFFIT_LIBFUZZER,-fsanitize-coverage=trace-pc -DBRDFFIT_COVERAGE)

fuzz:
	+@$(MAKE) --no-print-directory BUILD='$(FUZZ_TREE)' THIRD_PARTY='$(THIRD_PARTY)' VENV='$(VENV)' ECOS=0 \
	    CFLAGS='-O1 -g -fno-omit-frame-pointer $(SANITIZE) $(FUZZ_COVERAGE)' LDFLAGS='$(LDFLAGS) $(SANITIZE)' \
	    FUZZER='$(if $(LIBFUZZER),-fsanitize=fuzzer)' fuzz-programs
	@sh tests/fuzz/run.sh '$(FUZZ_TREE)' '$(SECONDS)' $(if $(LIBFUZZER),libfuzzer,own)

fuzz-programs: $(FUZZ_PROGRAMS)
.PHONY: fuzz fuzz-programs
