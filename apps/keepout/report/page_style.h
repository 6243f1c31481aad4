// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace keepout::app {

/// The looks of the report. Colours are variables, given once for light and once for dark.
inline constexpr std::string_view page_style = R"css(
:root {
  color-scheme: light dark;
  --page: #f7f8fa; --card: #ffffff; --line: #dfe3ea; --ink: #17202e; --soft: #566173;
  --stage-top: #eef2f6; --stage-bottom: #d6dde6;
  --alarm: #d01033; --alarm-tint: #d0103317; --safe: #08775b; --safe-tint: #08775b17;
  --rule-0: #5c687a; --rule-1: #1864dc; --rule-2: #9646d6; --rule-3: #008e78; --rule-4: #c46c00;
  --rule-5: #463c32;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #10151d; --card: #18202b; --line: #2c3745; --ink: #e8edf4; --soft: #9eabbd;
    --stage-top: #33404f; --stage-bottom: #212b38;
    --alarm: #ff5a74; --alarm-tint: #ff5a7426; --safe: #3fd1a6; --safe-tint: #3fd1a622;
    --rule-0: #98a5b8; --rule-1: #5b9bff; --rule-2: #bf86f5; --rule-3: #2ec4aa; --rule-4: #f0a13c;
    --rule-5: #c9b9a6;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0; background: var(--page); color: var(--ink);
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", sans-serif;
}
main { max-width: 1180px; margin: 0 auto; padding: 40px 24px 56px; }
.eyebrow { margin: 0; color: var(--soft); font-size: 15px; overflow-wrap: anywhere; }
h1 { margin: 6px 0 10px; font-size: clamp(25px, 4.2vw, 40px); line-height: 1.15;
     letter-spacing: -0.02em; font-weight: 700; max-width: 26em; }
.account { margin: 0 0 28px; font-size: 18px; color: var(--soft); max-width: 52em; }
h2 { margin: 48px 0 4px; font-size: 22px; letter-spacing: -0.01em; }
.lead { margin: 0 0 16px; color: var(--soft); max-width: 52em; }
.lead b { color: var(--alarm); font-weight: 600; }
.panels { display: grid; gap: 18px; grid-template-columns: repeat(var(--columns), minmax(0, 1fr)); }
figure { margin: 0; background: var(--card); border: 1px solid var(--line); border-radius: 12px;
         overflow: hidden; break-inside: avoid; container-type: inline-size; }
.picture { display: block; width: 100%; height: auto;
           background: linear-gradient(var(--stage-top), var(--stage-bottom)); }
.picture text { font-size: 30px; font-weight: 600; fill: #17202e; stroke: #ffffffd0;
                stroke-width: 7px; paint-order: stroke; stroke-linejoin: round; }
.picture path { stroke: #17202e; stroke-width: 4; fill: none; }
.picture.on-stage path { stroke: var(--ink); }
.picture.on-stage .scale { fill: var(--ink); stroke: none; }
.picture .bad { fill: #b00c2a; }
.picture circle { stroke: #d01033; stroke-width: 5; fill: none; }
figcaption { padding: 12px 16px 14px; font-size: 15px; line-height: 1.4; }
figcaption .name { font-size: 18px; font-weight: 650; }
figcaption .about { color: var(--soft); }
.swatch { display: inline-block; width: 22px; height: 5px; border-radius: 3px; margin-right: 9px;
          vertical-align: middle; background: var(--ink-of-rule); }
.badge { float: right; margin-left: 8px; padding: 2px 10px; border-radius: 99px; font-size: 14px;
         font-weight: 600; }
.badge.bad { color: var(--alarm); background: var(--alarm-tint); }
.badge.good { color: var(--safe); background: var(--safe-tint); }
.scroll { overflow-x: auto; border: 1px solid var(--line); border-radius: 12px;
          background: var(--card); }
table { border-collapse: collapse; width: 100%; font-size: 15px; font-variant-numeric: tabular-nums; }
th, td { padding: 9px 12px; text-align: right; white-space: nowrap;
         border-top: 1px solid var(--line); }
thead th { border-top: 0; color: var(--soft); font-weight: 500; font-size: 13px; line-height: 1.25;
           white-space: normal; vertical-align: bottom; }
th:first-child { text-align: left; position: sticky; left: 0; background: var(--card); }
tbody th { font-weight: 600; }
td.bad { color: var(--alarm); font-weight: 600; }
.rule-0 { --ink-of-rule: var(--rule-0); } .rule-1 { --ink-of-rule: var(--rule-1); }
.rule-2 { --ink-of-rule: var(--rule-2); } .rule-3 { --ink-of-rule: var(--rule-3); }
.rule-4 { --ink-of-rule: var(--rule-4); } .rule-5 { --ink-of-rule: var(--rule-5); }
.plot { display: block; width: 100%; height: auto; padding: 12px 10px 4px; }
.plot text { fill: var(--ink); font-size: 12.5px; }
.plot .axis { fill: var(--soft); }
.plot .grid { stroke: var(--line); fill: none; }
.plot .line { stroke: var(--ink-of-rule); stroke-width: 2; fill: none; stroke-linejoin: round; }
.overlaid .line.rule-1 { stroke-width: 5; } .overlaid .line.rule-2 { stroke-width: 3.2; }
.overlaid .line.rule-3 { stroke-width: 1.6; }
.plot .legend path { stroke: var(--ink-of-rule); stroke-width: 4; }
.plot rect.band { fill: var(--alarm-tint); }
.plot text.band { fill: var(--alarm); stroke: var(--card); stroke-width: 4px; paint-order: stroke;
                  stroke-linejoin: round; }
.plot path.marker { stroke: var(--soft); stroke-dasharray: 5 4; fill: none; }
.plot text.marker { fill: var(--soft); }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 6px 18px; margin: 0;
     padding: 16px 18px; font-size: 15px; }
dt { color: var(--soft); }
dd { margin: 0; overflow-wrap: anywhere; }
dl .wide { grid-column: 1 / -1; }
dd.wide { margin-top: -4px; padding: 8px 10px; border-radius: 6px; background: var(--page);
          font: 13.5px/1.5 ui-monospace, "SF Mono", Menlo, Consolas, monospace; }
.method { max-width: 52em; }
@container (max-width: 460px) { .picture text { font-size: 40px; } .plot text { font-size: 16px; } }
@container (max-width: 360px) { .picture text { font-size: 46px; } }
@media (max-width: 960px) { .panels { grid-template-columns: repeat(2, minmax(0, 1fr)); }
                            .panels.wide { grid-template-columns: minmax(0, 1fr); } }
@media (max-width: 640px) {
  main { padding: 24px 14px 40px; }
  .account { font-size: 16px; }
  .panels { grid-template-columns: minmax(0, 1fr); }
  th, td { padding: 8px 10px; }
}
@media print {
  :root { --page: #fff; }
  body { font-size: 11pt; -webkit-print-color-adjust: exact; print-color-adjust: exact; }
  main { max-width: none; padding: 0; }
  h2 { break-after: avoid; }
  .scroll { overflow: visible; }
  table { font-size: 9pt; }
  th, td { padding: 5px 6px; white-space: normal; }
}
)css";

}  // namespace keepout::app
