"""The same measurement in every dress: understood and told, warned of, or refused; never a wrong answer in silence.

Each case is a text and what has to come of it: `same` (the known roughness, and what was inferred in the words given),
`warned` (a fit, and the words among the warnings), `refused` (exit 3, and the words in the message).

SPDX-License-Identifier: MIT
"""
import numpy as np
import pytest

import harness
import readings
from readings import ANGLES, LIGHT, NAMES, ROWS, VALUES, VIEW, cell, column, fields, lines, with_column

COUNT = len(ROWS)


def renamed(**names):
    return [names.get(name, name) for name in NAMES]


def commas(text):
    return text.replace(".", ",")


def radians(text):
    return "%.7f" % np.radians(float(text))


def same(text, *told, options=(), channels=None, tolerance=1e-3, used=COUNT):
    return "same", text, told, options, {"channels": channels, "tolerance": tolerance, "used": used}


def warned(text, *told, options=()):
    return "warned", text, told, options, {}


def refused(text, *told, options=(), code=3):
    return "refused", text, told, options, {"code": code}


DIALECTS = {
    "plain": same(lines()),
    "semicolons": same(lines(by=";")),
    "tabs": same(lines(by="\t")),
    "bars": same(lines(by="|"), "separated by |"),
    "spaced_bars": same(lines(by=" | "), "separated by |"),
    "blanks": same(lines(by=" "), "separated by blanks"),
    "many_blanks": same(lines(by="    ", before=""), "separated by blanks"),
    "blanks_and_tabs": same(lines([n + " " for n in NAMES], [[f + "  \t " for f in row] for row in ROWS], by=" ")),
    "indented_blanks": same(lines([" " + NAMES[0], *NAMES[1:]], [["  " + r[0], *r[1:]] for r in ROWS], by=" ")),
    "crlf": same(lines(end="\r\n")),
    "cr": same(lines(end="\r")),
    "semicolons_decimal_comma": same(lines(rows=fields(commas), by=";"), "decimal comma"),
    "tabs_decimal_comma": same(lines(rows=fields(commas), by="\t"), "decimal comma"),
    "blanks_decimal_comma": same(lines(rows=fields(commas), by=" "), "decimal comma"),
    "bars_decimal_comma": same(lines(rows=fields(commas), by="|"), "decimal comma"),
    "quoted_decimal_comma": same(lines(rows=fields(lambda f: '"%s"' % commas(f))), "decimal comma"),
    "decimal_comma_exponents": same(lines(rows=fields(lambda f: commas("%.5e" % float(f)), 4), by=";"), "decimal comma"),
    "unquoted_decimal_comma": refused(lines(rows=fields(commas, 4)), "more fields"),
    "thousands": refused(lines(rows=fields(lambda f: f'"{20000 * float(f):,.2f}"', 4)), "thousands"),
    "thousands_whole": refused(lines(rows=fields(lambda f: f'"{2e4 * float(f):,.0f}"', 4)), "thousands"),
    "thousands_points": refused(lines(rows=fields(
        lambda f: f"{2e4 * float(f):,.2f}".replace(",", "_").replace(".", ",").replace("_", "."), 4), by=";"), "thousands"),
    "thousands_blanks": refused(lines(rows=fields(lambda f: f"{2e5 * float(f):,.0f}".replace(",", " "), 4)), "thousands"),
    "thousands_apostrophes": refused(lines(rows=fields(lambda f: f"{2e5 * float(f):,.1f}".replace(",", "'"), 4)), "thousands"),
    "comma_and_point": refused(lines(rows=cell(ROWS, 5, 4, '"0,25"')), "decimal commas and decimal points", "0,25"),
    "fortran_d": same(lines(rows=fields(lambda f: ("%.6E" % float(f)).replace("E", "D"), 4))),
    "fortran_small_d": same(lines(rows=fields(lambda f: ("%.6e" % float(f)).replace("e", "d"), 4), by=" ")),
    "plus_signs": same(lines(rows=fields(lambda f: "+" + f))),
    "unicode_minus": same(lines(rows=column(ROWS, 3, lambda f: "\u2212180" if f == "180" else f)), "of Unicode"),
    "no_break_blanks": same(lines([n + "\u00a0" for n in NAMES], fields(lambda f: "\u00a0" + f)), "of Unicode"),
    "thin_blanks": same(lines(rows=fields(lambda f: f + "\u2009"), by=";"), "of Unicode"),
    "degree_signs": same(lines(rows=fields(lambda f: f + "°", 0, 4)), "degree sign"),
    "ordinal_signs": same(lines(rows=fields(lambda f: f + " º", 0, 4)), "degree sign"),
    "degree_signs_latin": same(lines(rows=fields(lambda f: f + "°", 0, 4)).encode("latin-1"), "degree sign"),
    "percent_signs": same(lines(rows=fields(lambda f: "%.6g%%" % (100 * float(f)), 4)), "percent"),
    "utf8_mark": same("\ufeff" + lines()),
    "utf16": same(("\ufeff" + lines()).encode("utf-16-le"), "UTF-16"),
    "utf16_big": same(("\ufeff" + lines()).encode("utf-16-be"), "UTF-16"),
    "utf16_without_mark": same(lines(end="\r\n").encode("utf-16-le"), "UTF-16"),
    "utf16_big_without_mark": same(lines(by="\t").encode("utf-16-be"), "UTF-16"),
    "quoted_everything": same(lines(['"%s"' % n for n in NAMES], fields(lambda f: '"%s"' % f))),
    "sep_line": same(lines(by=";", above=["sep=;"]), "sep="),
    "sep_line_quoted": same(lines(by=";", above=['"sep=;"']), "sep="),
    "sep_line_tab": same(lines(by="\t", above=["SEP=\t"]), "sep="),
    "comments_percent": same(lines(above=["% home made", "%"])),
    "comments_slashes": same(lines(above=["// home made"], after="// end\n")),
    "comments_inside": same(lines(rows=[*ROWS[:9], ["# pause"], *ROWS[9:]])),
    "hash_header": same(lines(["#theta_i", *NAMES[1:]]), "taken as the header"),
    "hash_blank_header": same(lines(["# theta_i", *NAMES[1:]], by=" "), "taken as the header"),
    "percent_header": same(lines(["%theta_i", *NAMES[1:]], by="\t", above=["% my paint"]), "taken as the header"),
    "title_rows": same(lines(above=["My paint", "Measured,Tuesday", ""]), "header is line 4", "My paint"),
    "title_of_fields": same(lines(above=["Sample;A 12;;", "Angle of incidence;0 to 45;;"], by=";"), "skipped"),
    "title_with_numbers": same(lines(above=["Report 2024", "Operator: N. N., Room 5"]), "skipped"),
    "units_row": same(lines(below_header=["deg,deg,deg,deg,1/sr,1/sr,1/sr"]), "taken as units"),
    "units_row_brackets": same(lines(below_header=["[deg],[deg],[deg],[deg],[sr^-1],[sr^-1],[sr^-1]"]), "taken as units"),
    "units_row_radians": same(lines(rows=fields(radians, 0, 4), below_header=["rad,rad,rad,rad,1/sr,1/sr,1/sr"]), "radians"),
    "units_row_of_others": refused(lines(below_header=["mrad,mrad,mrad,mrad,1/sr,1/sr,1/sr"]), "neither degrees nor radians",
                                   "mrad"),
    "trailing_commas": same(lines(rows=[[*r, ""] for r in ROWS]), "beyond the header"),
    "trailing_commas_many": same(lines(rows=[[*r, "", "", ""] for r in ROWS]), "beyond the header"),
    "trailing_in_header": same(lines([*NAMES, ""]), "left out: it is empty"),
    "trailing_in_both": same(lines([*NAMES, "", ""], [[*r, "", ""] for r in ROWS]), "left out: it is empty"),
    "blank_rows_of_commas": same(lines(rows=[*ROWS[:9], [""] * 7, [""] * 7, *ROWS[9:], [""] * 7])),
    "empty_column_inside": same(lines(*with_column("", [""] * COUNT, at=4)), "left out: it is empty"),
    "header_again": same(lines(rows=[*ROWS[:40], NAMES, *ROWS[40:]]), "repeat the header"),
    "total_row": refused(lines(rows=[*ROWS, ["mean", "", "", "", "1", "2", "3"]]), "not a number", "'mean'"),
    "total_row_german": refused(lines(rows=[*ROWS, ["", "", "", "Summe", "1", "2", "3"]]), "'Summe'"),
    "short_row": refused(lines(rows=[*ROWS, ROWS[0][:5]]), "fewer fields"),
    "long_row": refused(lines(rows=[*ROWS, [*ROWS[0], "1"]]), "more fields"),
    "spreadsheet": refused(b"PK\x03\x04\x14\x00\x06\x00\x08\x00\x00\x00" + bytes(range(200)), "spreadsheet"),
    "no_header": refused(lines()[len(",".join(NAMES)) + 1:], "holds numbers"),
    "json": refused("".join('{"theta_i": %s, "theta_o": %s, "r": %s}\n' % (r[0], r[2], r[4]) for r in ROWS), "JSON"),
    "xml": refused("<?xml version='1.0'?>\n<a theta_i='1', theta_o='2'/>\n", "XML"),
    "markdown": same(lines(["| " + NAMES[0], *NAMES[1:6], "b |"], [["| " + r[0], *r[1:6], r[6] + " |"] for r in ROWS], by=" | ")),
    "r_row_names": refused(lines(rows=[['"%d"' % k, *r] for k, r in enumerate(ROWS)], by=" "), "more fields"),
    "letters_o_for_0": refused(lines(rows=cell(ROWS, 7, 4, "O.13")), "not a number", "'O.13'"),
}

MISSING = {
    text: same(lines(rows=cell(cell(ROWS, 7, 5, text), 30, 4, text)), "2 rows without a value", used=COUNT - 2)
    for text in ("NaN", "nan", "NA", "N/A", "#N/A", "null", "None", "-", "--", "\u2013", "\u2014", "#DIV/0!", "#VALUE!", "n.d.",
        ".",
                 "?", "missing", "-nan(ind)")}
MISSING["empty"] = same(lines(rows=cell(ROWS, 7, 5, "")), used=COUNT - 1)
MISSING["whole_row"] = same(lines(rows=[*ROWS, ["NaN"] * 7]), "1 row without a value")
MISSING["whole_channel"] = refused(lines(rows=column(ROWS, 5, lambda f: "NA")), "no value")
MISSING["direction"] = refused(lines(rows=cell(ROWS, 7, 2, "NA")), "no value", "'NA'", "line 9, field 3")

COLUMNS = {
    "capitals": same(lines([n.upper() for n in NAMES])),
    "first_capitals": same(lines([n.capitalize() for n in NAMES])),
    "units_brackets": same(lines([n + " (deg)" for n in NAMES[:4]] + [n + " (1/sr)" for n in NAMES[4:]])),
    "units_square": same(lines([n + "[°]" for n in NAMES[:4]] + NAMES[4:])),
    "units_suffix": same(lines([n + "_deg" for n in NAMES[:4]] + NAMES[4:])),
    "units_words": same(lines([n + " in degrees".replace(" in", "") for n in NAMES[:4]] + NAMES[4:])),
    "units_radians": same(lines([n + "_rad" for n in NAMES[:4]] + NAMES[4:], fields(radians, 0, 4)), "radians"),
    "units_radians_brackets": same(lines([n + " [rad]" for n in NAMES[:4]] + NAMES[4:], fields(radians, 0, 4)), "radians"),
    "radians_that_are_degrees": refused(lines(renamed(phi_i="phi_i_rad", phi_o="phi_o_rad")), "radians (phi)"),
    "mixed_units": same(lines(renamed(phi_i="phi_i_rad", phi_o="phi_o_rad"), column(column(ROWS, 1, radians), 3, radians))),
    "blanks_inside": same(lines(["theta i", "phi i", "theta o", "phi o", *NAMES[4:]])),
    "camel": same(lines(["thetaIn", "phiIn", "thetaOut", "phiOut", *NAMES[4:]])),
    "camel_capital": same(lines(["ThetaI", "PhiI", "ThetaO", "PhiO", *NAMES[4:]])),
    "glued": same(lines(["thetai", "phii", "thetao", "phio", *NAMES[4:]])),
    "in_out": same(lines(["theta_in", "phi_in", "theta_out", "phi_out", *NAMES[4:]])),
    "incident_reflected": same(lines(["theta_inc", "phi_inc", "theta_r", "phi_r", *NAMES[4:]])),
    "incident_scattered": same(lines(["theta_i", "phi_i", "theta_s", "phi_s", *NAMES[4:]])),
    "sun_view": same(lines(["theta_s", "phi_s", "theta_v", "phi_v", *NAMES[4:]])),
    "satellites": same(lines(["SZA", "SAA", "VZA", "VAA", *NAMES[4:]])),
    "zenith_azimuth": same(lines(["solar zenith angle", "solar azimuth angle", "view zenith angle", "view azimuth angle",
        *NAMES[4:]])),
    "polar_azimuth": same(lines(["Light polar", "Light azimuth", "Detector polar", "Detector azimuth", *NAMES[4:]])),
    "detector": same(lines(["theta_i", "phi_i", "theta_d", "phi_d", *NAMES[4:]])),
    "greek": same(lines(["θ_i", "φ_i", "θ_o", "φ_o", *NAMES[4:]])),
    "greek_glued": same(lines(["θi", "φi", "θr", "φr", *NAMES[4:]])),
    "latex": same(lines([r"\theta_i", r"\phi_i", r"\theta_r", r"\phi_r", *NAMES[4:]])),
    "azimuth_beside_theta": same(lines(renamed(phi_i="azimuth_i", phi_o="azimuth_o"))),
    "az": same(lines(renamed(phi_i="az_i", phi_o="az_o"))),
    "angle_of_incidence": same(lines(["Angle of incidence", "phi_i", "Scatter angle", "phi_s", *NAMES[4:]])),
    "order": same(lines([NAMES[k] for k in (6, 2, 4, 0, 5, 3, 1)], [[r[k] for k in (6, 2, 4, 0, 5, 3, 1)] for r in ROWS])),
    "numbered_azimuths": refused(lines(renamed(phi_i="phi_1", phi_o="phi_2")), "looks like a direction", "'phi_1'"),
    "pandas_suffix": refused(lines(renamed(phi_i="phi_i.1", phi_o="phi_o.1")), "looks like a direction"),
    "foreign_azimuth": refused(lines(renamed(phi_i="phi_gonio", phi_o="phi_x")), "--column"),
    "bare_theta": refused(lines(renamed(theta_o="theta")), "theta_o"),
    "azimuth_of_light_alone": refused(lines(["theta_i", "phi_i", "theta_o", "r"], [[*r[:3], r[4]] for r in ROWS]), "phi_o"),
    "light_at_0": same(lines(["theta_i", "theta_o", "phi_o", "r"], [[r[0], r[2], r[3], r[4]] for r in ROWS]),
        "azimuth of the light",
                       tolerance=5e-3),
    "named": same(lines(["alpha", "p1", "beta", "p2", *NAMES[4:]]), options=[
        "--column", "theta_i=alpha,phi_i=p1", "--column", "theta_o=beta,phi_o=p2"]),
    "named_by_number": same(lines(["a1", "a2", "a3", "a4", *NAMES[4:]]), options=["--column",
        "theta_i=#1,phi_i=#2,theta_o=#3,phi_o=#4"]),
    "named_that_is_not_there": refused(lines(), "no column of this name", "'x'", options=["--column", "phi_i=x"], code=2),
    "named_role_that_is_none": refused(lines(), "role=name", options=["--column", "phi=r,psi=g"], code=2),
    "channels": same(lines(*with_column("foo", VALUES[:, 0])), options=["--channels", "r,g"], channels=["r", "g"],
                     tolerance=5e-3),
    "channels_that_are_not_there": refused(lines(), "'q'", options=["--channels", "r,q"], code=2),
    "derived_angle": same(lines(*with_column("theta_h", range(COUNT))), "theta_h is left out"),
    "twice_in_two_units": refused(lines(*with_column("theta_i_rad", [radians(r[0]) for r in ROWS])), "twice"),
}

BESIDE = {
    "running_number": same(lines(*with_column("index", range(COUNT), at=0)), "index is left out"),
    "running_number_unknown": same(lines(*with_column("foo", range(5, 5 + COUNT), at=0)), "running number", channels=["r", "g",
        "b"]),
    "index_without_name": same(lines(*with_column("", range(COUNT), at=0)), "no name", channels=["r", "g", "b"]),
    "unnamed_0": same(lines(*with_column("Unnamed: 0", range(COUNT), at=0)), "left out", channels=["r", "g", "b"]),
    "hash_index": same(lines(*with_column("#", range(COUNT), at=3)), "left out", channels=["r", "g", "b"]),
    "remark": same(lines(*with_column("note", ["ok"] * COUNT)), "note is left out", channels=["r", "g", "b"]),
    "text_unknown": same(lines(*with_column("foo", ["a%d" % k for k in range(COUNT)])), "text", channels=["r", "g", "b"]),
    "temperature": same(lines(*with_column("Temp (C)", ["%.1f" % (20 + k / 50) for k in range(COUNT)])), "left out",
        channels=["r", "g", "b"]),
    "timestamp": same(lines(*with_column("time", ["12:%02d" % (k % 60) for k in range(COUNT)])), "left out", channels=["r", "g",
        "b"]),
    "rising": same(lines(*with_column("t", ["%.3f" % (1.7 * k + 0.3 * (k % 3)) for k in range(COUNT)])), "rises or falls",
        channels=["r", "g", "b"]),
    "constant": same(lines(*with_column("foo", [3.5] * COUNT)), "same in every row", channels=["r", "g", "b"]),
    "one_wavelength": same(lines(*with_column("wavelength", [550] * COUNT, at=4)), "wavelength is the same", channels=["r", "g",
        "b"]),
    "dark_level": warned(lines(*with_column("dark", [12 + k % 2 for k in range(COUNT)])), "dark is left out"),
    "material": same(lines(*with_column("material", ["oak"] * COUNT)), "same in every row", channels=["r", "g", "b"]),
    "materials": refused(lines(*with_column("material", ["oak", "elm"] * (COUNT // 2))), "several kinds", "'material'"),
    "bands": refused(lines(*with_column("channel", ["R", "G"] * (COUNT // 2))), "several kinds"),
    "polarisations": refused(lines(*with_column("polarization", [0, 90] * (COUNT // 2))), "several kinds"),
    "samples_of_several": refused(lines(*with_column("sample", [1] * 60 + [2] * (COUNT - 60))), "several kinds"),
    "mask": refused(lines(*with_column("valid", [k % 9 > 0 for k in range(COUNT)])), "marks rows"),
    "mask_of_all": same(lines(*with_column("mask", [1] * COUNT)), "left out", channels=["r", "g", "b"]),
    "mask_unknown": refused(lines(*with_column("foo", [int(k % 9 > 0) for k in range(COUNT)])), "0 and 1", "'foo'"),
    "mask_as_weight": same(lines(*with_column("valid", [int(k % 9 > 0) for k in range(COUNT)])), options=["--column",
        "weight=valid"],
                           used=COUNT - (COUNT + 8) // 9, tolerance=3e-3),
    "weight": same(lines(*with_column("Weight", [1] * COUNT)), channels=["r", "g", "b"]),
    "weights": same(lines(*with_column("weights", [2] * COUNT)), channels=["r", "g", "b"]),
    "w_beside_rgb": refused(lines(*with_column("w", ["%.5g" % v for v in VALUES.mean(1)])), "weight or white"),
    "w_chosen": same(lines(*with_column("w", ["%.5g" % v for v in VALUES.mean(1)])), options=["--column", "channel=w"],
                     channels=["r", "g", "b", "w"]),
    "w_alone": same(lines([*NAMES[:5], "w"], [[*r[:5], "1"] for r in ROWS]), "taken as weights", channels=["r"], tolerance=3e-3),
    "sigma": warned(lines(*with_column("sigma", ["%g" % (0.01 * (1 + k % 3)) for k in range(COUNT)])), "sigma is left out",
                    "--column uncertainty"),
    "spread_of_a_channel": warned(lines(*with_column("r_std", ["%g" % (0.01 * (1 + k % 3)) for k in range(COUNT)])),
        "r_std is left out"),
    "uncertainty_constant": same(lines(*with_column("err", [0.01] * COUNT)), "err is left out", channels=["r", "g", "b"]),
    "standard_deviation": same(lines(*with_column("Standard deviation", [0.01] * COUNT)), channels=["r", "g", "b"], tolerance=2e-2),
    "another_channel": same(lines(*with_column("nir", ["%.6g" % (2 * v) for v in VALUES[:, 1]])), "nir is taken as a channel",
                            channels=["r", "g", "b", "nir"]),
    "wavelengths_as_names": same(lines([*NAMES[:4], "450 nm", "550 nm", "λ650"]), channels=["450 nm", "550 nm", "λ650"]),
    "decibels": refused(lines(renamed(r="brdf_dB")[:5], [[*r[:4], "%.6g" % (10 * np.log10(float(r[4])))] for r in ROWS]),
        "logarithm"),
    "log10": refused(lines(renamed(r="log10(brdf)")[:5], [[*r[:4], "%.6g" % np.log10(float(r[4]))] for r in ROWS]), "logarithm"),
    "percent_name": same(lines([*NAMES[:4], "r (%)", "g (%)", "b (%)"], fields(lambda f: "%.6g" % (100 * float(f)), 4)), "percent"),
    "long_table": same(lines(*readings.long_table()), "wavelengths become", channels=["450", "550", "650"]),
    "long_table_shuffled": same(lines(*readings.long_table("Wavelength (nm)", (550, 650, 450))), channels=["450", "550", "650"]),
    "long_table_incomplete": same(lines(readings.long_table()[0], readings.long_table()[1][1:]), "left out", used=COUNT - 1,
                                  tolerance=2e-3),
    "long_table_two_channels": refused(lines(*with_column("wavelength", [450, 550] * (COUNT // 2))), "wavelengths beside"),
}

DIRECTIONS = {
    "relative_azimuth": same(lines(*readings.relative()), "between light and viewer"),
    "relative_azimuth_words": same(lines(["SZA", "VZA", "relative azimuth", "r", "g", "b"], readings.relative()[1])),
    "delta_phi": same(lines(["theta_i", "theta_r", "Δφ", "r", "g", "b"], readings.relative()[1])),
    "raa": same(lines(["sza", "vza", "RAA", "r", "g", "b"], readings.relative()[1])),
    "half_angles": same(lines(*readings.half_angles())),
    "vectors": same(lines(*readings.vectors())),
    "vectors_words": same(lines(["light_x", "light_y", "light_z", "view_x", "view_y", "view_z", "r", "g", "b"],
        readings.vectors()[1])),
    "vectors_omega": same(lines(["wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z", "r", "g", "b"], readings.vectors()[1])),
    "vectors_capitals": same(lines(["Lx", "Ly", "Lz", "Vx", "Vy", "Vz", "R", "G", "B"], readings.vectors()[1])),
    "light_travels": refused(lines(*readings.vectors(light=-LIGHT)), "--directions light-travels", "direction"),
    "light_travels_said": same(lines(*readings.vectors(light=-LIGHT)), options=["--directions", "light-travels"]),
    "y_up": refused(lines(*readings.vectors(LIGHT[:, [0, 2, 1]] * [1, 1, -1], VIEW[:, [0, 2, 1]] * [1, 1, -1])),
        "--directions y-up"),
    "y_up_said": same(lines(*readings.vectors(LIGHT[:, [0, 2, 1]] * [1, 1, -1], VIEW[:, [0, 2, 1]] * [1, 1, -1])),
                      options=["--directions", "y-up"]),
    "radians": refused(lines(rows=fields(radians, 0, 4)), "radians"),
    "radians_in_plane": refused(lines(readings.in_plane()[0], [[radians(r[0]), radians(r[1]),
        r[2]] for r in readings.in_plane()[1]]),
                                "radians"),
    "radians_said": same(lines(rows=fields(radians, 0, 4)), options=["--directions", "radians"]),
    "elevation": warned(lines(rows=column(column(ROWS, 0, lambda f: "%g" % (90 - float(f))), 2, lambda f: "%g" % (90 - float(f)))),
                        "elevation"),
    "elevation_said": same(lines(rows=column(column(ROWS, 0, lambda f: "%g" % (90 - float(f))), 2,
        lambda f: "%g" % (90 - float(f)))),
                           options=["--directions", "elevation"]),
    "elevation_named": same(lines(["light elevation", "light azimuth", "view elevation", "view azimuth", *NAMES[4:]],
                                  column(column(ROWS, 0, lambda f: "%g" % (90 - float(f))), 2, lambda f: "%g" % (90 - float(f)))),
                            "from the surface"),
    "in_plane": same(lines(*readings.in_plane()), used=64, tolerance=1e-2),
    "in_plane_signed": same(lines(readings.in_plane()[0], [[r[0], "-" + r[1], r[2]] for r in readings.in_plane()[1]]),
        "negative polar",
                            options=["--directions", "mirror-at-0"], used=64, tolerance=1e-2),
    "in_plane_wrong_sign": warned(lines(readings.in_plane()[0], [[r[0], "-" + r[1], r[2]] for r in readings.in_plane()[1]]),
                                  "mirror direction", "misfit"),
    "mirror_at_0": warned(lines(rows=column(ROWS, 3, lambda f: "%g" % (float(f) - 180))), "mirror-at-0", "misfit"),
    "mirror_at_0_said": same(lines(rows=column(ROWS, 3, lambda f: "%g" % (float(f) - 180))), options=["--directions",
        "mirror-at-0"]),
    "mirror_at_0_relative": warned(lines(readings.relative()[0], column(readings.relative()[1], 2,
        lambda f: "%g" % (180 - float(f)))),
                                   "mirror-at-0"),
    "below_on_one_side": warned(lines(rows=ROWS + [[r[0], r[1], "%g" % (180 - float(r[2])), *r[3:]] for r in ROWS[:90]]),
                                "below the horizon"),
    "upside_down": refused(lines(*readings.vectors(LIGHT * [1, 1, -1], VIEW * [1, 1, -1])), "skipped: 124 with the light below"),
    "radians_beside_degrees": refused(lines(rows=column(column(ROWS, 0, radians), 2, radians)), "radians"),
    "arc_minutes": refused(lines([n + " (arcmin)" for n in NAMES[:4]] + NAMES[4:]), "unit included", "'theta_i (arcmin)'"),
    "rotation": refused(lines(["theta_i", "rotation", "theta_o", "r"], [[r[0], r[3], r[2], r[4]] for r in ROWS]), "'rotation'"),
    "swapped_columns": warned(lines([NAMES[k] for k in (0, 2, 1, 3, 4, 5, 6)]), "misfit"),
}

NUMBERS = {
    "minus_999": refused(lines(rows=cell(ROWS, 5, 4, "-999")), "negative", "-999", "--missing", "line 7, field 5"),
    "minus_999_said": same(lines(rows=cell(ROWS, 5, 4, "-999")), options=["--missing", "-999"], used=COUNT - 1),
    "minus_1": refused(lines(rows=fields(lambda f: f)[:3] + [[*ROWS[3][:4], "-1", "-1", "-1"], *ROWS[4:]]), "negative"),
    "minus_1_said": same(lines(rows=[*ROWS[:3], [*ROWS[3][:4], "-1", "-1", "-1"], *ROWS[4:]]), options=["--missing", "negative"],
                         used=COUNT - 1),
    "minus_9999": refused(lines(rows=cell(cell(ROWS, 5, 4, "-9999.0"), 9, 6, "-9999.0")), "negative"),
    "99999": refused(lines(rows=cell(ROWS, 5, 4, "99999")), "far above", "99999"),
    "fill_value": refused(lines(rows=cell(ROWS, 5, 4, "9.96921e+36")), "far above"),
    "mark_beside_noise": refused(lines(rows=cell(cell(ROWS, 5, 4, "-99"), 9, 6, "-0.0001")), "negative"),
    "mark_kept": warned(lines(rows=cell(ROWS, 5, 4, "-999")), "misfit", options=["--missing", "none"]),
    "few_negative": same(lines(rows=cell(ROWS, 5, 4, "-0.0001")), "1 of %d samples have a negative" % COUNT, tolerance=0.2),
    "all_negative": warned(lines(rows=fields(lambda f: "-" + f, 4)), "negative value"),
    "zeros": warned(lines(rows=[[*r[:4], "0", "0", "0"] if k % 11 == 5 else r for k, r in enumerate(ROWS)]), "not measured"),
    "zeros_said": same(lines(rows=[[*r[:4], "0", "0", "0"] if k % 11 == 5 else r for k, r in enumerate(ROWS)]),
                       options=["--missing", "0"], used=COUNT - len(range(5, COUNT, 11)), tolerance=3e-3),
    "saturated": warned(lines(rows=fields(lambda f: "%.0f" % min(255, 1500 * float(f)), 4)), "saturated"),
    "saturated_said": same(lines(rows=fields(lambda f: "%.1f" % min(255, 1500 * float(f)), 4)), options=["--saturated", "255"],
                           used=None, tolerance=2e-2),
    "cosine_of_the_viewer": warned(lines(rows=[[*r[:4], *("%.6g" % (v * np.cos(np.radians(a[2]))) for v in row)]
                                               for r, a, row in zip(ROWS, ANGLES, VALUES)]), "misfit"),
    "ccbrdf": same(lines(rows=[[*r[:4], *("%.6g" % (v * np.cos(np.radians(a[2]))) for v in row)]
                               for r, a, row in zip(ROWS, ANGLES, VALUES)]), options=["--values", "ccbrdf"]),
    "reflectance_factor": same(lines(rows=fields(lambda f: "%.7g" % (np.pi * float(f)), 4)), options=["--values",
        "reflectance-factor"]),
    "radiance": same(lines(rows=[[*r[:4], *("%.6g" % (v * np.cos(np.radians(a[0]))) for v in row)]
                           for r, a, row in zip(ROWS, ANGLES, VALUES)]), options=["--values", "radiance"]),
    "radiance_by_name": warned(lines([*NAMES[:4], "radiance"], [r[:5] for r in ROWS]), "--values radiance"),
    "times_cosine_by_name": warned(lines([*NAMES[:4], "brdf*cos"], [r[:5] for r in ROWS]), "--values"),
    "reflectance_factor_by_name": warned(lines([*NAMES[:4], "BRF"], [r[:5] for r in ROWS]), "--values reflectance-factor"),
    "azimuth_missing_at_the_normal": same(lines(rows=[[*r[:3], "NaN" if r[2] == "0" else r[3], *r[4:]] for r in ROWS]),
                                          "4 azimuths without a value"),
    "infinite": refused(lines(rows=cell(ROWS, 5, 4, "inf")), "infinite", "'inf'"),
    "hexadecimal": refused(lines(rows=cell(ROWS, 5, 4, "0x1p3")), "hexadecimal"),
    "missing_word_that_is_none": refused(lines(), "--missing", options=["--missing", "some"], code=2),
    "directions_word_that_is_none": refused(lines(), "--directions", "mirror-at-0", options=["--directions", "up"], code=2),
}

CASES = {"%s-%s" % (kind, name): case for kind, cases in (
    ("dialect", DIALECTS), ("missing", MISSING), ("columns", COLUMNS), ("beside", BESIDE), ("directions", DIRECTIONS),
    ("numbers", NUMBERS)) for name, case in cases.items()}


def write(folder, text):
    path = folder / "case.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


@pytest.fixture(scope="module")
def known(tmp_path_factory):
    """The roughness of the plain table."""
    (line,) = harness.fit(write(tmp_path_factory.mktemp("plain"), lines()))
    assert abs(line["sigma"][0] - readings.SIGMA) < 2e-3
    return line["sigma"][0]


def check_same(line, told, expect, known):
    assert line["sigma"][0] == pytest.approx(known, rel=expect["tolerance"])
    if expect["used"] is not None:
        assert line["samples_used"] == expect["used"]
    if expect["channels"] is not None:
        assert line["channels"] == expect["channels"]
    for words in told:
        assert any(words in note for note in line["notes"]), (words, line["notes"])


@pytest.mark.parametrize("name", CASES)
def test_reading(tmp_path, known, name):
    outcome, text, told, options, expect = CASES[name]
    path = write(tmp_path, text)
    done = harness.run("fit", "--json", *options, path)
    if outcome == "refused":
        assert done.returncode == expect["code"], done.stdout + done.stderr
        for words in told:
            assert words in done.stderr
        return
    assert done.returncode == 0, done.stderr
    (line,) = harness.lines(done.stdout)
    if outcome == "same":
        check_same(line, told, expect, known)
        return
    seen = line["data_warnings"] + ["misfit"] * bool(line["misfit"])
    for words in told:
        assert any(words in warning for warning in seen), (words, seen)
        assert words in harness.run("fit", *options, path).stdout.replace("\n  ", " ")


def test_names_are_told(tmp_path):
    """Columns that are not called by their role's name are said to be it; `info` tells what `fit` does."""
    text = lines(["Incident zenith", "Incident azimuth", "Viewing zenith", "Viewing azimuth", *NAMES[4:]])
    path = write(tmp_path, text)
    told = harness.run("fit", path).stderr
    assert "column Incident zenith is taken as theta_i" in told and "Viewing azimuth is taken as phi_o" in told
    assert "column Incident zenith is taken as theta_i" in harness.run("info", path).stdout.replace("\n  ", " ")
    assert harness.run("fit", "-q", path).stderr == ""


def test_eval_reads_as_the_fit_did(tmp_path):
    path = write(tmp_path, lines(["alpha", "p1", "beta", "p2", *NAMES[4:]], fields(radians, 0, 4)))
    fit = tmp_path / "fit.json"
    options = ["--column", "theta_i=alpha,phi_i=p1,theta_o=beta,phi_o=p2", "--directions", "radians", "--channels", "r,b"]
    assert harness.run("fit", "--json", *options, "--values", "ccbrdf", "-o", fit, path).returncode == 0
    done = harness.run("eval", fit, path)
    assert done.returncode == 0 and "other data" not in done.stderr, done.stderr
    assert done.stderr.splitlines()[-1].startswith("brdffit: %d of %d samples: E^2" % (COUNT, COUNT)) or "E²" in done.stderr
