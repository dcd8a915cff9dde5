/* guard.h: files that are cut short, or fail, while they are mapped. SPDX-License-Identifier: MIT */
#ifndef BRDFFIT_CLI_GUARD_H
#define BRDFFIT_CLI_GUARD_H

/* From here to brdffit_cli_guard_end() a page of a mapped file that is not there any more reads as zeros. */
void brdffit_cli_guard_begin(void);

/* 1 when there was such a page: what was read is worth nothing. */
int brdffit_cli_guard_end(void);

#endif
