/*
 * Fuzz target: text tables, also through gzip and by detection. SPDX-License-Identifier: MIT
 */
#include "fuzz/claims.h"
#include "fuzz/standalone.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    brdffit_io_options options;
    int format;

    for (format = BRDFFIT_IO_FORMAT_AUTO; format <= BRDFFIT_IO_FORMAT_CSV; format++) {
        brdffit_table *table = NULL;
        brdffit_error error;
        brdffit_status status;

        memset(&error, 0, sizeof error);
        brdffit_io_options_init(&options);
        options.format = (brdffit_io_format)format;
        status = brdffit_io_read_memory(data, size, &options, &table, &error);
        claim_all(status, table, &error);
    }
    return 0;
}

#if !defined(BRDFFIT_LIBFUZZER)

/* "theta_i,theta_o,r\n1,2,3\n" as gzip -9 makes it. */
static const unsigned char gzipped[] = {
    0x1f, 0x8b, 0x08, 0x00, 0x00, 0x00, 0x00, 0x00, 0x02, 0x03, 0x2b, 0xc9, 0x48, 0x2d,
    0x49, 0x8c, 0xcf, 0xd4, 0x29, 0x01, 0xd3, 0xf9, 0x3a, 0x45, 0x5c, 0x86, 0x3a, 0x46,
    0x3a, 0xc6, 0x5c, 0x00, 0x55, 0x3b, 0x0b, 0xbc, 0x18, 0x00, 0x00, 0x00,
};

static const struct fuzz_seed seeds[] = {
    SEED("theta_i,phi_i,theta_o,phi_o,r,g,b\n0,0,60,180,1,2,3\n60,90,30,-90,4,,6.5\n"),
    SEED("# comment\r\n\"theta_i_deg\";theta_o;w;\"I \"\"x\"\"\"\r\n10.5; 20 ;1e-3;-4\r\n\r\n"
         "1;2;0;0.12345678901234567\r\n"),
    SEED("\xef\xbb\xbflx\tly\tlz\tvx\tvy\tvz\tnx\tny\tnz\tY\n0\t0\t1\t0\t1\t1\t0\t0\t1\t5\n"),
    SEED("a,b,c,red,green,blue\n0.31830988618379069,0.31830988618379069,0,0.39467043851944567,0.385506,0.3736088\n"),
    SEED(
        "theta_i;theta_o;phi;wavelength (nm);f_r\n0;10;180;450;0,5\n0;10;180;550;0,25\n20;10;180;450;0,75\n20;10;180;550;1,5\n"),
    SEED(
        "my paint\n# theta_h | theta_d | phi_d | valid | r | r_std\n10 | 20 | 30 | 1 | 0.5 | 0.1\n20 | 30 | 40 | 1 | NA | 0.1\n"),
    SEED("sep=\t\ntheta_i\tphi_i\ttheta_o\tphi_o\tr\t\ndeg\tdeg\tdeg\tdeg\t%\t\n0\xc2\xb0\t0\t60\t\xe2\x88\x92"
         "180\t12%\t\n0\t0\t-50\t180\t1.5D1\t\n"),
    SEED("\xff\xfet\0h\0e\0t\0a\0_\0i\0,\0t\0h\0e\0t\0a\0_\0o\0,\0r\0\n\0\061\0,\0\062\0,\0\063\0\n\0"),
    {gzipped, sizeof gzipped},
};
static const size_t seed_count = sizeof seeds / sizeof *seeds;

FUZZ_MAIN(seeds, seed_count)
#endif
