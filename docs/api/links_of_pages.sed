# SPDX-License-Identifier: BSD-3-Clause
#
# What doxygen 1.9.4 reads in place of a page of docs/. It knows no anchors of headings: links lead to
# the page; and no bold code. What is no page of the site, such as a source or a folder, keeps its words
# only.
s~\*\*(`[^`]+`)\*\*~\1~g
s~\]\(([^)#]+\.md)#[^)]*\)~](\1)~g
s~\[([^]]*)\]\(#[^)]*\)~\1~g
s~\[([^]]*)\]\((\.\./|[A-Za-z0-9_-]+/)*[A-Za-z0-9_-]+\.(cpp|h|txt|html|py|cmake)\)~\1~g
s~\[([^]]*)\]\((\.\./)*[A-Za-z0-9_/-]+\)~\1~g
# Formulas outside of code: $$...$$ on a line or over several lines, and $...$.
/^```/,/^```/b
s~\$\$(.+)\$\$~\\f[\1\\f]~g
/^(> )?\$\$/,/\$\$$/{
s~^((> )?)\$\$~\1\\f[~
s~\$\$$~\\f]~
b
}
s~\$([^$]+)\$~\\f$\1\\f$~g
