// The map of deviations: the surface in plan on a canvas, and in 3D, coloured by deviation.

import { byId, el, fill, fixed, number } from "/dashboard/app.js";
import { colour, layout, plot } from "/dashboard/charts.js";
import { FlatView } from "/dashboard/plan_flat.js";

const LEVELS = 21;
/** Colours from gouge over none to excess. */
const SCALES = {
  light: ["#9e0f22", "#e0604d", "#cdd3d9", "#5aa0d0", "#0b4f9c"],
  dark: ["#ff5c5c", "#b4524f", "#3d4853", "#3f83b8", "#7cc8ff"],
};
/** Walls without a deviation in plan, darker than floors, so that the part can be recognised. */
const WALLS = { light: "#98a4b0", dark: "#6d7a88" };
/** Angles at which a turned profile is shown in 3D. */
const TURNS = 36, MOST_TURNED = 700;

const state = { map: null, found: null, view: "plan", show: "beyond", scale: "tolerance", step: "", mark: null,
  flat: null, isBound: false };

let webgl = null;
function hasWebGl() {
  if (webgl === null) {
    const canvas = el("canvas");
    webgl = Boolean(canvas.getContext("webgl2") ?? canvas.getContext("webgl"));
  }
  return webgl;
}

/** Show the map of a verification. */
export async function showMap(map, found) {
  Object.assign(state, { map, found, mark: null, step: "" });
  const used = [...new Set(map.workingstep)].sort((a, b) => a - b);
  fill(byId("map-step"), el("option", { value: "" }, "all"),
    used.map((at) => el("option", { value: String(at) }, map.workingsteps[at])));
  byId("map-flat").hidden = hasWebGl();
  byId("map-view").lastElementChild.disabled = !hasWebGl();
  if (!state.isBound) bind();
  await draw();
}

/** Mark a place, by its position in mm. */
export async function markPlace(at, words) {
  state.mark = { at, words };
  if (state.step && !stepsAt(at).includes(Number(state.step))) byId("map-step").value = state.step = "";
  await draw();
  if (state.view === "plan") state.flat.reveal(...flatten(at));
}

/** Workingsteps of the place nearest to a position. */
function stepsAt([x, y, z]) {
  const { map } = state;
  let least = Infinity, found = [];
  for (let at = 0; at < map.places; at += 1) {
    const far = (map.x_mm[at] - x) ** 2 + (map.y_mm[at] - y) ** 2 + (map.z_mm[at] - z) ** 2;
    if (far < least) { least = far; found = [map.workingstep[at]]; }
  }
  return found;
}

function bind() {
  state.isBound = true;
  state.flat = new FlatView(byId("map-plan"));
  byId("map-view").addEventListener("click", (event) => {
    const value = event.target.closest("button")?.dataset.value;
    if (value) { state.view = value; draw(); }
  });
  for (const name of ["show", "scale", "step"])
    byId(`map-${name}`).addEventListener("change", (event) => { state[name] = event.target.value; draw(); });
}

// -- colours ----------------------------------------------------------------------------------

/** Ends of the colour scale, mm. */
function limit() {
  const { map, found } = state;
  if (state.scale === "tolerance") return 2 * found.tolerance_mm;
  let most = found.tolerance_mm;
  for (let at = 0; at < map.places; at += 1)
    if (state.show === "all" || isSeen(at)) most = Math.max(most, Math.abs(map.deviation_mm[at]));
  return most;
}

const isSeen = (at) => state.map.least_mm[at] > 0;
/** Deviation that is coloured: none where it does not exceed its uncertainty, unless all are wanted. */
const shownOf = (at) => (state.show === "all" || isSeen(at) ? state.map.deviation_mm[at] : 0);

const stops = () => SCALES[document.documentElement.dataset.theme] ?? SCALES.light;

function between(share) {
  const all = stops(), place = share * (all.length - 1), low = Math.min(Math.floor(place), all.length - 2);
  const part = (text, at) => parseInt(text.slice(1 + 2 * at, 3 + 2 * at), 16);
  const mixed = [0, 1, 2].map((at) => Math.round(part(all[low], at) + (place - low) * (part(all[low + 1], at) - part(all[low], at))));
  return `rgb(${mixed.join(",")})`;
}

const levels = () => [...Array(LEVELS).keys()].map((level) => between(level / (LEVELS - 1)));
const levelOf = (value, end) => Math.round((LEVELS - 1) * (0.5 + 0.5 * Math.max(-1, Math.min(1, value / end))));

/** Places of the chosen workingstep. */
function chosen() {
  const wanted = state.step === "" ? null : Number(state.step), found = [];
  for (let at = 0; at < state.map.places; at += 1) if (wanted === null || state.map.workingstep[at] === wanted) found.push(at);
  return found;
}

// -- both views -------------------------------------------------------------------------------

async function draw() {
  const { map } = state, isSolid = state.view === "solid" && hasWebGl();
  for (const button of byId("map-view").children)
    button.setAttribute("aria-pressed", String(button.dataset.value === (isSolid ? "solid" : "plan")));
  byId("map-show").value = state.show;
  byId("map-scale").value = state.scale;
  byId("map-plan").hidden = isSolid;
  byId("map-solid").hidden = !isSolid;
  const seen = Array.from({ length: map.places }, (_, at) => at).filter(isSeen).length;
  const label = `map of deviations, ${isSolid ? "3D" : "plan"}: ${seen} of ${map.places} places exceed their uncertainty`;
  if (isSolid) {
    await plot(byId("map-solid"), () => ({ data: traces(), layout: solid() }));
    byId("map-solid").setAttribute("aria-label", label);
  } else {
    byId("map-solid").redraw = null;
    drawPlan(label);
  }
  const end = limit(), tones = stops();
  fill(byId("map-keys"), [[tones[0], "gouge: too much is cut away"], [tones[4], "excess: material is left"],
    [tones[2], state.show === "all" ? "no deviation" : "within the uncertainty of the log"]].map(([tint, text]) =>
    el("span", { class: "nowrap" }, el("span", { class: "key", style: `background:${tint}` }), ` ${text}`)));
  byId("map-note").textContent = `${map.places.toLocaleString("en-GB")} places are shown, the worst and others evenly spread; `
    + (map.left_out ? `${map.left_out.toLocaleString("en-GB")} are left out, ${map.left_out_beyond_mm
      ? `which exceed their uncertainty by at most ${fixed(map.left_out_beyond_mm, 4)} mm` : "none of which exceeds its uncertainty"}. ` : "none is left out. ")
    + `Deviations beyond ± ${number(end)} mm have the colours of the ends.`;
}

function told(at) {
  const { map } = state, value = map.deviation_mm[at];
  return [`${value < 0 ? "gouge" : "excess"} ${fixed(Math.abs(value), 4)} ± ${fixed(map.uncertainty_mm[at], 4)} mm`,
    `${map.workingsteps[map.workingstep[at]]}, ${map.kinds[map.kind[at]]}`,
    `${[map.x_mm[at], map.y_mm[at], map.z_mm[at]].map((each) => fixed(each, 2)).join(", ")} mm`,
    [map.block[at] ? `block ${map.block[at]}` : "", map.time_s[at] === null ? "" : `${fixed(map.time_s[at], 2)} s`].filter(Boolean).join(", ")]
    .filter(Boolean);
}

// -- plan -------------------------------------------------------------------------------------

/** Position in the plane: x and y; of a turned part z and the radius. */
const flatten = ([x, y, z]) => (state.map.is_turned ? [z, x] : [x, y]);

function drawPlan(label) {
  const { map } = state, end = limit(), tints = levels(), at = chosen();
  const [x, y] = map.is_turned ? [map.z_mm, map.x_mm] : [map.x_mm, map.y_mm];
  const isFloor = map.kinds.map((name) => name === "floor");
  const floors = at.filter((each) => isFloor[map.kind[each]]), others = at.filter((each) => !isFloor[map.kind[each]]);
  // What deviates most is drawn last, on top of what lies above or below it.
  const dots = [...groups(floors, end, tints, { size: spacing(floors, x, y), least: 2 }),
    ...groups(others, end, tints, { size: 0.25, least: 3.5 })];
  dots.sort((a, b) => a.rank - b.rank);
  const titles = map.is_turned ? ["z, mm", "radius, mm"] : ["x, mm", "y, mm"];
  state.flat.show({ dots, x, y, titles, label, key: state.found, tell: told, again: () => drawPlan(label),
    mark: state.mark ? flatten(state.mark.at) : null,
    bar: { title: "deviation, mm", low: -end, high: end, colours: tints } });
}

function groups(places, end, tints, more) {
  const found = new Map();
  for (const at of places) {
    const level = levelOf(shownOf(at), end);
    if (!found.has(level)) found.set(level, []);
    found.get(level).push(at);
  }
  const middle = (LEVELS - 1) / 2, isWall = more.size < 0.3;
  return [...found].map(([level, at]) => ({ at, ...more, rank: Math.abs(level - middle) * 2 + (isWall ? 1 : 0),
    colour: level === middle && isWall ? WALLS[document.documentElement.dataset.theme] ?? WALLS.light : tints[level] }));
}

/** Size of the squares of floors that leaves few gaps, mm. */
function spacing(places, x, y) {
  if (places.length < 2) return 0.5;
  const span = (values) => {
    let low = Infinity, high = -Infinity;
    for (const at of places) { low = Math.min(low, values[at]); high = Math.max(high, values[at]); }
    return high - low;
  };
  return 1.15 * Math.sqrt((span(x) * span(y)) / places.length);
}

// -- 3D ---------------------------------------------------------------------------------------

function traces() {
  const { map } = state, end = limit(), at = map.is_turned ? thinned(chosen()) : chosen(), all = stops();
  const turns = map.is_turned ? [...Array(TURNS).keys()].map((turn) => (2 * Math.PI * turn) / TURNS) : [null];
  const points = turns.flatMap((angle) => at.map((each) => ({ each, at: inSpace(each, angle) })));
  const isNarrow = byId("map-solid").clientWidth < 520;
  const data = [{ type: "scatter3d", mode: "markers", ...columns(points.map((point) => point.at)),
    text: points.map(({ each }) => told(each).join("<br>")), hovertemplate: "%{text}<extra></extra>",
    marker: { size: isNarrow ? 2 : 2.6, color: points.map(({ each }) => shownOf(each)), cmin: -end, cmax: end,
      colorscale: all.map((name, place) => [place / (all.length - 1), name]), opacity: 1,
      colorbar: { title: { text: "deviation, mm", side: "right" }, thickness: 12, len: 0.85, outlinewidth: 0 } } }];
  if (state.mark) {
    const place = map.is_turned ? [state.mark.at[2], state.mark.at[0], 0] : state.mark.at;
    data.push({ type: "scatter3d", mode: "markers", ...columns([place]), text: [state.mark.words],
      hovertemplate: "%{text}<extra></extra>", marker: { size: 11, symbol: "circle-open", color: colour("ink"), line: { width: 4, color: colour("ink") } } });
  }
  return data;
}

const columns = (points) => Object.fromEntries(["x", "y", "z"].map((name, axis) => [name, points.map((point) => point[axis])]));

function inSpace(at, angle) {
  const { map } = state;
  if (angle === null) return [map.x_mm[at], map.y_mm[at], map.z_mm[at]];
  return [map.z_mm[at], map.x_mm[at] * Math.cos(angle), map.x_mm[at] * Math.sin(angle)];
}

/** Fewer places of a profile, the worst among them, for each of them is turned around the axis. */
function thinned(places) {
  if (places.length <= MOST_TURNED) return places;
  const size = (at) => (isSeen(at) ? Math.abs(state.map.deviation_mm[at]) : 0), step = Math.ceil((2 * places.length) / MOST_TURNED);
  const worst = [...places].sort((one, other) => size(other) - size(one)).slice(0, MOST_TURNED / 2);
  return [...new Set([...worst, ...places.filter((_, index) => index % step === 0)])];
}

function solid() {
  const axis = (text) => ({ title: { text }, gridcolor: colour("rule"), zerolinecolor: colour("rule"), color: colour("ink"),
    showbackground: false, nticks: 5, showspikes: false });
  const titles = state.map.is_turned ? ["z, mm", "x, mm", "y, mm"] : ["x, mm", "y, mm", "z, mm"];
  return layout({ hovermode: "closest", height: byId("map-solid").clientHeight || 520, margin: { l: 0, r: 0, t: 0, b: 0 },
    uirevision: state.found.log, dragmode: "orbit", scene: { aspectmode: "data", dragmode: "orbit", uirevision: state.found.log,
      xaxis: axis(titles[0]), yaxis: axis(titles[1]), zaxis: axis(titles[2]),
      camera: state.map.is_turned ? { eye: { x: 0.7, y: -2.6, z: 1.1 }, center: { x: 0, y: 0, z: 0 } }
        : { eye: { x: 1.05, y: -1.55, z: 1.25 }, center: { x: 0, y: 0, z: -0.1 } } } });
}
