# SPDX-License-Identifier: BSD-3-Clause
#
# The filter for pages of docs/ in doxygen 1.9.4. It supports neither anchors of headings, so links lead to the page,
# nor bold code. A link to a file outside the site, such as a source or a directory, keeps its words only.
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
