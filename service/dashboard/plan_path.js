// The tool path in 2D and 3D, coloured by feed, force or active limit.

import { byId, el, fill, fixed, number } from "/dashboard/app.js";
import { colour, layout, plot, plotly } from "/dashboard/charts.js";
import { isTurning, limitWords } from "/dashboard/plan_table.js";

const LEVELS = 18;
const CURVES = ["curve-1", "curve-2", "curve-3", "curve-4", "curve-5", "curve-6"];
const VALUES = {
  feed: { name: "feed_actual_mm_min", title: "feed, mm/min" },
  force: { name: "cutting_force_n", title: "cutting force, N" },
};
/** From little to much, ever farther from the background. */
const SCALES = {
  light: ["#b9d3e6", "#6fa8d6", "#3a6fc4", "#6a3fb0", "#a01f7a", "#7d0022"],
  dark: ["#38506a", "#3f7fc0", "#2fb0c8", "#58cf8a", "#f0c040", "#fff3c8"],
};
const FLAT = { xy: ["x_mm", "y_mm", "x, mm", "y, mm"], zx: ["z_mm", "x_mm", "z, mm", "x, mm"] };

const state = { runs: {}, steps: [], which: "after", view: "3d", colour: "feed", step: "",
  hasRapids: true, plane: "xy", isBound: false, range: {}, kind: null };

let webgl = null;
function hasWebGl() {
  if (webgl === null) {
    const canvas = el("canvas");
    webgl = Boolean(canvas.getContext("webgl2") ?? canvas.getContext("webgl"));
  }
  return webgl;
}

/** Show the paths of the runs of an advice. */
export async function showPath(runs, result) {
  const found = Object.entries(runs);
  Object.assign(state, { runs, steps: result.workingsteps, step: "",
    which: runs.after ? "after" : "before" });
  const isLathe = state.steps.some(isTurning) && found.every(([, run]) => spread(run.path.y_mm) < 1e-3);
  state.plane = isLathe ? "zx" : "xy";
  state.view = isLathe || !hasWebGl() ? "2d" : "3d";
  for (const [key, { name }] of Object.entries(VALUES))
    state.range[key] = [0, Math.max(...found.map(([, run]) => greatest(run.path, name)), 1e-9)];
  const steps = found[0][1].path.workingsteps;
  fill(byId("path-step"), el("option", { value: "" }, "all"),
    steps.map((id, at) => el("option", { value: String(at + 1) }, id)));
  byId("path-flat").hidden = hasWebGl();
  if (!state.isBound) bind();
  byId("path-card").hidden = false;
  await draw();
}

const spread = (values) => values.reduce((most, each) => Math.max(most, Math.abs(each - values[0])), 0);

/** The greatest value outside of rapid moves. */
function greatest(path, name) {
  return path[name].reduce((most, value, at) => (path.is_rapid[at] || value <= most ? most : value), 0);
}

function bind() {
  state.isBound = true;
  const press = (id, name) => byId(id).addEventListener("click", (event) => {
    const value = event.target.closest("button")?.dataset.value;
    if (value && value !== state[name]) { state[name] = value; draw(); }
  });
  press("path-which", "which");
  press("path-view", "view");
  byId("path-colour").addEventListener("change", (event) => { state.colour = event.target.value; draw(); });
  byId("path-step").addEventListener("change", (event) => { state.step = event.target.value; draw(); });
  byId("path-rapids").addEventListener("change", (event) => { state.hasRapids = event.target.checked; draw(); });
  byId("steps").addEventListener("step", (event) => {
    const step = event.detail === null ? null : state.steps[event.detail];
    if (byId("path-card").hidden) return;
    state.step = step ? String(numberOf(step) || "") : "";
    byId("path-step").value = state.step;
    draw();
  });
}

/** The number of a workingstep in a run: ids may repeat, the order is the program's. */
function numberOf(step) {
  const ids = Object.values(state.runs)[0].path.workingsteps, at = state.steps.indexOf(step);
  return ids[at] === step.id ? at + 1 : ids.indexOf(step.id) + 1;
}

async function draw() {
  const place = byId("path-plot"), path = state.runs[state.which].path, is3d = state.view === "3d";
  press("path-which", state.which);
  press("path-view", state.view);
  for (const button of byId("path-which").children) button.disabled = !state.runs[button.dataset.value];
  byId("path-view").lastElementChild.disabled = !hasWebGl();
  byId("path-colour").value = state.colour;
  const Plotly = await plotly();
  if (state.kind !== null && state.kind !== state.view) Plotly.purge(place);
  state.kind = state.view;
  const begun = performance.now();
  await plot(place, () => ({ data: traces(path, is3d), layout: is3d ? solid() : flat() }));
  performance.measure("path drawn", { start: begun, detail: { points: path.time_s.length, view: state.view } });
  const count = path.time_s.length, last = path.time_s.at(-1);
  byId("path-note").textContent = `${count.toLocaleString("en-GB")} of ${path.rows.toLocaleString("en-GB")} samples are drawn; `
    + `those left out lie within ${number(Math.max(path.deviation_mm, 1e-3), 2)} mm, `
    + `${number(path.deviation_mm_min, 2)} mm/min and ${number(path.deviation_n, 2)} N of the line. `
    + `${fixed(last, 0)} s in all.${state.colour === "limit" ? " Limits are those of the advice, also before." : ""}`;
  place.setAttribute("aria-label", `tool path ${state.which === "after" ? "as advised" : "as programmed"}, `
    + `${state.view.toUpperCase()}, coloured by ${byId("path-colour").selectedOptions[0].textContent}`);
}

function press(id, value) {
  for (const button of byId(id).children)
    button.setAttribute("aria-pressed", String(button.dataset.value === value));
}

// -- traces -----------------------------------------------------------------------------------

/** Points of a curve; a gap between strands. */
class Strand {
  constructor() { this.at = []; this.last = -1; }

  /** The move from one point to the next; `at` holds points, -1 for a gap. */
  add(from, to) {
    if (this.last !== from) {
      if (this.at.length) this.at.push(-1);
      this.at.push(from);
    }
    this.at.push(to);
    this.last = to;
  }
}

function traces(path, is3d) {
  const chosen = Number(state.step), rapids = new Strand(), others = new Strand(), shown = new Map();
  const into = (key) => { if (!shown.has(key)) shown.set(key, new Strand()); return shown.get(key); };
  const key = keyOf(path, is3d);
  for (let to = 1; to < path.time_s.length; to += 1) {
    if (path.is_rapid[to]) { if (!chosen || path.workingstep[to] === chosen) rapids.add(to - 1, to); }
    else if (chosen && path.workingstep[to] !== chosen) others.add(to - 1, to);
    else into(key(to)).add(to - 1, to);
  }
  const data = [];
  if (others.at.length) data.push(line(path, others, is3d, { color: colour("rule"), width: is3d ? 2 : 1 }, { hoverinfo: "skip" }));
  if (state.hasRapids && rapids.at.length)
    data.push(line(path, rapids, is3d, { color: colour("curve-7"), width: is3d ? 2 : 1, dash: "dash" },
      { name: "rapid", hoverinfo: "skip", opacity: 0.6, showlegend: state.colour === "limit" }));
  if (state.colour === "limit") {
    const names = [...shown.keys()].sort();
    names.forEach((name, at) => data.push(line(path, shown.get(name), is3d,
      { color: colour(name === "not advised" ? "curve-7" : CURVES[at % CURVES.length]), width: is3d ? 4 : 2 },
      { name, showlegend: true, ...hover(path, shown.get(name)) })));
  } else if (is3d) data.push(...coloured3d(path, shown.get("all")));
  else data.push(...coloured2d(path, shown));
  return data;
}

/** What a move is put together by: its limit, its level of colour, or nothing. */
function keyOf(path, is3d) {
  if (state.colour === "limit") {
    const names = new Map(state.steps.map((step) => [numberOf(step),
      step.active_limit ? limitWords(step.active_limit, step) : "not advised"]));
    return (to) => names.get(path.workingstep[to]) ?? "not advised";
  }
  if (is3d) return () => "all";
  const values = path[VALUES[state.colour].name], [, most] = state.range[state.colour];
  return (to) => {
    const value = path.is_rapid[to - 1] ? values[to] : (values[to - 1] + values[to]) / 2;
    return Math.min(Math.floor(LEVELS * value / most), LEVELS - 1);
  };
}

function coordinates(path, strand, names) {
  return names.map((name) => strand.at.map((at) => (at < 0 ? null : path[name][at])));
}

function line(path, strand, is3d, look, more = {}) {
  if (is3d) {
    const [x, y, z] = coordinates(path, strand, ["x_mm", "y_mm", "z_mm"]);
    return { type: "scatter3d", mode: "lines", x, y, z, line: look, connectgaps: false, showlegend: false, ...more };
  }
  const [x, y] = coordinates(path, strand, FLAT[state.plane].slice(0, 2));
  return { type: hasWebGl() ? "scattergl" : "scatter", mode: "lines", x, y, line: look, connectgaps: false,
    showlegend: false, ...more };
}

function hover(path, strand) {
  const ids = path.workingsteps;
  return {
    customdata: strand.at.map((at) => (at < 0 ? null : [path.feed_actual_mm_min[at], path.cutting_force_n[at],
      ids[path.workingstep[at] - 1] ?? "–", path.time_s[at]])),
    hovertemplate: "%{customdata[2]}<br>%{customdata[0]:.4~r} mm/min<br>%{customdata[1]:.4~r} N<br>"
      + "%{customdata[3]:.1f} s<extra></extra>",
  };
}

const scale = () => SCALES[document.documentElement.dataset.theme] ?? SCALES.light;
const scalePoints = () => scale().map((name, at, all) => [at / (all.length - 1), name]);
const bar = () => ({ title: { text: VALUES[state.colour].title, side: "right" }, thickness: 12, len: 0.9,
  outlinewidth: 0, x: 1.02, xpad: 4, nticks: 6 });

function coloured3d(path, strand) {
  if (!strand) return [];
  const values = path[VALUES[state.colour].name], [low, high] = state.range[state.colour];
  // A strand begins in the end of a rapid move: with the feed of its cut, not with that one.
  const colours = strand.at.map((at, place) => (at < 0 ? low
    : values[path.is_rapid[at] && strand.at[place + 1] > 0 ? strand.at[place + 1] : at]));
  return [line(path, strand, true, { color: colours, colorscale: scalePoints(), cmin: low, cmax: high, width: 4,
    showscale: true, colorbar: bar() }, hover(path, strand))];
}

function coloured2d(path, shown) {
  const [low, high] = state.range[state.colour];
  const data = [...shown.keys()].sort((a, b) => a - b).map((level) => line(path, shown.get(level), false,
    { color: between((level + 0.5) / LEVELS), width: 2 }, hover(path, shown.get(level))));
  data.push({ type: "scatter", mode: "markers", x: [null], y: [null], hoverinfo: "skip", showlegend: false,
    marker: { color: [low], colorscale: scalePoints(), cmin: low, cmax: high, showscale: true, colorbar: bar(), size: 1 } });
  return data;
}

/** A colour of the scale, 0 to 1. */
function between(share) {
  const all = scale(), at = Math.min(share, 0.9999) * (all.length - 1), first = Math.floor(at);
  const [a, b] = [all[first], all[first + 1]].map((hex) => [1, 3, 5].map((place) => parseInt(hex.slice(place, place + 2), 16)));
  return `rgb(${a.map((low, part) => Math.round(low + (at - first) * (b[part] - low))).join(",")})`;
}

// -- layouts ----------------------------------------------------------------------------------

const isNarrow = () => matchMedia("(max-width: 700px)").matches;
const legend = () => ({ orientation: "h", y: -0.12, x: 0, font: { size: 12 } });

function flat() {
  const [, , across, up] = FLAT[state.plane];
  return layout({ hovermode: "closest", showlegend: state.colour === "limit", legend: legend(),
    height: byId("path-plot").clientHeight || 480, margin: { l: 48, r: 8, t: 8, b: 44 }, uirevision: state.plane,
    xaxis: { title: { text: across, standoff: 4 }, zeroline: false, constrain: "domain" },
    yaxis: { title: { text: up, standoff: 4 }, zeroline: false, scaleanchor: "x", scaleratio: 1, constrain: "domain" } });
}

function solid() {
  const axis = (text) => ({ title: { text }, gridcolor: colour("rule"), zerolinecolor: colour("rule"), color: colour("ink"),
    showbackground: false, nticks: 5, showspikes: false });
  return layout({ hovermode: "closest", showlegend: state.colour === "limit", legend: { ...legend(), y: 0 },
    height: byId("path-plot").clientHeight || 480, margin: { l: 0, r: 0, t: isNarrow() ? 30 : 0, b: 0 }, uirevision: "solid",
    dragmode: "orbit",
    scene: { aspectmode: "data", xaxis: axis("x, mm"), yaxis: axis("y, mm"), zaxis: axis("z, mm"), dragmode: "orbit",
      uirevision: "solid", camera: { eye: isNarrow() ? { x: 1.6, y: -1.8, z: 1.4 } : { x: 1, y: -1.4, z: 1 }, center: { x: 0, y: 0, z: -0.12 } } } });
}
