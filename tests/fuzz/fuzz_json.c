/*
 * Fuzz target: what `brdffit eval` reads, the JSON lines of fits. SPDX-License-Identifier: MIT
 */
#include "../../tools/brdffit/failure.h"
#include "../../tools/brdffit/json_read.h"
#include "fuzz/claims.h"
#include "fuzz/standalone.h"

/* What is taken for a fit can be evaluated, or the library says why not. */
static void claim_fit(const struct cli_fit *fit)
{
    static const double light[] = {0, 0, 1, 1, 0, 1}, view[] = {0, 0, 1, -1, 0, 1};
    const size_t channels = fit->model.channels;
    double *values = channels <= 1u << 16 ? calloc(2 * channels, sizeof *values) : NULL;
    brdffit_samples samples;
    brdffit_error error;

    CLAIM(channels > 0 && fit->model.lobes >= 1 && fit->model.lobes <= BRDFFIT_MAX_LOBES);
    claim_finite(fit->model.sigma, (size_t)fit->model.lobes, 1e-300, 1e308);
    claim_finite(fit->model.x, channels, 0.0, 1e308);
    claim_finite(fit->model.y, channels * (size_t)fit->model.lobes, 0.0, 1e308);
    brdffit_samples_init(&samples);
    samples.count = 2;
    samples.channels = channels;
    samples.light = light;
    samples.view = view;
    if (values) {
        brdffit_status status = brdffit_eval(&fit->model, &samples, values, &error);

        CLAIM(status == BRDFFIT_OK || (error.message && error.message[0]));
    }
    free(values);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const size_t select[] = {0, 1, 2};
    size_t i;

    for (i = 0; i < 3; i++) {
        struct cli_text text = {0};
        struct cli_fit fit;
        int code;

        brdffit_cli_text_add(&text, (const char *)data, size);
        code = brdffit_cli_fit_find(&fit, &text, "fits.json", "a.csv", select[i]);
        CLAIM(code == 0 || code == CLI_EXIT_DATA);
        if (code == 0) {
            claim_fit(&fit);
        }
        brdffit_cli_fit_free(&fit);
        brdffit_cli_text_free(&text);
    }
    return 0;
}

#if !defined(BRDFFIT_LIBFUZZER)

#define HEAD "{\"schema\":\"brdffit.fit/1\",\"file\":\"a.csv\",\"status\":\"certified\","
#define TAIL "\"channel_scale\":[0.5],\"rms\":[1e-3],\"norm\":\"l2\",\"e2\":0.25,\"channels\":[\"r\"]}\n"

static const struct fuzz_seed seeds[] = {
    SEED(HEAD "\"distribution\":\"ggx\",\"lobes\":1,\"sigma\":[0.2],\"x\":[0.1],\"y\":[[0.5]]," TAIL),
    SEED(HEAD "\"distributions\":[\"beckmann\",\"ward\"],\"lobes\":2,\"sigma\":[0.2,0.4],\"x\":[0.1],"
              "\"y\":[[0.5,0.25]],\"fresnel\":\"schlick\",\"f0\":[[0.04,1]],\"diffuse\":\"oren-nayar\","
              "\"x_more\":[[0.1]],\"masking\":\"smith\",\"quantity\":\"radiance\",\"weighting\":\"cosine\","
              "\"merl_samples\":\"d.csv\",\"merl_directions\":[[0,0,1,0,0.5,1]],\"max_incidence\":60," TAIL),
    SEED("{\"schema\":\"brdffit.fit/1\",\"file_bytes\":\"612e637376\",\"status\":\"error\",\"error\":{\"code\":"
         "\"format\",\"message\":\"no\\u0007\"}}\n{\"schema\":\"brdffit.comparison/1\"}\n"),
};
static const size_t seed_count = sizeof seeds / sizeof *seeds;

FUZZ_MAIN(seeds, seed_count)
#endif
