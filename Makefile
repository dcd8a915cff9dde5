# brdffit: build, test, install. GNU make; `make help` lists the targets.
# SPDX-License-Identifier: MIT

# ---- What a caller may set ---------------------------------------------------

BUILD ?= build
ECOS ?= 1
ECOS_DIR ?=
WERROR ?= 0

CFLAGS ?= -O2 -g
CPPFLAGS ?=
LDFLAGS ?=
# Tools of the compiler's target, as the compiler names them (Zig has an archiver of its own, and the host's for the rest).
tool_of = $(shell path=$$($(CC) -print-prog-name=$(1) 2> /dev/null); command -v "$$path" || echo $(1))
ifeq ($(origin AR),default)
AR := $(if $(filter zig,$(notdir $(firstword $(CC)))),$(firstword $(CC)) ar,$(call tool_of,ar))
endif
OBJCOPY ?= $(call tool_of,objcopy)
NM ?= $(call tool_of,nm)
PYTHON ?= python3
INSTALL ?= install
INSTALL_PROGRAM ?= $(INSTALL)
INSTALL_DATA ?= $(INSTALL) -m 644

PREFIX ?= /usr/local
prefix ?= $(PREFIX)
exec_prefix ?= $(prefix)
bindir ?= $(exec_prefix)/bin
libdir ?= $(exec_prefix)/lib
includedir ?= $(prefix)/include
datarootdir ?= $(prefix)/share
mandir ?= $(datarootdir)/man
pkgconfigdir ?= $(libdir)/pkgconfig

# make check installs Chromium where it may, for the test of report pages; 0: it does not (some 200 MB to
# download with all that it needs, 850 MB installed).
BROWSER ?= 1

# Tests read development data from here and skip what is absent.
BRDFFIT_DATA ?= ../shared/data

# ---- What it may not ---------------------------------------------------------

VERSION := $(shell sed -n 's/^.define BRDFFIT_VERSION_STRING "\(.*\)"$$/\1/p' include/brdffit.h)
SOVERSION := 1

# Kept whatever CFLAGS says. Proofs and reproducible bits need plain IEEE arithmetic: no contraction
# into FMA (and never -ffast-math: base/exp.h refuses it). errno from libm is never read.
REQUIRED := -std=c11 -ffp-contract=off -fno-math-errno -fvisibility=hidden -fPIC
# 32-bit x86: registers of more than a double's digits are not for us (src/base/ieee.h).
REQUIRED += $(if $(shell $(CC) $(CFLAGS) -dM -E -x c /dev/null 2> /dev/null | grep -w __i386__),-msse2 -mfpmath=sse)
# -Wno-psabi: 64-byte vectors (src/base/lanes.h) never cross a call, so that their ABI does not matter.
WARNINGS := -Wno-psabi -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
ifeq ($(WERROR),1)
WARNINGS += -Werror
endif
COMPILE = $(CC) $(CPPFLAGS) -Iinclude $(CFLAGS) $(WARNINGS) $(REQUIRED) -MMD -MP

# Downloads outlive `make clean` and are shared by the trees under BUILD.
THIRD_PARTY ?= $(BUILD)/third_party
VENV ?= $(BUILD)/venv

# One file of the library knows whether there is ECOS, and tests that ask: without it these have objects of their own, so
# that switching never mixes them and both builds share all others.
OBJ := $(BUILD)/obj
ASKING := src/solve/conic/socp.c $(shell grep -lE 'BRDFFIT_NO_ECOS|"fewer\.h"' /dev/null $(wildcard tests/*.c tests/*/*.c))
ASKING_OBJ := $(OBJ)$(if $(filter 0,$(ECOS)),/no_ecos)

# ---- Files -------------------------------------------------------------------

object = $(patsubst %.c,$(OBJ)/%.o,$(filter-out $(ASKING),$(1))) $(patsubst %.c,$(ASKING_OBJ)/%.o,$(filter $(ASKING),$(1)))
program = $(patsubst %,$(BUILD)/%,$(basename $(notdir $(1))))

# One folder a layer (src/README.md); src/io is a library of its own.
IO_SOURCES := $(sort $(wildcard src/io/*.c src/io/*/*.c))
CORE := $(call object,$(filter-out $(IO_SOURCES) $(if $(filter 0,$(ECOS)),src/solve/conic/ecos_memory.c),$(sort $(wildcard src/*/*.c src/*/*/*.c))))
# With its own copy of the one file that it shares with the core: libbrdffit.so exports what its header declares only.
IO := $(call object,$(IO_SOURCES) src/base/environment.c)
CLI := $(call object,$(sort $(wildcard tools/brdffit/*.c)))
GONIOMETER := $(call object,$(sort $(wildcard tools/goniometer/*.c)))
EXAMPLES := $(sort $(wildcard examples/*.c))
BENCH := $(sort $(wildcard tools/bench/bench_*.c))
TESTS := $(sort $(wildcard tests/test_*.c))
REFERENCES := $(sort $(wildcard tests/ref/*.c))
FUZZ := $(sort $(wildcard tests/fuzz/fuzz_*.c))
# What injects faults (tests/faults/campaign.py); ptrace(2) and LD_PRELOAD are Linux's.
FAULTS := $(if $(filter Linux,$(shell uname -s)),$(BUILD)/tests/faults/inject $(BUILD)/tests/faults/fail_alloc.so)
# The judge in quad precision needs a compiler with libquadmath (GCC, where double is not all that there is). Without one,
# neither the campaign is built nor the tests that include it.
QUADMATH := $(shell printf '\043include <quadmath.h>\n__float128 x;\n' | $(CC) -x c -c -o /dev/null - 2> /dev/null && echo -lquadmath)
QUAD_TESTS := $(shell grep -l '"quad/' /dev/null $(TESTS))
CAMPAIGN := $(if $(QUADMATH),$(BUILD)/tests/campaign)
ifeq ($(QUADMATH),)
TESTS := $(filter-out $(QUAD_TESTS),$(TESTS))
endif
TEST_SUPPORT := $(call object,$(wildcard tests/batch.c tests/verify.c tests/support.c))
QUAD := $(call object,$(filter-out tests/quad/campaign.c,$(sort $(wildcard tests/quad/*.c))))
SCRIPTS := $(sort $(wildcard tests/check_*.sh))
MANUALS := $(wildcard tools/brdffit/brdffit.1)

STATIC := $(BUILD)/libbrdffit.a
STATIC_IO := $(BUILD)/libbrdffit_io.a
SHARED := $(BUILD)/libbrdffit.so
SHARED_IO := $(BUILD)/libbrdffit_io.so
PKGCONFIG := $(BUILD)/brdffit.pc $(BUILD)/brdffit_io.pc
TEST_PROGRAMS := $(TESTS:tests/%.c=$(BUILD)/tests/%)
REFERENCE_PROGRAMS := $(REFERENCES:tests/%.c=$(BUILD)/tests/%)
FUZZ_PROGRAMS := $(FUZZ:tests/%.c=$(BUILD)/tests/%)
TOOLS := $(if $(CLI),$(BUILD)/brdffit) $(if $(GONIOMETER),$(BUILD)/goniometer)
BENCH_PROGRAMS := $(call program,$(BENCH))
EXAMPLE_PROGRAMS := $(EXAMPLES:%.c=$(BUILD)/%)

# ---- Targets -----------------------------------------------------------------

.PHONY: all core libraries programs examples test-programs demo deps deps-check check check-fast check-build check-c \
        check-scripts check-asan check-python check-docs docs install uninstall clean distclean help FORCE
.DELETE_ON_ERROR:
.SECONDARY:
.SUFFIXES:

all: libraries programs

# What needs nothing but a C compiler and its C library: to build for another machine, say.
core: $(STATIC) $(SHARED) $(BUILD)/brdffit.pc

libraries: $(STATIC) $(STATIC_IO) $(SHARED) $(SHARED_IO) $(PKGCONFIG)

programs: $(TOOLS) $(BENCH_PROGRAMS)

examples: $(EXAMPLE_PROGRAMS)

test-programs: $(TEST_PROGRAMS) $(REFERENCE_PROGRAMS) $(FUZZ_PROGRAMS) $(CAMPAIGN) $(FAULTS)

help:
	@echo 'make             libraries and programs, in $(BUILD)/'
	@echo 'make core        libbrdffit alone, which needs no other library (CC=TRIPLET-gcc: for another machine)'
	@echo 'make examples    programs of a page each that use the library, in $(BUILD)/examples/'
	@echo 'make demo        install what is missing, build, fit the shipped example'
	@echo 'make check       install what is missing, build, run every test (sanitizers included)'
	@echo 'make check-fast  what of it takes less than a minute, from a tree that is built: after each change'
	@echo 'make check-c check-scripts check-asan check-python check-docs   its parts'
	@echo 'make fuzz SECONDS=60  every fuzz target for that long (libFuzzer where CC is Clang, else our own driver)'
	@echo 'make faults      allocations, disks, deaths and files that fail, at every place (LONG=1: hours)'
	@echo 'make venv        the environment of the Python tests, of clang-format and of ruff, in $(VENV)'
	@echo 'make check-package  the Python package: wheel, sdist, editable, ECOS=0, removal, in fresh environments'
	@echo 'make deps        only install what is missing (Debian; elsewhere: say what is missing)'
	@echo 'make amalgamation  the core as one file, $(BUILD)/amalgamation/brdffit.c (tools/amalgamate has options)'
	@echo 'make docs        the documentation, in $(BUILD)/docs/html'
	@echo 'make install     to $(prefix) (PREFIX, DESTDIR, bindir, libdir, ... are honoured)'
	@echo 'make uninstall   remove what install put there'
	@echo 'make peers       levmar and Ceres, local solvers to compare with (downloads them; GPL)'
	@echo 'make bench [DATA="dir ..."] [QUICK=1]   run time against error, beside every peer'
	@echo 'make paper DATA=dir [STARTS=100]   the paper'\''s experiments on MERL or CSV files'
	@echo 'make stress      strained problems against 50-digit references (RESULTS=file.md: a table there)'
	@echo 'make export-errors DATA="dir ..."   what renderers make of measured materials, by target'
	@echo 'make clean       remove what was built; keeps downloads'
	@echo 'make distclean   remove $(BUILD)/ whole'
	@echo
	@echo 'ECOS=0           a library without the GPL solver ECOS (engine socp is then unsupported)'
	@echo 'ECOS_DIR=path    an unpacked source tree of ECOS instead of the download'
	@echo 'BROWSER=0        make check does not install Chromium; its one test is skipped where there is none'
	@echo 'BUILD=dir CC= CFLAGS= CPPFLAGS= LDFLAGS= WERROR=1 V=1'

# Compiler settings of a tree. A file is rewritten only when its text changes, and everything that
# depends on it is then rebuilt.
quote = '$(subst ','\'',$(1))'
define remember
	@mkdir -p $(@D)
	@printf '%s\n' $(call quote,$(1)) | cmp -s - $@ || printf '%s\n' $(call quote,$(1)) > $@
endef

$(OBJ)/compile.flags: FORCE
	$(call remember,$(COMPILE))

# Of what sees ECOS.
$(ASKING_OBJ)/ecos.flags: FORCE
	$(call remember,$(ECOS_FLAGS))

$(BUILD)/link.flags: FORCE
	$(call remember,$(CC) $(CFLAGS) $(LDFLAGS) $(AR) $(OBJ) $(VERSION) $(SOVERSION) $(CORE) $(IO) $(CLI) $(GONIOMETER))

$(BUILD)/install.flags: FORCE
	$(call remember,$(VERSION) $(prefix) $(exec_prefix) $(libdir) $(includedir))

# Headers and libraries that the build needs are looked for once a tree; nothing is installed here.
define look_for
	@mkdir -p $(@D)
	@CC='$(CC)' PYTHON='$(PYTHON)' sh tools/setup/deps.sh check $(1)
	@touch $@
endef

$(OBJ)/core.ok:
	$(call look_for,$(if $(ECOS_FETCH),ecos) compiler)

$(OBJ)/deps.ok: | $(OBJ)/core.ok
	$(call look_for,$(if $(CLI),cli) build)

# What a recipe does, in a word; V=1 shows its commands, make -s nothing.
silent := $(findstring s,$(filter-out --%,$(firstword -$(MAKEFLAGS))))
say = $(if $(filter 1,$(V))$(silent),,@printf '  %-6s %s\n' '$(1)' '$(2)'; )

# ---- ECOS --------------------------------------------------------------------

ECOS_VERSION := 2.0.14
ifeq ($(ECOS),0)
ECOS_OBJECTS :=
ECOS_ROOT :=
ECOS_FLAGS := -DBRDFFIT_NO_ECOS
else
ifeq ($(ECOS_DIR),)
ECOS_ROOT := $(THIRD_PARTY)/ecos-$(ECOS_VERSION)/ecos
ECOS_READY := $(THIRD_PARTY)/ecos-$(ECOS_VERSION)/.verified
ECOS_FETCH := $(if $(wildcard $(ECOS_READY)),,yes)
else
ECOS_ROOT := $(patsubst %/,%,$(if $(wildcard $(ECOS_DIR)/ecos/include/ecos.h),$(ECOS_DIR)/ecos,$(ECOS_DIR)))
ECOS_READY := $(ECOS_ROOT)/include/ecos.h
endif
ECOS_SOURCES := src/cone src/ecos src/equil src/expcone src/kkt src/preproc src/spla src/splamm src/timer \
    src/wright_omega external/ldl/src/ldl \
    $(addprefix external/amd/src/amd_,1 2 aat control defaults global info order post_tree postorder preprocess valid)
ECOS_OBJECTS := $(ECOS_SOURCES:%=$(OBJ)/ecos/%.o)
# DLONG and LDL_LONG: 64-bit indices. CTRLC=0: ECOS must not take over SIGINT.
ECOS_FLAGS := -DDLONG -DLDL_LONG -DCTRLC=0 -isystem $(ECOS_ROOT)/include \
    -isystem $(ECOS_ROOT)/external/amd/include -isystem $(ECOS_ROOT)/external/ldl/include \
    -isystem $(ECOS_ROOT)/external/SuiteSparse_config

$(THIRD_PARTY)/ecos-$(ECOS_VERSION)/.verified: | $(OBJ)/core.ok
	@PYTHON='$(PYTHON)' sh tools/setup/fetch_ecos.sh '$(THIRD_PARTY)'

ifneq ($(ECOS_DIR),)
$(ECOS_READY):
	@echo 'ECOS_DIR=$(ECOS_DIR) holds no source tree of ECOS (no include/ecos.h, no ecos/include/ecos.h).' >&2
	@exit 1
endif

# It does not check its mallocs: src/solve/conic/ecos_memory.c.
ECOS_MEMORY := -Dmalloc=brdffit_ecos_malloc -Dcalloc=brdffit_ecos_calloc -Dfree=brdffit_ecos_free

# Not ours: warnings off. No LTO, because the objects are linked into one before the archive is made.
$(OBJ)/ecos/%.o: $(OBJ)/compile.flags $(ASKING_OBJ)/ecos.flags | $(ECOS_READY)
	@mkdir -p $(@D)
	$(call say,CC,$@)$(CC) $(CPPFLAGS) $(ECOS_FLAGS) $(ECOS_MEMORY) $(CFLAGS) -std=gnu11 $(filter-out -std=c11,$(REQUIRED)) -fno-lto -w \
	    -c $(ECOS_ROOT)/$*.c -o $@
endif

# socp.o of the archive is our socp.c with all of ECOS, AMD and LDL inside and no name visible but ours. (Thunks of 32-bit
# x86 stay what they are: another file may lean on them.)
SOCP := $(ASKING_OBJ)/src/solve/conic/socp.o
SOCP_WHOLE := $(ASKING_OBJ)/socp.o
CORE_MEMBERS := $(if $(ECOS_OBJECTS),$(CORE:$(SOCP)=$(SOCP_WHOLE)),$(CORE))

$(SOCP): EXTRA = $(ECOS_FLAGS) -fno-lto
$(SOCP): $(ASKING_OBJ)/ecos.flags | $(ECOS_READY)

$(SOCP_WHOLE): $(SOCP) $(ECOS_OBJECTS)
	$(call say,LD,$@)$(CC) $(filter -m%,$(CFLAGS)) -r -nostdlib $^ -o $@.tmp && \
	    $(NM) -g --defined-only $@.tmp | awk 'NF == 3 && $$3 !~ /^(brdffit_|__x86)/ { print $$3 }' > $@.names && \
	    $(OBJCOPY) --localize-symbols=$@.names $@.tmp $@
	@rm -f $@.tmp $@.names

# ---- Instruction sets ---------------------------------------------------------

# Files named *_avx2.c and *_avx512.c hold the inner loops again for those; src/base/isa.c chooses at run time. A compiler
# that knows neither (another processor's) builds them empty.
accepts = $(shell echo 'int x;' | $(CC) $(1) -x c -c -o /dev/null - 2> /dev/null && echo yes)
ISA_FLAGS :=
AVX2_FLAGS := -mavx2
AVX512_FLAGS := -mavx512f -mavx512dq -mavx512vl
ifneq ($(call accepts,$(AVX2_FLAGS)),)
ISA_FLAGS += -DBRDFFIT_HAVE_AVX2
$(OBJ)/src/%_avx2.o: EXTRA = $(AVX2_FLAGS)
endif
ifneq ($(call accepts,$(AVX512_FLAGS)),)
ISA_FLAGS += -DBRDFFIT_HAVE_AVX512
$(OBJ)/src/%_avx512.o: EXTRA = $(AVX512_FLAGS)
endif

# ---- Compile -----------------------------------------------------------------

$(filter $(OBJ)/src/io/%,$(IO)): | $(OBJ)/deps.ok

define compile_source
	@mkdir -p $(@D)
	$(call say,CC,$<)$(COMPILE) -Isrc $(ISA_FLAGS) $(EXTRA) -c $< -o $@
endef

define compile_test
	@mkdir -p $(@D)
	$(call say,CC,$<)$(COMPILE) -Isrc -Itests $(if $(filter 0,$(ECOS)),-DBRDFFIT_NO_ECOS) -c $< -o $@
endef

$(OBJ)/src/%.o: src/%.c $(OBJ)/compile.flags | $(OBJ)/core.ok
	$(compile_source)

$(OBJ)/no_ecos/src/%.o: src/%.c $(OBJ)/compile.flags | $(OBJ)/core.ok
	$(compile_source)

$(OBJ)/tests/%.o: tests/%.c $(OBJ)/compile.flags | $(OBJ)/deps.ok
	$(compile_test)

$(OBJ)/no_ecos/tests/%.o: tests/%.c $(OBJ)/compile.flags | $(OBJ)/deps.ok
	$(compile_test)

# Packets of brdffit_shade.h, as a renderer would compile them.
$(OBJ)/tools/bench/bench_shade.o: EXTRA = -O3 $(if $(filter -DBRDFFIT_HAVE_AVX2,$(ISA_FLAGS)),$(AVX2_FLAGS))

# Tools and examples see the public headers only.
$(OBJ)/tools/%.o: tools/%.c $(OBJ)/compile.flags | $(OBJ)/deps.ok
	@mkdir -p $(@D)
	$(call say,CC,$<)$(COMPILE) $(EXTRA) -c $< -o $@

$(OBJ)/examples/%.o: examples/%.c $(OBJ)/compile.flags | $(OBJ)/deps.ok
	@mkdir -p $(@D)
	$(call say,CC,$<)$(COMPILE) -c $< -o $@

# ---- Link --------------------------------------------------------------------

LINK = $(CC) $(CFLAGS) $(LDFLAGS)

$(STATIC): $(CORE_MEMBERS) $(BUILD)/link.flags
	@rm -f $@
	$(call say,AR,$@)$(AR) rcs $@ $(CORE_MEMBERS)

$(STATIC_IO): $(IO) $(BUILD)/link.flags
	@rm -f $@
	$(call say,AR,$@)$(AR) rcs $@ $(IO)

# name.so -> name.so.1 -> name.so.0.2.0
define shared_library
	$(call say,LINK,$@)$(LINK) -shared -Wl,-soname,$(@F).$(SOVERSION) -o $@.$(VERSION) $(1)
	@ln -sf $(@F).$(VERSION) $@.$(SOVERSION)
	@ln -sf $(@F).$(SOVERSION) $@
endef

$(SHARED): $(CORE_MEMBERS) $(BUILD)/link.flags
	$(call shared_library,$(CORE_MEMBERS) -lm)

$(SHARED_IO): $(IO) $(SHARED) $(BUILD)/link.flags
	$(call shared_library,$(IO) -L$(BUILD) -lbrdffit -lz -lm)

# Both in one, found by its path and never by a soname: what the Python package carries.
$(BUILD)/whole/libbrdffit.so: $(CORE_MEMBERS) $(IO) $(BUILD)/link.flags
	@mkdir -p $(@D)
	$(call say,LINK,$@)$(LINK) -shared -Wl,-s -o $@ $(sort $(CORE_MEMBERS) $(IO)) -lz -lm

$(BUILD)/brdffit: $(CLI) $(STATIC_IO) $(STATIC) $(BUILD)/link.flags
	$(call say,LINK,$@)$(LINK) -o $@ $(CLI) $(STATIC_IO) $(STATIC) -lcjson -lpng -lz -lm -pthread

$(BUILD)/goniometer: $(GONIOMETER) $(STATIC_IO) $(STATIC) $(BUILD)/link.flags
	$(call say,LINK,$@)$(LINK) -o $@ $(GONIOMETER) $(STATIC_IO) $(STATIC) -lz -lm

$(BENCH_PROGRAMS): $(BUILD)/%: $(OBJ)/tools/bench/%.o $(STATIC_IO) $(STATIC) $(BUILD)/link.flags
	$(call say,LINK,$@)$(LINK) -o $@ $< $(STATIC_IO) $(STATIC) -lz -lm

$(EXAMPLE_PROGRAMS): $(BUILD)/examples/%: $(OBJ)/examples/%.o $(STATIC) $(BUILD)/link.flags
	@mkdir -p $(@D)
	$(call say,LINK,$@)$(LINK) -o $@ $< $(STATIC) -lm -pthread

# A test that needs linker options says so in its source: a line with "LDFLAGS:" and the options.
define link_test
	@mkdir -p $(@D)
	$(call say,LINK,$@)$(LINK) -o $@ $< $(TEST_SUPPORT) $(STATIC_IO) $(STATIC) \
	    $$(sed -n 's/^.*LDFLAGS: *\(-[^*]*[^* ]\).*$$/\1/p' tests/$*.c) -lcmocka -lz -lm
endef

ASKING_PROGRAMS := $(filter $(ASKING:tests/%.c=$(BUILD)/tests/%),$(TEST_PROGRAMS))
$(TEST_PROGRAMS): $(TEST_SUPPORT) $(STATIC_IO) $(STATIC) $(BUILD)/link.flags

$(filter-out $(ASKING_PROGRAMS),$(TEST_PROGRAMS)): $(BUILD)/tests/%: $(OBJ)/tests/%.o
	$(link_test)

$(ASKING_PROGRAMS): $(BUILD)/tests/%: $(ASKING_OBJ)/tests/%.o
	$(link_test)

$(REFERENCE_PROGRAMS): $(BUILD)/tests/%: $(OBJ)/tests/%.o $(STATIC_IO) $(STATIC) $(BUILD)/link.flags
	@mkdir -p $(@D)
	$(call say,LINK,$@)$(LINK) -o $@ $< $(STATIC_IO) $(STATIC) -lz -lm

# Fuzz targets, with the parsers of the command line. FUZZER: what links a fuzzer's main().
CLI_PARTS := $(filter-out %/main.o,$(CLI))
$(FUZZ_PROGRAMS): $(BUILD)/tests/%: $(OBJ)/tests/%.o $(CLI_PARTS) $(STATIC_IO) $(STATIC) $(BUILD)/link.flags
	@mkdir -p $(@D)
	$(call say,LINK,$@)$(LINK) $(FUZZER) -o $@ $< $(CLI_PARTS) $(STATIC_IO) $(STATIC) -lcjson -lpng -lz -lm -pthread

$(BUILD)/tests/faults/inject: $(OBJ)/tests/faults/inject.o $(BUILD)/link.flags
	@mkdir -p $(@D)
	$(call say,LINK,$@)$(LINK) -o $@ $<

$(BUILD)/tests/faults/fail_alloc.so: $(OBJ)/tests/faults/fail_alloc.o $(BUILD)/link.flags
	@mkdir -p $(@D)
	$(call say,LINK,$@)$(CC) -shared -o $@ $< -ldl

# The quad tests stand on the judge in quad precision too.
$(QUAD_TESTS:tests/%.c=$(BUILD)/tests/%): TEST_SUPPORT += $(QUAD) $(QUADMATH)
$(QUAD_TESTS:tests/%.c=$(BUILD)/tests/%): $(QUAD)

$(BUILD)/tests/campaign: $(OBJ)/tests/quad/campaign.o $(QUAD) $(STATIC_IO) $(STATIC) $(BUILD)/link.flags
	@mkdir -p $(@D)
	$(call say,LINK,$@)$(LINK) -o $@ $< $(QUAD) $(STATIC_IO) $(STATIC) $(QUADMATH) -lz -lm

$(BUILD)/%.pc: tools/setup/%.pc.in $(BUILD)/install.flags
	@sed -e 's|@VERSION@|$(VERSION)|' -e 's|@PREFIX@|$(prefix)|' -e 's|@EXEC_PREFIX@|$(exec_prefix)|' \
	    -e 's|@LIBDIR@|$(libdir)|' -e 's|@INCLUDEDIR@|$(includedir)|' $< > $@

# ---- Install -----------------------------------------------------------------

HEADERS := include/brdffit.h include/brdffit_io.h include/brdffit_shade.h
SHADE_HEADERS := $(sort $(wildcard include/brdffit_shade/*.h))

install: all
	$(INSTALL) -d '$(DESTDIR)$(bindir)' '$(DESTDIR)$(libdir)' '$(DESTDIR)$(includedir)' '$(DESTDIR)$(pkgconfigdir)'
	$(INSTALL_DATA) $(HEADERS) '$(DESTDIR)$(includedir)'
	$(INSTALL) -d '$(DESTDIR)$(includedir)/brdffit_shade'
	$(INSTALL_DATA) $(SHADE_HEADERS) '$(DESTDIR)$(includedir)/brdffit_shade'
	$(INSTALL_DATA) $(STATIC) $(STATIC_IO) '$(DESTDIR)$(libdir)'
	for name in libbrdffit libbrdffit_io; do \
	    $(INSTALL) -m 755 $(BUILD)/$$name.so.$(VERSION) '$(DESTDIR)$(libdir)' && \
	    ln -sf $$name.so.$(VERSION) '$(DESTDIR)$(libdir)'/$$name.so.$(SOVERSION) && \
	    ln -sf $$name.so.$(SOVERSION) '$(DESTDIR)$(libdir)'/$$name.so || exit 1; \
	done
	$(INSTALL_DATA) $(PKGCONFIG) '$(DESTDIR)$(pkgconfigdir)'
ifneq ($(CLI),)
	$(INSTALL_PROGRAM) $(BUILD)/brdffit '$(DESTDIR)$(bindir)'
endif
ifneq ($(MANUALS),)
	$(INSTALL) -d '$(DESTDIR)$(mandir)/man1'
	$(INSTALL_DATA) $(MANUALS) '$(DESTDIR)$(mandir)/man1'
endif

uninstall:
	rm -f $(HEADERS:include/%='$(DESTDIR)$(includedir)'/%) $(SHADE_HEADERS:include/%='$(DESTDIR)$(includedir)'/%)
	-rmdir '$(DESTDIR)$(includedir)/brdffit_shade' 2> /dev/null
	for name in libbrdffit libbrdffit_io; do \
	    for end in a so so.$(SOVERSION) so.$(VERSION); do rm -f '$(DESTDIR)$(libdir)'/$$name.$$end; done; \
	done
	rm -f '$(DESTDIR)$(pkgconfigdir)'/brdffit.pc '$(DESTDIR)$(pkgconfigdir)'/brdffit_io.pc
	rm -f '$(DESTDIR)$(bindir)'/brdffit '$(DESTDIR)$(mandir)'/man1/brdffit.1

# ---- Use it, test it ---------------------------------------------------------

deps:
	@CC='$(CC)' PYTHON='$(PYTHON)' sh tools/setup/deps.sh install $(if $(filter 0,$(ECOS))$(ECOS_DIR),,ecos) \
	    $(or $(DEPS),cli build test)

demo:
	@$(MAKE) --no-print-directory deps DEPS='cli build'
	@$(MAKE) --no-print-directory libraries $(TOOLS)
	@sh tools/setup/demo.sh '$(BUILD)'

# Figures and notebook run the library; a warning, a cell that fails or a bound above the truth ends the build.
DOCS_VENV ?= $(BUILD)/docs_venv
docs-venv:
	@PYTHON='$(PYTHON)' sh tools/setup/venv.sh '$(DOCS_VENV)' docs/requirements.txt
ifeq ($(ECOS),0)
docs:
	@echo 'The documentation compares both engines: it needs ECOS.' >&2; exit 1
check-docs:
	@echo 'The documentation compares both engines: not built without ECOS.'
else
docs: all docs-venv
	@'$(DOCS_VENV)/bin/python' docs/build.py '$(BUILD)'
check-docs: docs
endif
.PHONY: docs-venv

# The environment of the Python tests, of clang-format and of ruff.
venv:
	@PYTHON='$(PYTHON)' sh tools/setup/venv.sh '$(VENV)' tests/requirements.txt
.PHONY: venv

# ---- Trees beside the main one, for tests ----

# With sanitizers: what tests of C and of the command line run.
SANITIZE := -fsanitize=address,undefined -fno-sanitize-recover=all
ASAN := $(BUILD)/asan
build-asan:
	+@$(MAKE) --no-print-directory BUILD='$(ASAN)' THIRD_PARTY='$(THIRD_PARTY)' \
	    CFLAGS='-O1 -g1 -fno-omit-frame-pointer $(SANITIZE)' LDFLAGS='$(LDFLAGS) $(SANITIZE)' sanitized

sanitized: $(TOOLS) $(TEST_PROGRAMS)

# Without ECOS, and without a place to fetch it to. What does not ask for it is of the main tree.
build-ecos0: programs test-programs
	+@$(MAKE) --no-print-directory ECOS=0 ECOS_DIR= BUILD='$(BUILD)/ecos0' OBJ='$(OBJ)' THIRD_PARTY='$(BUILD)/ecos0/none' \
	    libraries programs test-programs

# With headers whose structures have grown at their ends. Bits are the same at any optimisation.
GROWN := $(BUILD)/grown
$(GROWN)/headers/%.h: include/%.h tests/abi/grow.awk
	@mkdir -p $(@D)
	@awk -f tests/abi/grow.awk $< > $@

build-grown: $(GROWN)/headers/brdffit.h $(GROWN)/headers/brdffit_io.h
	+@$(MAKE) --no-print-directory BUILD='$(GROWN)' THIRD_PARTY='$(THIRD_PARTY)' WERROR=0 CFLAGS='$(CFLAGS) -O1 -g0' \
	    CPPFLAGS='-I$(GROWN)/headers $(CPPFLAGS)' shared

shared: $(SHARED) $(SHARED_IO)

check-build: all examples test-programs

check-trees: check-build build-asan build-ecos0 build-grown venv $(if $(filter 0,$(ECOS)),,docs-venv)
.PHONY: build-asan sanitized build-ecos0 build-grown shared check-trees

# ---- Tests: units for tools/setup/run_tests.sh ----

PYTESTS ?= tests/cli tests/test_*.py python/tests
C_UNITS := $(TEST_PROGRAMS:%=programs:%)
SCRIPT_UNITS := $(SCRIPTS:%=scripts:%)
ASAN_UNITS := $(TEST_PROGRAMS:$(BUILD)/%=sanitized:$(ASAN)/%) sanitized-python:$(ASAN):tests/cli
PYTHON_UNITS := $(PYTESTS:%=python:$(BUILD):%)
DOCS_UNITS := $(if $(filter 0,$(ECOS)),,docs:$(BUILD))
# The C tests that are not among the longest, and of the rest what looks at most for its time.
SLOW := $(shell sed -n 's/^programs://p' /dev/null $(wildcard tests/longest.txt))
FAST_SCRIPTS := layers citations symbols format
FAST_PYTESTS := $(shell sed '/^\#/d' /dev/null $(wildcard tests/fast.txt))
FAST_UNITS := $(filter-out $(SLOW:%=programs:$(BUILD)/tests/%),$(C_UNITS)) \
    $(FAST_SCRIPTS:%=scripts:tests/check_%.sh) $(FAST_PYTESTS:%=python:$(BUILD):%)

# Scripts call make again, as it was called here: the compiler, its flags and relative paths are the same, or it would build
# everything anew. check_format.sh finds its tools in the tests' environment, but is not a reason to download it.
RUN = MAKEFLAGS= BRDFFIT_BUILD='$(BUILD)' BRDFFIT_DATA='$(abspath $(BRDFFIT_DATA))' MAKE='$(MAKE)' CC='$(CC)' \
    THIRD_PARTY='$(THIRD_PARTY)' ECOS='$(ECOS)' ECOS_DIR='$(ECOS_DIR)' WERROR='$(WERROR)' VENV='$(VENV)' \
    DOCS_VENV='$(DOCS_VENV)' sh tools/setup/run_tests.sh
# As many jobs as there are processors, unless the caller has said.
JOBS = $(if $(findstring jobserver,$(MAKEFLAGS)),,-j$(shell getconf _NPROCESSORS_ONLN 2> /dev/null || echo 1))

# Build everything, then run everything side by side: no step waits for another's last test.
check: deps
	@[ '$(BROWSER)' = 0 ] || sh tools/setup/deps.sh install browser || \
	    echo 'No Chromium: the test of the pages of brdffit report in a browser is skipped.' >&2
	+@failed=; \
	$(MAKE) --no-print-directory -k $(JOBS) check-trees || failed=1; \
	$(RUN) $(C_UNITS) $(SCRIPT_UNITS) $(ASAN_UNITS) $(PYTHON_UNITS) $(DOCS_UNITS) || failed=1; \
	if [ -n "$$failed" ]; then echo 'make check: FAILED' >&2; exit 1; fi; \
	echo 'make check: everything passed'

check-fast: check-build venv
	@$(RUN) $(FAST_UNITS)

check-c: check-build
	@$(RUN) $(C_UNITS)

check-scripts: check-build build-ecos0 build-grown
	@$(RUN) $(SCRIPT_UNITS)

check-asan: build-asan venv
	@$(RUN) $(ASAN_UNITS)

check-python: check-build venv
	@$(RUN) $(PYTHON_UNITS)

amalgamation:
	@$(PYTHON) tools/amalgamate/amalgamate.py -o '$(BUILD)/amalgamation' --cc '$(CC)'
.PHONY: amalgamation

# Virtual environments and downloads: not in `make check`. A copy of this goes through every way to install the package.
check-package:
	@PYTHON='$(PYTHON)' sh tools/setup/package.sh
.PHONY: check-package

clean:
	rm -rf $(BUILD)/obj $(BUILD)/tests $(BUILD)/asan $(BUILD)/ecos0 $(BUILD)/demo
	rm -rf $(BUILD)/examples $(BUILD)/grown $(BUILD)/install $(BUILD)/whole $(BUILD)/python $(BUILD)/pycache $(BUILD)/pytest_cache
	rm -f $(BUILD)/libbrdffit* $(BUILD)/*.pc $(BUILD)/*.flags $(BUILD)/brdffit $(BUILD)/goniometer $(BUILD)/bench_*
	rm -rf $(BUILD)/docs $(BUILD)/amalgamation $(BUILD)/firmware $(BUILD)/cross $(BUILD)/packaging $(BUILD)/cmake

distclean:
	rm -rf $(BUILD) python/src/brdffit/_lib

# In this order. The Python package's sdist has none of them: it builds the library only.
include $(wildcard tools/bench/peers.mk) $(wildcard tools/bench/bench.mk) $(wildcard tools/stress/stress.mk) $(wildcard tests/fuzz/fuzz.mk) $(wildcard tests/faults/faults.mk) $(wildcard tools/export/export.mk)

-include $(wildcard $(foreach tree,$(sort $(OBJ) $(ASKING_OBJ)),$(tree)/src/*/*.d $(tree)/src/*/*/*.d $(tree)/tests/*.d $(tree)/tests/*/*.d))
-include $(wildcard $(OBJ)/tools/*/*.d $(OBJ)/examples/*.d)
