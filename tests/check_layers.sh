#!/bin/sh
# Folders are layers: includes and calls point down, without circles (check_layers.py has the table).
# SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."
build=${BRDFFIT_BUILD:-build}
"${PYTHON:-python3}" tests/check_layers.py "$build/obj"
