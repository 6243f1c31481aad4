// SPDX-License-Identifier: BSD-3-Clause
/** An invented record of experiments, with a good picture, a malicious one, and one that is not SVG. */

const opening =
  'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" viewBox="0 0 9 5"';

const good = `<svg ${opening} width="9pt" height="5pt"><title>T</title><style>svg{--line:#1864dc}
  @media screen and (prefers-color-scheme:dark){svg{--line:#5b9bff}}</style>
  <path id="line" d="M1 1H8V4Z" style="fill:var(--line)"/><use href="#line"/><text>12</text></svg>`;

const harm = "window.harmed=1";
const hostile = `<svg ${opening} onload="${harm}"><script>${harm}</script>
  <style>@import "http://elsewhere.example/a.css";</style>
  <style>path{fill:u\\72l(http://elsewhere.example/b.png)}</style>
  <path d="M1 1H8V4Z" onclick="${harm}" filter="url(http://elsewhere.example/c.svg#f)"/>
  <image href="http://elsewhere.example/d.png"/><foreignObject><body
    xmlns="http://www.w3.org/1999/xhtml"><img src="x" onerror="${harm}"/></body></foreignObject>
  <a href="javascript:${harm}"><text>go</text></a>
  <g><script xmlns="http://www.w3.org/1999/xhtml">${harm}</script>
    <use xlink:href="http://elsewhere.example/e.svg#x"/><set attributeName="href" to="x"/></g></svg>`;

const claim = {
  about: "penetration depth, fixture (V-B)",
  paper: "0.39 ± 0.26 mm",
  reproduction: "0.41 ± 0.22 mm",
  certified: "0.00 ± 0.00 mm",
  best: "certified",
  sure: "p = 3.1e-8, d = 1.9 [1.2, 2.6]",
  note: "The <b>pooled</b> test gives 3e-8.",
};
const nothing = { claims: [], tables: [], figures: [] };

export const experimentsRecord = {
  keepout_record: "experiments",
  format: 1,
  version: "0.2.0",
  date: "2026-11-23T12:00:00Z",
  command: "./run experiments",
  complete: false,
  subject: "The experiments, quick",
  headline: "2 numbers of the paper, beside ours",
  account: [],
  machine: null,
  settings: { scale: "quick", seed: "1" },
  experiments: [
    {
      ...nothing,
      name: "e3",
      title: "E3 Path tracing (section V-A)",
      headline: "Smoother in 20 of 20.",
      claims: [claim, { ...claim, about: "crossings", paper: "-", note: "" }],
      tables: [
        {
          title: "Depth by mode, n = 20",
          columns: ["mode", "median [mm]", "p after Holm", "12 mm"],
          rows: [
            ["no fixture", "0.83", "–", "so"],
            ["certified", "0.00", "< 0.001", "so"],
          ],
          note: "Less is better, by 95 %.",
        },
      ],
      figures: [good, hostile, "<svg"].map((svg, number) => ({
        name: `figure_${number}`,
        title: `Depth ${number}`,
        caption: "Each point is 1 trial.",
        svg,
      })),
    },
    {
      ...nothing,
      name: "e4",
      title: "E4 Cutting (section V-B)",
      headline: "",
      claims: [{ ...claim, about: "duration" }],
    },
  ],
};
