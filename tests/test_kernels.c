/*
 * Every instruction set that runs here gives the bits of the scalar definition. SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/exp.h"
#include "kernels/kernels.h"
#include "base/lanes.h"

#define COUNT 4096

static void exponential_shape_is_kernel_exp(void **state)
{
    static double c[COUNT], phi[COUNT];
    int isa, ran = 0;
    size_t j;

    (void)state;
    for (j = 0; j < COUNT; j++) {
        c[j] = j < 64 ? 0.0 : ldexp(1.0 + (double)(j * 2654435761u % 4096) / 4096.0, (int)(j % 120) - 100);
    }
    for (isa = BRDFFIT_ISA_BASE; isa < BRDFFIT_ISA_COUNT; isa++) {
        const struct kernels *kernels = brdffit_kernels((brdffit_isa)isa);
        double u;

        assert_int_equal(kernels != NULL, brdffit_isa_supported((brdffit_isa)isa));
        for (u = 1e-3; kernels && u < 1e25; u *= 7.3) {
            kernels->exponential_shape(c, COUNT, u, phi);
            for (j = 0; j < COUNT; j++) {
                double expected = kernel_exp(-c[j] * u);

                assert_memory_equal(&phi[j], &expected, sizeof expected);
            }
        }
        ran += kernels != NULL;
    }
    assert_true(ran >= 1);
    assert_non_null(brdffit_kernels(BRDFFIT_ISA_AUTO));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exponential_shape_is_kernel_exp),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
