"""Settings of Sphinx. build.py copies this folder into the build tree, adds the pages and figures that are made, and builds
there. SPDX-License-Identifier: MIT
"""
import json
import os
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import brdffit  # noqa: E402  (build.py says where it is)
from ext.api_pages import ABSENT  # noqa: E402

project = "brdffit"
author = "the brdffit authors"
copyright = "brdffit, MIT licence"
version = release = brdffit.__version__

extensions = ["sphinx.ext.autodoc", "sphinx.ext.autosummary", "myst_nb", "ext.docstrings", "ext.mathml", "ext.program_help"]
source_suffix = {".rst": "restructuredtext", ".md": "myst-nb", ".ipynb": "myst-nb"}
exclude_patterns = ["ext", "extra", "requirements.txt"]
root_doc = "index"

# Nothing is fetched: no intersphinx, no scripts or fonts from elsewhere, formulae as MathML.
html_theme = "furo"
html_math_renderer = "mathml"
html_static_path = ["static"]
html_extra_path = ["extra"]
html_css_files = ["brdffit.css"]
html_title = "brdffit " + release
html_copy_source = False
html_theme_options = {"source_repository": "",
                      "light_css_variables": {"color-brand-primary": "#23639f", "color-brand-content": "#23639f"},
                      "dark_css_variables": {"color-brand-primary": "#6db3f2", "color-brand-content": "#6db3f2"}}
pygments_style = "friendly"
pygments_dark_style = "monokai"

# Every reference has to lead somewhere, but for names of the standard library and of other packages.
nitpicky = True
nitpick_ignore_regex = [
    (r"py:.*", r"(npt|np|numpy|sklearn|typing|typing_extensions|collections|ctypes|os|pathlib)\..*"),
    (r"c:identifier", r"(size_t|ptrdiff_t)"),
]
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_mock_imports = ABSENT
autosummary_generate = False
python_maximum_signature_line_length = 100
add_module_names = False

# The notebook in the repository holds no outputs: it is run here, and a cell that fails is a warning with its
# traceback, which ends the build.
nb_execution_mode = "force"
nb_execution_show_tb = True
nb_execution_timeout = 120
nb_execution_in_temp = True
nb_output_stderr = "error"  # a warning in a cell is one of the build
nb_ipywidgets_js = {}
myst_enable_extensions = ["dollarmath", "substitution", "deflist", "colon_fence", "attrs_inline"]
myst_heading_anchors = 3
# Figures of the text that the library itself has found, see figures.py.
myst_substitutions = json.loads((HERE / "figures" / "numbers.json").read_text(encoding="utf-8"))

brdffit_build = pathlib.Path(os.environ["BRDFFIT_BUILD"])
