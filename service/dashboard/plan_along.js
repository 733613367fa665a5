// Feeds along the path: parts before and after, what limits the feed, and the curves of both runs.

import { api, byId, duration, el, fill, fixed, percent, tell } from "/dashboard/app.js";
import { colour, envelope, layout, plot } from "/dashboard/charts.js";

const PANELS = [
  { title: "Feed, mm/min", unit: "mm/min", name: "feed_mm_min", scale: 1, isLog: true },
  { title: "Force, N", unit: "N", name: "cutting_force_n", scale: 1 },
  { title: "Spindle drive, kW", unit: "kW", name: "drive_power_w", scale: 0.001 },
];
const RUNS = { before: ["curve-7", "before"], after: ["curve-1", "after"] };
const AXES = { length_mm: "length of the path, mm", time_s: "time, s" };
const HEIGHT = 140, STRIP = 22, COLOURS = 7;

const state = { curves: null, axis: "length_mm", order: [], asked: 0 };

/** Show the feeds along the path of an advice; hide the card if there are none. */
export async function showAlong(job, along) {
  const card = byId("along-card"), mine = state.asked += 1;
  card.hidden = !along;
  if (!along) return;
  state.order = Object.keys(along.active_limits);
  fill(byId("along-figures"), ...figures(along));
  parts(byId("along-parts"), along.parts);
  fill(byId("along-shares"), Object.entries(along.active_limits).map(([name, share]) =>
    el("div", { class: "share" }, el("span", {}, name),
      el("div", { class: "bar", "aria-hidden": "true", style: `width:${(100 * share).toFixed(2)}%;background:var(--${shade(name)})` }),
      el("span", { class: "told" }, percent(share, share < 0.095 ? 1 : 0)))));
  tell(byId("along-problem"), null);
  try {
    const curves = await api(`/v1/advice/${job.id}/curves`);
    if (mine !== state.asked) return;
    state.curves = curves;
    await plot(byId("along-plot"), figureOf);
  } catch (error) { tell(byId("along-problem"), error); }
}

byId("along-axis").addEventListener("click", (event) => {
  const value = event.target.closest("button")?.dataset.value;
  if (!value || !state.curves) return;
  state.axis = value;
  for (const button of byId("along-axis").children)
    button.setAttribute("aria-pressed", String(button.dataset.value === value));
  plot(byId("along-plot"), figureOf).catch((error) => tell(byId("along-problem"), error));
});

/** Return the name of the colour of a limit. */
const shade = (name) => `curve-${1 + Math.max(state.order.indexOf(name), 0) % COLOURS}`;

function figures(along) {
  const { before, after } = along.time_s, longer = Math.max(before, after);
  const one = (name, ...shown) => el("div", { class: "figure" }, el("div", { class: "name" }, name), el("div", {}, shown));
  const value = (text) => el("span", { class: "value" }, text);
  const smooth = along.free_profile.smoothest;
  const smoothest = smooth && one("Smoothest profile", value(duration(smooth.time_s, longer)),
    el("span", { class: "unit" }, `${fixed(smooth.unevenness_ratio, 3)} times as uneven as the fastest, ${duration(smooth.fastest_time_s, longer)}`));
  return [
    one("Time, simulated", el("span", { class: "was" }, duration(before, longer)),
      el("span", { class: "was arrow", "aria-label": "becomes" }, "→"), value(duration(after, longer))),
    one("Ratio of times", value(before ? fixed(after / before, 3) : "–")),
    one("Blocks changed", value(String(along.blocks)), el("span", { class: "unit" }, `${along.splits} splits`)),
    one("Run over plan", value(along.planned_time_s ? fixed(after / along.planned_time_s, 4) : "–")),
    ...(smoothest ? [smoothest] : []),
  ];
}

const COLUMNS = [
  ["Time, s", (part) => pair(part.time_s, 1)],
  ["Force, N", (part) => pair(part.force_n, 0)],
  ["Deflection, µm", (part) => pair(part.deflection_um, 1)],
  ["Drive, W", (part) => pair(part.drive_power_w, 0)],
  ["Feeds", (part) => (part.feeds === null ? "as it was" : String(part.feeds))],
  ["Above least time", (part) => percent(part.gap, 1)],
];

function pair({ before, after }, places) {
  const [from, to] = [fixed(before, places), fixed(after, places)];
  if (from === to) return from;
  return el("span", { class: "change" }, el("span", { class: "was" }, from),
    el("span", { class: "arrow", "aria-label": "becomes" }, "→"), el("b", {}, to));
}

function parts(table, rows) {
  fill(table, el("caption", { class: "unseen" }, "Parts of the program before and after"),
    el("thead", {}, el("tr", {}, ["Part", ...COLUMNS.map(([title]) => title)].map((title, at) =>
      el("th", { scope: "col", class: at ? "n" : undefined }, title)))),
    el("tbody", {}, rows.map((part) => el("tr", {}, el("th", { scope: "row" }, part.id || "between parts"),
      COLUMNS.map(([, cell]) => el("td", { class: "n" }, cell(part)))))));
}

function figureOf() {
  const pairs = state.curves[state.axis], hasStrip = state.axis === "length_mm";
  const top = hasStrip ? STRIP : 0, height = HEIGHT * PANELS.length + top;
  const laid = layout({ height: height + 66, margin: { l: 58, r: 10, t: 26, b: 40 }, uirevision: state.axis, hovermode: "x" });
  const data = [], from = 1 - top / height, share = from / PANELS.length, space = 24 / height;
  laid.annotations = PANELS.map((panel, row) => ({ text: panel.title, x: 0, xref: "paper", xanchor: "left",
    y: from - row * share - space, yref: "paper", yanchor: "bottom", showarrow: false, font: { size: 12 } }));
  PANELS.forEach((panel, row) => {
    const place = row ? String(row + 1) : "", high = from - row * share - space;
    const isLast = row === PANELS.length - 1;
    laid[`yaxis${place}`] = { ...laid.yaxis, domain: [Math.max(high - share + space, 0), high], nticks: 4, fixedrange: true,
      type: panel.isLog ? "log" : "linear", rangemode: panel.isLog ? undefined : "tozero", anchor: "x" };
    if (isLast) laid.xaxis = { ...laid.xaxis, anchor: `y${place}`, title: { text: AXES[state.axis], standoff: 4 } };
    for (const [which, [curve, label]] of Object.entries(RUNS)) {
      const run = pairs[which];
      const { x, y } = envelope({ begin_s: run.begin, end_s: run.end, signals: run.signals, is_reduced: true }, panel.name, panel.scale);
      data.push({ type: "scatter", mode: "lines", name: label, x, y: panel.isLog ? y.map((value) => (value > 0 ? value : null)) : y,
        xaxis: "x", yaxis: `y${place}`, line: { color: colour(curve), width: which === "after" ? 1.4 : 1.1 },
        hovertemplate: `${label} %{y:.4~r} ${panel.unit}<extra></extra>` });
    }
  });
  if (hasStrip) data.push(strip(laid, from));
  return { data, layout: laid };
}

/** Return the active limits along the path as bars above the panels. */
function strip(laid, from) {
  const { names, begin_mm: begins, end_mm: ends, limit } = state.curves.limits;
  const axis = PANELS.length + 1;
  laid[`yaxis${axis}`] = { ...laid.yaxis, type: "linear", domain: [from, 1], range: [0, 1], visible: false, fixedrange: true, anchor: "x" };
  laid.barmode = "overlay";
  return { type: "bar", xaxis: "x", yaxis: `y${axis}`, x: begins.map((begin, at) => (begin + ends[at]) / 2), y: begins.map(() => 1),
    width: begins.map((begin, at) => ends[at] - begin), customdata: limit.map((at) => names[at]),
    marker: { color: limit.map((at) => colour(shade(names[at]))), line: { width: 0 } }, hovertemplate: "%{customdata}<extra></extra>" };
}
