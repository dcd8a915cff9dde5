/*
 * Numbers that mean the same everywhere. SPDX-License-Identifier: MIT
 */
#ifndef BRDFFIT_CONSTANTS_H
#define BRDFFIT_CONSTANTS_H

#define PI 3.14159265358979323846

#endif
