// Power and force of both runs over a common time axis; zooming reads the range again.

import { api, byId } from "/dashboard/app.js";
import { colour, envelope, layout, plot } from "/dashboard/charts.js";

const PANELS = [
  { title: "Total power from the mains, kW", unit: "kW", name: "total_power_w", scale: 0.001 },
  { title: "Spindle power from the mains, kW", unit: "kW", name: "spindle_power_w", scale: 0.001 },
  { title: "Cutting force, N", unit: "N", name: "cutting_force_n", scale: 1 },
];
const RUNS = { before: ["curve-7", "before"], after: ["curve-1", "after"] };
const POINTS = 1200, HEIGHT = 150;

const state = { runs: {}, series: {}, range: null, wanted: null, isBound: false, asked: 0 };

/** Show the load of the runs. */
export async function showLoad(runs) {
  Object.assign(state, { runs, range: null });
  byId("load-card").hidden = false;
  await read();
  if (state.isBound) return;
  state.isBound = true;
  byId("load-plot").on("plotly_relayout", (changed) => {
    const key = Object.keys(changed).find((name) => /^xaxis\d*\.range\[0\]$/.test(name));
    if (key) state.range = [changed[key], changed[key.replace("[0]", "[1]")]];
    else if (Object.keys(changed).some((name) => /^xaxis\d*\.autorange$/.test(name))) state.range = null;
    else return;
    clearTimeout(state.wanted);
    state.wanted = setTimeout(read, 120);
  });
}

async function read() {
  const mine = state.asked += 1, names = PANELS.map((panel) => panel.name).join(",");
  const range = state.range ? `&begin_s=${state.range[0]}&end_s=${state.range[1]}` : "";
  const found = await Promise.all(Object.entries(state.runs).map(async ([which, run]) =>
    [which, await api(`/v1/simulations/${run.id}/series?signals=${names}&points=${POINTS}${range}`)]));
  if (mine !== state.asked) return;
  state.series = Object.fromEntries(found);
  await plot(byId("load-plot"), figureOf);
  const all = Object.values(state.series), rows = all.reduce((sum, each) => sum + each.rows, 0);
  byId("load-note").textContent = all.some((each) => each.is_reduced)
    ? `${rows.toLocaleString("en-GB")} samples; minimum and maximum of each stretch are drawn; zoom in for more detail.`
    : `All ${rows.toLocaleString("en-GB")} samples of the range are drawn.`;
}

function figureOf() {
  const laid = layout({ height: HEIGHT * PANELS.length + 44, margin: { l: 54, r: 10, t: 24, b: 38 },
    uirevision: state.range ? "zoomed" : "whole", hovermode: "x" });
  const data = [], share = 1 / PANELS.length, space = 26 / (HEIGHT * PANELS.length);
  laid.annotations = PANELS.map((panel, row) => ({ text: panel.title, x: 0, xref: "paper", xanchor: "left",
    y: 1 - row * share, yref: "paper", yanchor: "bottom", showarrow: false, font: { size: 12 } }));
  PANELS.forEach((panel, row) => {
    const place = row ? String(row + 1) : "", isLast = row === PANELS.length - 1, top = 1 - row * share;
    laid[`yaxis${place}`] = { ...laid.yaxis, domain: [Math.max(top - share + space, 0), top - 0.004],
      rangemode: "tozero", nticks: 4, anchor: `x${place}`, fixedrange: true };
    laid[`xaxis${place}`] = { ...laid.xaxis, anchor: `y${place}`, matches: row ? "x" : undefined, showticklabels: isLast,
      range: state.range ?? undefined, title: isLast ? { text: "time, s", standoff: 4 } : undefined };
    for (const [which, series] of Object.entries(state.series)) {
      const [curve, label] = RUNS[which];
      data.push({ type: "scatter", mode: "lines", name: label, ...envelope(series, panel.name, panel.scale),
        xaxis: `x${place}`, yaxis: `y${place}`, line: { color: colour(curve), width: which === "after" ? 1.4 : 1.1 },
        opacity: which === "after" ? 0.95 : 0.8, hovertemplate: `${label} %{y:.4~r} ${panel.unit}<extra></extra>` });
    }
  });
  return { data, layout: laid };
}
