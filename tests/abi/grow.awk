# A header of a later version: each structure has more fields at its end, and there are more reasons to skip a sample.
# SPDX-License-Identifier: MIT
/^} brdffit_(samples|options|model|row|lobe|result|progress|box|texels|texel_results|many_stats|verification);$/ {
    print "    double grown_number;"
    print "    const double *grown_array;"
    print "    size_t grown_counts[3];"
}
/^} brdffit_io_options;$/ || /^} brdffit_table;$/ {
    print "    size_t grown_counts[3];"
}
/^    BRDFFIT_SKIP_COUNT$/ {
    print "    BRDFFIT_SKIP_GROWN,"
}
/^    BRDFFIT_IO_DROP_COUNT$/ {
    print "    BRDFFIT_IO_DROP_GROWN,"
}
{ print }
