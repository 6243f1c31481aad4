# SPDX-License-Identifier: BSD-3-Clause
"""The settings of Sphinx for the documentation site. CMakeLists.txt runs it on the root of the sources, so that links
and pictures have the same paths on the site as in the sources. A link to a source file makes a copy of that file."""

import re
from pathlib import Path

from sphinx.errors import ExtensionError
from sphinx.util.nodes import make_refnode

try:
    import keepout
except ImportError:
    keepout = None  # a build without the Python module: the site has no reference of it

project = "keepout"
html_title = "keepout"
root_doc = "docs/README"
exclude_patterns = ["build", "out", ".*", "**/node_modules", "katex.js", "katex.mjs"]
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax"]
source_suffix = {".md": "markdown"}
myst_enable_extensions = ["dollarmath", "html_image"]
myst_heading_anchors = 6

html_theme = "furo"
html_copy_source = html_show_copyright = False
html_use_index = html_domain_indices = False
html_show_search_summary = False  # a page from the disk must not read another one
html_additional_pages = {"index": "index.html"}
templates_path = ["."]
html_css_files = ["katex.min.css"]
mathjax_path = "katex.min.js"  # on pages with formulas only
mathjax_options = {"defer": "defer"}
html_js_files = [("contrib/auto-render.js", {"defer": "defer", "priority": 600,
                                             "onload": "window.katex && renderMathInElement(document.body)"})]
smartquotes = False
default_role = "literal"
autodoc_default_options = {"members": True, "undoc-members": True}

STYLE = """
code.literal { overflow-wrap: break-word; }
td:not(:first-child):has(code) { min-width: 9rem; overflow-wrap: anywhere; }
table.docutils td { vertical-align: top; }
.table-wrapper { position: relative; }
.katex-display { overflow-x: auto; overflow-y: hidden; }
"""
DARK = """
if (document.body.dataset.theme === "auto" && matchMedia("(prefers-color-scheme: dark)").matches) {
  document.body.dataset.theme = "dark";
}
"""


def adapt(app, docname, source):
    """Adds to the pages what only the site has."""
    if docname == root_doc:  # the navigation: its tables
        parts = re.split(r"^## +(.+)$", source[0], flags=re.M)
        for kind, text in zip(parts[1::2], parts[2::2]):
            pages = [f"{title} <{page}>" for title, page in re.findall(r"^\| \[([^\]]+)\]\(([^)#]+)\.md\)", text, re.M)]
            source[0] += "\n".join(["", "```{toctree}", ":hidden:", f":caption: {kind}", *pages, "```", ""])
    elif docname == "docs/api/main_page":  # Doxygen's pages
        source[0] = '# C++ reference\n\n<meta http-equiv="refresh" content="0; url=../../api/index.html">\n'
    elif docname == "docs/python" and keepout:
        source[0] += "\n## Reference\n\n```{eval-rst}\n.. automodule:: keepout\n```\n"


def resolved(app, env, node, contnode):
    """Returns a link to an <a id> of a page, which MyST does not know. A link to a directory becomes its words."""
    page, _, anchor = node["reftarget"].partition("#")
    page = (Path(env.srcdir) / node["refdoc"]).parent / page
    docname = env.path2doc(str(page.resolve()))
    if docname in env.all_docs:
        return make_refnode(app.builder, node["refdoc"], docname, anchor, contnode)
    return contnode if page.is_dir() else None


def escape(app, what, name, thing, options, lines):
    """Takes docstrings as plain text, not as reStructuredText."""
    lines[:] = [re.sub(r"([*|_])", r"\\\1", line) if not line.startswith("    ") else "| " + line for line in lines]


def shorten(app, what, name, thing, options, *parts):
    return tuple(part and re.sub(r"keepout\._core\.|\bself: [\w.]+(, )?", "", part) for part in parts)


def mend_theme(app, failure):
    """Repairs three faults of Debian's theme. It names a style from the root of a web server. It loads a module, which
    no page from the disk may load. It lacks the rule for readers who prefer a dark page."""
    if failure:
        return
    static = Path(app.outdir, "_static")
    normalize = Path("/usr/share/javascript/normalize.css/normalize.css").read_text()
    for file, asked, put in (
            ("styles/furo.css", "@import url(/javascript/normalize.css/normalize.css);", normalize + STYLE),
            ("scripts/furo.js", 'import Gumshoe from "./gumshoe-patched.js";',
             (static / "scripts/gumshoe-patched.js").read_text() + DARK)):
        text = (static / file).read_text()
        if asked not in text:
            raise ExtensionError(f"{file} has no '{asked}' any longer: is mend_theme still needed?")
        (static / file).write_text(text.replace(asked, put))


def setup(app):
    app.connect("source-read", adapt)
    app.connect("autodoc-process-docstring", escape)
    app.connect("autodoc-process-signature", shorten)
    app.connect("build-finished", mend_theme)
    app.connect("missing-reference", resolved)
