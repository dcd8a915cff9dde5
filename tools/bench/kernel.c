/*
 * How much of the machine's arithmetic the node kernel uses: one CSV row per instruction set and length.
 *
 *     kernel
 *
 * Peak: multiplications and additions, kept apart as the library keeps them (-ffp-contract=off), on as many independent
 * registers as there are, with nothing else in the loop. The node kernel is what brdffit_moments_node() calls, with
 * everything in the first-level cache; its operations are counted from the source (NODE_FLOPS). It sees the library's
 * private headers, as tests do. SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "kernels/kernels.h"

/*
 * Additions, subtractions and multiplications per distinct c (src/kernels_sums.h, src/kernel_exp.h):
 *   exponential_shape  1 for -c u; exp: 3 for k, 4 for r, 11 x 2 of the polynomial, 3 and 2 to end it     35
 *   weigh              b b phi^2: 2; sum 1; times x and sum 2                                              5
 *   central            x - mean, its square: 2; weight 2; three products with it: 3; three sums: 3        10
 *   functionals        each: x - mean 1; term 1; two moments 2; three sums 3                               7
 * Comparisons, selections and conversions are not counted.
 */
#define NODE_FLOPS(functionals) (35.0 + 5.0 + 10.0 + 7.0 * (functionals))

#define MOST 4096
#define ROUNDS 20000

static double now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static volatile double sink;

/* `registers` vectors of `bytes`: x = x m + p, a dependent chain each. Returns flops per second. */
#define PEAK(name, target_attribute, bytes, registers)                                                                 \
    target_attribute static double name(void)                                                                          \
    {                                                                                                                  \
        typedef double wide __attribute__((vector_size(bytes)));                                                       \
        wide x[registers], m, p;                                                                                       \
        double begun, spent;                                                                                           \
        int i, j;                                                                                                      \
                                                                                                                       \
        for (j = 0; j < (int)(bytes / sizeof(double)); j++) {                                                          \
            m[j] = 0.999;                                                                                              \
            p[j] = 0.001;                                                                                              \
        }                                                                                                              \
        for (j = 0; j < (registers); j++) {                                                                            \
            x[j] = p * (double)(j + 1);                                                                                \
        }                                                                                                              \
        begun = now();                                                                                                 \
        for (i = 0; i < 20 * ROUNDS; i++) {                                                                            \
            _Pragma("GCC unroll 32") for (j = 0; j < (registers); j++)                                                 \
            {                                                                                                          \
                x[j] = x[j] * m + p;                                                                                   \
            }                                                                                                          \
        }                                                                                                              \
        spent = now() - begun;                                                                                         \
        for (j = 1; j < (registers); j++) {                                                                            \
            x[0] += x[j];                                                                                              \
        }                                                                                                              \
        sink = x[0][0];                                                                                                \
        return 20.0 * ROUNDS * (registers) * (bytes / sizeof(double)) * 2.0 / spent;                                   \
    }

#if defined(__x86_64__)
PEAK(peak_base, , 16, 12)
PEAK(peak_avx2, __attribute__((target("avx2"))), 32, 12)
PEAK(peak_avx512, __attribute__((target("avx512f"))), 64, 16)
#else
PEAK(peak_base, , 16, 16)
#define peak_avx2 peak_base
#define peak_avx512 peak_base
#endif

static double best_of(double (*peak)(void))
{
    double most = 0.0;
    int i;

    for (i = 0; i < 5; i++) {
        double found = peak();

        most = found > most ? found : most;
    }
    return most;
}

static double *numbers(size_t count)
{
    double *v = aligned_alloc(64, (count * sizeof *v + 63) / 64 * 64);
    size_t i;

    if (!v) {
        exit(1);
    }
    for (i = 0; i < count; i++) {
        v[i] = (double)(i % 97 + 1) / 97.0;
    }
    return v;
}

/* Seconds of one node of n distinct c; the best of five, since what disturbs only adds. */
static double node_seconds(const struct kernels *k, size_t n, size_t functionals)
{
    double *c = numbers(n), *bb = numbers(n), *linear = numbers(functionals * n), *phi = numbers(n), best = 1e9;
    struct functional *out = malloc(functionals * sizeof *out);
    long rounds = (long)(64.0 * ROUNDS / (double)n), i;
    int pass;

    for (pass = 0; out && pass < 5; pass++) {
        double begun = now(), m[3], h, h1, spent;

        for (i = 0; i < rounds; i++) {
            k->exponential_shape(c, n, 1.0 + 1e-9 * (double)i, phi);
            h = k->weigh(bb, phi, c, n, &h1);
            k->central(bb, phi, c, h1 / h, n, m);
            k->functionals(linear, functionals, phi, c, h1 / h, n, out);
            sink = m[0] + out[0].f0;
        }
        spent = (now() - begun) / (double)rounds;
        best = spent < best ? spent : best;
    }
    free(c);
    free(bb);
    free(linear);
    free(phi);
    free(out);
    return best;
}

int main(void)
{
    static const struct {
        brdffit_isa isa;
        double (*peak)(void);
    } set[] = {{BRDFFIT_ISA_BASE, peak_base}, {BRDFFIT_ISA_AVX2, peak_avx2}, {BRDFFIT_ISA_AVX512, peak_avx512}};
    static const size_t length[] = {32, 88, 1024};
    const size_t functionals = 4; /* three channels and the diffuse term */
    size_t i, j;

    printf("isa,distinct_c,functionals,peak_flops,node_seconds,node_flops,fraction\n");
    for (i = 0; i < sizeof set / sizeof *set; i++) {
        const struct kernels *k = brdffit_kernels(set[i].isa);
        double peak = k ? best_of(set[i].peak) : 0.0;

        for (j = 0; k && j < sizeof length / sizeof *length; j++) {
            double spent = node_seconds(k, length[j], functionals);
            double flops = NODE_FLOPS((double)functionals) * (double)length[j] / spent;

            printf("%s,%zu,%zu,%.4g,%.4g,%.4g,%.4g\n", brdffit_isa_string(set[i].isa), length[j], functionals, peak,
                   spent, flops, flops / peak);
        }
    }
    return 0;
}
