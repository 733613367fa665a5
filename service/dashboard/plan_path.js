// The tool path in 2D and 3D, coloured by feed, force or active limit.

import { byId, duration, el, fill, number } from "/dashboard/app.js";
import { colour, layout, plot } from "/dashboard/charts.js";
import { FlatView } from "/dashboard/plan_flat.js";
import { isTurning, limitWords } from "/dashboard/plan_table.js";

const LEVELS = 18;
const CURVES = ["curve-1", "curve-2", "curve-3", "curve-4", "curve-5", "curve-6"];
const VALUES = {
  feed: { name: "feed_actual_mm_min", title: "feed, mm/min" },
  force: { name: "cutting_force_n", title: "cutting force, N" },
};
/** Colour scale from low to high, with increasing contrast to the background. */
const SCALES = {
  light: ["#b9d3e6", "#6fa8d6", "#3a6fc4", "#6a3fb0", "#a01f7a", "#7d0022"],
  dark: ["#38506a", "#3f7fc0", "#2fb0c8", "#58cf8a", "#f0c040", "#fff3c8"],
};
const FLAT = { xy: ["x_mm", "y_mm", "x, mm", "y, mm"], zx: ["z_mm", "x_mm", "z, mm", "x, mm"] };

const state = { runs: {}, steps: [], which: "after", view: "3d", colour: "feed", step: "",
  hasRapids: true, plane: "xy", flat: null, range: {} };

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
  if (!state.flat) bind();
  byId("path-card").hidden = false;
  await draw();
}

const spread = (values) => values.reduce((most, each) => Math.max(most, Math.abs(each - values[0])), 0);

/** Return the largest value outside of rapid moves. */
function greatest(path, name) {
  return path[name].reduce((most, value, at) => (path.is_rapid[at] || value <= most ? most : value), 0);
}

function bind() {
  state.flat = new FlatView(byId("path-flat-plot"));
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

/** Return the number of a workingstep in a run; ids may repeat, the order is that of the program. */
function numberOf(step) {
  const ids = Object.values(state.runs)[0].path.workingsteps, at = state.steps.indexOf(step);
  return ids[at] === step.id ? at + 1 : ids.indexOf(step.id) + 1;
}

async function draw() {
  const path = state.runs[state.which].path, is3d = state.view === "3d";
  press("path-which", state.which);
  press("path-view", state.view);
  for (const button of byId("path-which").children) button.disabled = !state.runs[button.dataset.value];
  byId("path-view").lastElementChild.disabled = !hasWebGl();
  byId("path-colour").value = state.colour;
  const solidPlace = byId("path-plot"), begun = performance.now();
  solidPlace.hidden = !is3d;
  byId("path-flat-plot").hidden = is3d;
  const label = `tool path ${state.which === "after" ? "as advised" : "as programmed"}, `
    + `${state.view.toUpperCase()}, coloured by ${byId("path-colour").selectedOptions[0].textContent}`;
  if (is3d) {
    await plot(solidPlace, () => ({ data: traces(path), layout: solid() }));
    solidPlace.setAttribute("aria-label", label);
  } else {
    solidPlace.redraw = null;
    drawFlat(path, label);
  }
  performance.measure("path drawn", { start: begun, detail: { points: path.time_s.length, view: state.view } });
  const count = path.time_s.length, last = path.time_s.at(-1);
  byId("path-note").textContent = `${count.toLocaleString("en-GB")} of ${path.rows.toLocaleString("en-GB")} samples are drawn; `
    + `omitted ones lie within ${number(Math.max(path.deviation_mm, 1e-3), 2)} mm, `
    + `${number(path.deviation_mm_min, 2)} mm/min and ${number(path.deviation_n, 2)} N of the line. `
    + `${duration(last)} in all.${state.colour === "limit" ? " Limits are those of the advice, also in the view before." : ""}`;
}

function press(id, value) {
  for (const button of byId(id).children)
    button.setAttribute("aria-pressed", String(button.dataset.value === value));
}

// -- strands ----------------------------------------------------------------------------------

/** Points of curves, with gaps between strands. */
class Strand {
  constructor() { this.at = []; this.last = -1; }

  /** Add the move from one point to the next; `at` holds points, -1 for a gap. */
  add(from, to) {
    if (this.last !== from) {
      if (this.at.length) this.at.push(-1);
      this.at.push(from);
    }
    this.at.push(to);
    this.last = to;
  }
}

/** Sort moves into rapids, those of other workingsteps, and those shown, by key. */
function sorted(path, keyOf) {
  const chosen = Number(state.step), rapids = new Strand(), others = new Strand(), shown = new Map();
  for (let to = 1; to < path.time_s.length; to += 1) {
    const isMeant = !chosen || path.workingstep[to] === chosen;
    if (path.is_rapid[to]) { if (isMeant) rapids.add(to - 1, to); continue; }
    if (!isMeant) { others.add(to - 1, to); continue; }
    const key = keyOf(to);
    if (!shown.has(key)) shown.set(key, new Strand());
    shown.get(key).add(to - 1, to);
  }
  return { rapids: state.hasRapids ? rapids : new Strand(), others, shown };
}

/** Return a function that names the active limit of a move. */
function limitOf(path) {
  const names = new Map(state.steps.map((step) => [numberOf(step),
    step.active_limit ? limitWords(step.active_limit, step) : "not advised"]));
  return (to) => names.get(path.workingstep[to]) ?? "not advised";
}

/** Choose a colour for each limit of the advice, the same in all views. */
function limitColours() {
  const names = [...new Set(state.steps.filter((step) => step.active_limit)
    .map((step) => limitWords(step.active_limit, step)))].sort();
  return new Map([...names.map((name, at) => [name, colour(CURVES[at % CURVES.length])]),
    ["not advised", colour("soft")]]);
}

/** Return the level of a move's colour. */
function levelOf(path) {
  const values = path[VALUES[state.colour].name], [, most] = state.range[state.colour];
  return (to) => {
    const value = path.is_rapid[to - 1] ? values[to] : (values[to - 1] + values[to]) / 2;
    return Math.min(Math.floor(LEVELS * value / most), LEVELS - 1);
  };
}

// -- 2D ---------------------------------------------------------------------------------------

function drawFlat(path, label) {
  const isLimit = state.colour === "limit", [xName, yName, ...titles] = FLAT[state.plane];
  const { rapids, others, shown } = sorted(path, isLimit ? limitOf(path) : levelOf(path));
  const limits = limitColours(), levels = [...Array(LEVELS).keys()].map((level) => between((level + 0.5) / LEVELS));
  const lines = [{ at: others.at, colour: colour("rule"), width: 1, isQuiet: true },
    { at: rapids.at, colour: colour("curve-7"), width: 1, dash: [5, 4], isQuiet: true },
    ...[...shown.keys()].sort((a, b) => a - b).map((key) => ({ at: shown.get(key).at, width: 2,
      colour: isLimit ? limits.get(key) : levels[key] }))];
  state.flat.show({ lines, x: path[xName], y: path[yName], titles, label, key: `${state.plane} ${Object.values(state.runs)[0].id}`,
    bar: isLimit ? null : { title: VALUES[state.colour].title, high: state.range[state.colour][1], colours: levels },
    tell: (at) => told(path, at), again: () => drawFlat(path, label) });
  const keys = isLimit ? [...limits].filter(([name]) => shown.has(name)) : [];
  fill(byId("path-keys"), keys.map(([name, tint]) =>
    el("span", { class: "nowrap" }, el("span", { class: "key", style: `background:${tint}` }), ` ${name}`)));
}

function told(path, at) {
  return [path.workingsteps[path.workingstep[at] - 1] ?? "–", `${number(path.feed_actual_mm_min[at], 4)} mm/min`,
    `${number(path.cutting_force_n[at], 4)} N`, `${number(path.time_s[at], 4)} s`];
}

// -- 3D ---------------------------------------------------------------------------------------

function traces(path) {
  const isLimit = state.colour === "limit", { rapids, others, shown } = sorted(path, isLimit ? limitOf(path) : () => "all");
  const data = [], limits = limitColours();
  if (others.at.length) data.push(line(path, others, { color: colour("rule"), width: 2 }, { hoverinfo: "skip" }));
  if (rapids.at.length) data.push(line(path, rapids, { color: colour("curve-7"), width: 2, dash: "dash" },
    { name: "rapid", hoverinfo: "skip", opacity: 0.6, showlegend: isLimit }));
  if (isLimit) {
    for (const [name, tint] of limits) if (shown.has(name))
      data.push(line(path, shown.get(name), { color: tint, width: 4 }, { name, showlegend: true, ...hover(path, shown.get(name)) }));
  } else if (shown.has("all")) data.push(coloured(path, shown.get("all")));
  fill(byId("path-keys"));
  return data;
}

function line(path, strand, look, more = {}) {
  const [x, y, z] = ["x_mm", "y_mm", "z_mm"].map((name) => strand.at.map((at) => (at < 0 ? null : path[name][at])));
  return { type: "scatter3d", mode: "lines", x, y, z, line: look, connectgaps: false, showlegend: false, ...more };
}

function hover(path, strand) {
  return { text: strand.at.map((at) => (at < 0 ? "" : told(path, at).join("<br>"))), hovertemplate: "%{text}<extra></extra>" };
}

const scale = () => SCALES[document.documentElement.dataset.theme] ?? SCALES.light;
const scalePoints = () => scale().map((name, at, all) => [at / (all.length - 1), name]);
const bar = () => ({ title: { text: VALUES[state.colour].title, side: "right" }, thickness: 12, len: 0.9,
  outlinewidth: 0, x: 1.02, xpad: 4, nticks: 6 });

function coloured(path, strand) {
  const values = path[VALUES[state.colour].name], [low, high] = state.range[state.colour];
  // A strand begins at the end of a rapid move, but gets the feed of its cut.
  const colours = strand.at.map((at, place) => (at < 0 ? low
    : values[path.is_rapid[at] && strand.at[place + 1] > 0 ? strand.at[place + 1] : at]));
  return line(path, strand, { color: colours, colorscale: scalePoints(), cmin: low, cmax: high, width: 4,
    showscale: true, colorbar: bar() }, hover(path, strand));
}

/** Return the colour of the scale at a value of 0 to 1. */
function between(share) {
  const all = scale(), at = Math.min(share, 0.9999) * (all.length - 1), first = Math.floor(at);
  const [a, b] = [all[first], all[first + 1]].map((hex) => [1, 3, 5].map((place) => parseInt(hex.slice(place, place + 2), 16)));
  return `rgb(${a.map((low, part) => Math.round(low + (at - first) * (b[part] - low))).join(",")})`;
}

// -- layouts ----------------------------------------------------------------------------------

const isNarrow = () => matchMedia("(max-width: 700px)").matches;
const legend = () => ({ orientation: "h", y: -0.12, x: 0, font: { size: 12 } });

/** Return the proportions of the scene from the extent of the path, with a minimum for each side. */
function sides() {
  const found = Object.values(state.runs).map((run) => run.path);
  const all = ["x_mm", "y_mm", "z_mm"].map((name) => {
    let low = Infinity, high = -Infinity;
    for (const path of found) for (const value of path[name]) { low = Math.min(low, value); high = Math.max(high, value); }
    return [low, high];
  });
  const most = Math.max(...all.map(([low, high]) => high - low), 1e-3);
  const ranges = all.map(([low, high]) => {
    const half = Math.max((high - low) * 0.52, most * 0.03);
    return [(low + high) / 2 - half, (low + high) / 2 + half];
  });
  return { ranges, ratio: ranges.map(([low, high]) => 1.5 * (high - low) / most) };
}

/** Camera from the front and above; a lathe's axis is horizontal. */
function camera() {
  if (state.plane === "zx")
    return { eye: isNarrow() ? { x: 0.6, y: 2.9, z: 0.4 } : { x: 0.35, y: 1.5, z: 0.25 }, up: { x: 1, y: 0, z: 0 }, center: { x: 0, y: 0, z: 0 } };
  return { eye: isNarrow() ? { x: 1.9, y: -2.2, z: 1.7 } : { x: 1, y: -1.4, z: 1 }, center: { x: 0, y: 0, z: -0.12 } };
}

function solid() {
  const { ranges, ratio: [rx, ry, rz] } = sides();
  const axis = (text, range) => ({ title: { text }, range, autorange: false, gridcolor: colour("rule"), zerolinecolor: colour("rule"), color: colour("ink"),
    showbackground: false, nticks: 5, showspikes: false });
  return layout({ hovermode: "closest", showlegend: state.colour === "limit", legend: { ...legend(), y: 0 },
    height: byId("path-plot").clientHeight || 480, margin: { l: 0, r: 0, t: isNarrow() ? 30 : 0, b: 0 }, uirevision: "solid",
    dragmode: "orbit",
    scene: { aspectmode: "manual", aspectratio: { x: rx, y: ry, z: rz }, xaxis: axis("x, mm", ranges[0]),
      yaxis: axis("y, mm", ranges[1]), zaxis: axis("z, mm", ranges[2]), dragmode: "orbit",
      uirevision: state.plane, camera: camera() } });
}
