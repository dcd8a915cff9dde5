"""What an export says of itself, in its file and on the screen. SPDX-License-Identifier: MIT"""
from __future__ import annotations

from .conventions import Target
from .fitted import Fit
from .refit import Shown
from .spaces import Sum

SAME = 1e-5  # relative RMS: values that differ by less are the same


def model(fit: Fit) -> str:
    """ "ggx, beckmann; smith masking, schlick Fresnel, lambert diffuse"."""
    return "%s; %s masking, %s Fresnel, %s diffuse" % (", ".join(fit.distributions), fit.masking, fit.fresnel, fit.diffuse)


def lines(fit: Fit, target: Target, shown: Shown | None, measured: bool) -> list[str]:
    """Where it comes from, and how far off it is: relative RMS of radiance."""
    source = "" if fit.file is None else " of %s" % fit.file.replace("--", "- -")
    out = ["%s, from a brdffit fit%s" % (target.title, source), "fit: " + model(fit)]
    if shown is None:
        return [*out, "exact: the model itself"]
    if shown.exact:
        out.append("exact: %s has this model" % target.title if shown.from_fit <= SAME else
                   "the fit's own numbers: %s has this model, with an approximation of Beckmann's masking" % target.title)
    else:
        out.append("fitted again in what %s has: %s" % (target.title, model(shown.base)) if shown.refitted
                   else "moved to what %s has" % target.title)
        if isinstance(shown.space, Sum) and shown.space.fresnel == "conductor" and not shown.exact:
            out.append("Fresnel factors are those of eta and k, exact")
        out.append("proven to be the best of that form" if shown.certified else
                   "not proven: the parameters were moved from a proven fit, within what the target ties together")
    if measured:
        out.append("relative RMS from the measurement: %.4g (of the fit: %.4g); from the fit: %.3g" % (
            shown.error, shown.fit_error, shown.from_fit))
    else:
        out.append("relative RMS from the fit: %.3g (no measurement was given)" % shown.from_fit)
    return out
