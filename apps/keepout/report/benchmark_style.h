// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace keepout::app {

/// What pages with a benchmark have in addition. The colours of the series are far apart for most
/// eyes, and dark (or light) enough to write in; their marks tell them apart without colour.
inline constexpr std::string_view benchmark_style = R"css(
:root {
  --series-0: #1864dc; --series-1: #bd4300; --series-2: #08775b; --series-3: #9646d6;
  --series-4: #866200; --series-5: #be1768; --series-6: #0a748c; --series-7: #5c687a;
  --series-8: #7a4a2c; --series-9: #17202e;
  --stage-query: #1864dc; --stage-activate: #b86a00; --stage-solve: #3c4a60;
}
@media (prefers-color-scheme: dark) {
  :root {
    --series-0: #6ea8ff; --series-1: #ff9558; --series-2: #45cf9f; --series-3: #c79bff;
    --series-4: #d9b84a; --series-5: #ff86b8; --series-6: #4fc9e6; --series-7: #9eabbd;
    --series-8: #cfa184; --series-9: #e8edf4;
    --stage-query: #6ea8ff; --stage-activate: #e5a648; --stage-solve: #aab7c9;
  }
}
.series-0 { --ink-of-rule: var(--series-0); } .series-1 { --ink-of-rule: var(--series-1); }
.series-2 { --ink-of-rule: var(--series-2); } .series-3 { --ink-of-rule: var(--series-3); }
.series-4 { --ink-of-rule: var(--series-4); } .series-5 { --ink-of-rule: var(--series-5); }
.series-6 { --ink-of-rule: var(--series-6); } .series-7 { --ink-of-rule: var(--series-7); }
.series-8 { --ink-of-rule: var(--series-8); } .series-9 { --ink-of-rule: var(--series-9); }
.series-published { --ink-of-rule: var(--ink); }
.stage-query { --ink-of-rule: var(--stage-query); }
.stage-activate { --ink-of-rule: var(--stage-activate); }
.stage-solve { --ink-of-rule: var(--stage-solve); }
.part { margin-top: 72px; padding-top: 36px; border-top: 1px solid var(--line);
        font-size: clamp(22px, 3.2vw, 31px); line-height: 1.18; letter-spacing: -0.015em;
        max-width: 28em; }
.part + .account { margin-top: 10px; }
h3 { margin: 28px 0 8px; font-size: 17px; }
.panels + h3, .panels + .scroll, .scroll + .panels, .lead + .scroll { margin-top: 18px; }
.measured figcaption { padding: 12px 16px 2px; }
.measured figcaption .about { font-size: 14px; }
.plot .mark { fill: var(--ink-of-rule); stroke: var(--card); stroke-width: 1; }
.plot .mark.open { fill: var(--card); stroke: var(--ink-of-rule); stroke-width: 1.7; }
.plot .leader { stroke: var(--ink-of-rule); stroke-width: 1; stroke-dasharray: 1.5 3; fill: none; }
.plot .end { fill: var(--ink-of-rule); font-weight: 550; }
.plot .legend .mark { stroke: var(--card); stroke-width: 1; }
.plot .legend .mark.open { stroke: var(--ink-of-rule); stroke-width: 1.7; }
.measured .plot .legend path:not(.mark) { stroke-width: 2; }
.measured .plot text.marker { stroke: var(--card); stroke-width: 4px; paint-order: stroke; }
.plot .bar { fill: var(--ink-of-rule); stroke: var(--card); stroke-width: 1; }
.plot .share { fill: var(--card); font-weight: 600; font-size: 11.5px; }
.plot .total { font-weight: 600; font-variant-numeric: tabular-nums; }
.plot .span { stroke: var(--ink-of-rule); stroke-width: 2; fill: none; }
th.name, td.name, td.words { text-align: left; }
td.words { white-space: normal; min-width: 24em; }
@container (max-width: 460px) { .plot .end { font-size: 14.5px; font-weight: 400; } }
@media (max-width: 640px) {
  .outcomes dl { grid-template-columns: minmax(0, 1fr); gap: 2px; }
  .outcomes dd { margin-bottom: 8px; }
}
.windowed { max-height: min(36em, 85vh); overflow: auto; }
.windowed table { font-size: 13.5px; }
.windowed th, .windowed td { padding: 6px 9px; }
.windowed thead th { position: sticky; top: 0; background: var(--card); z-index: 1;
                     box-shadow: 0 1px 0 var(--line); }
.windowed thead th:first-child { z-index: 2; }
@page wide { size: A4 landscape; margin: 10mm; }
@media print {
  .part { break-before: page; border-top: 0; margin-top: 0; padding-top: 0; }
  .everything { page: wide; }
  .windowed { max-height: none; overflow: visible; border: 0; }
  .windowed table { font-size: 5.3pt; }
  .windowed th, .windowed td { padding: 2px 3px; white-space: nowrap; }
  .windowed thead th { position: static; font-size: 5pt; white-space: normal; }
  tr { break-inside: avoid; }
  .windowed td.words { white-space: normal; min-width: 8em; }
  .panels.charts { grid-template-columns: repeat(var(--columns), minmax(0, 1fr)); gap: 10px; }
  .measured figcaption, .measured figcaption .about { font-size: 9pt; }
  .lead { break-after: avoid; break-inside: avoid; }
}
)css";

}  // namespace keepout::app
