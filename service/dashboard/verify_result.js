// A verification: its verdict, the table of workingsteps, bands, what the log can and cannot tell.

import { byId, duration, el, figure, fill, fixed, number, percent, save, show, tell } from "/dashboard/app.js";
import { findingsList } from "/dashboard/plan_program.js";
import { markPlace, showMap } from "/dashboard/verify_map.js";

const SIGNS = ["gouge", "excess"], MICRO = 1e-9;
const FEEL = { gouge: "too much is cut away", excess: "material is left" };
let job = null, result = null;

/** Return the deviation of a sign on a surface, as one object. */
function spot(row, sign) {
  const get = (name) => row[`${sign}_${name}`];
  return { sign, size: get("mm"), uncertainty: get("uncertainty_mm"),
    least: get("least_mm") ?? get("mm") - get("uncertainty_mm"), at: get("at_mm"), block: get("block"),
    time: get("time_s"), by: get("cut_by"), row };
}

const excessOf = (one) => one.least;
const isSeen = (one) => one.least > 0;
const isWrong = (one) => isSeen(one) && one.size >= result.tolerance_mm - MICRO;
const most = (spots, of) => spots.reduce((best, each) => (best && of(best) >= of(each) ? best : each), null);
const worse = (row) => most(SIGNS.map((sign) => spot(row, sign)), excessOf);

const size = (one) => `${fixed(one.size, 4)} ± ${fixed(one.uncertainty, 4)} mm${
  isSeen(one) && one.size <= one.uncertainty ? `, at least ${fixed(one.least, 4)} mm` : ""}`;
const on = (row) => (row.workingstep === "raw part" ? `${row.surface} of the raw part` : `${row.surface} of ${row.workingstep}`);
const xyz = (at) => at.map((each) => fixed(each, 2)).join(", ");
const where = (one) => [`at ${xyz(one.at)} mm`, one.block ? `block ${one.block}` : "",
  one.time === null ? "" : `${fixed(one.time, 2)} s`, one.by ? `cut by ${one.by}` : ""].filter(Boolean).join(", ");

/** Show a verification. */
export async function showResult(asked, found, map) {
  [job, result] = [asked, found];
  byId("result-of").textContent = [found.log, found.program, found.machine].join(" · ");
  const spots = found.surfaces.flatMap((row) => SIGNS.map((sign) => spot(row, sign)));
  verdict(spots);
  figures(spots);
  fill(byId("result-findings"), cautions(), findingsList(found.findings, "of the log"));
  byId("download-log").hidden = !asked.request.monitor;
  byId("surfaces").replaceChildren(...table(found.surfaces));
  fill(byId("surface-detail"));
  bands(found);
  resolution(found);
  fill(byId("not-seen"), found.not_seen.map((text) => el("li", {}, text.replace("--with-deflection adds", "“add the predicted deflection” adds"))));
  await showMap(map, found);
}

function verdict(spots) {
  const wrong = spots.filter(isWrong), seen = spots.filter(isSeen);
  const worst = most(wrong.length ? wrong : seen, wrong.length ? (one) => one.size : excessOf);
  const [lamp, word] = wrong.length ? ["over", "ERROR"] : blindSpots().length ? ["idle", "NO ERROR SEEN"] : ["safe", "WITHIN TOLERANCE"];
  const told = !worst ? `Nothing exceeds the uncertainty of this log. Tolerance ± ${number(result.tolerance_mm)} mm.`
    : `${worst.sign === "gouge" ? "Gouge" : "Excess"} of ${size(worst)} (${FEEL[worst.sign]}) on the ${on(worst.row)}, ${where(worst)}. `
      + (wrong.length ? `${places(wrong)} beyond ± ${number(result.tolerance_mm)} mm.` : `Tolerance ± ${number(result.tolerance_mm)} mm.`);
  fill(byId("verdict"), el("span", { class: `lamp ${lamp}`, id: "lamp" }, word), el("p", { id: "verdict-text" }, told));
}

function places(wrong) {
  const rows = new Set(wrong.map((one) => one.row)).size;
  return rows === 1 ? "One surface is" : `${rows} surfaces are`;
}

function figures(spots) {
  const greatest = (sign) => most(spots.filter((one) => one.sign === sign), excessOf);
  const tile = (name, one) => figure(name, fixed(one.size, 4), `± ${fixed(one.uncertainty, 4)} mm`,
    isWrong(one) ? "bad" : isSeen(one) ? "warn" : "");
  const { volumes, samples } = result, rate = samples.interval_s ? `${number(1 / samples.interval_s)} Hz` : "";
  fill(byId("figures"), tile("Greatest gouge", greatest("gouge")), tile("Greatest excess", greatest("excess")),
    figure("Removed, logged", fixed(volumes.logged_mm3 / 1000, 2), "cm³"),
    figure("Removed, programmed", fixed(volumes.programmed_mm3 / 1000, 2), "cm³"),
    figure("Positions", samples.count.toLocaleString("en-GB"), rate));
}

/** Where the log cannot tell whether the tolerance is kept, with what it resolves there. */
function blindSpots() {
  const { resolution: can, tolerance_mm: tolerance } = result;
  return [[can.straight_mm, "on straights"], [can.arc_radius_mm === null ? 0 : can.arc_mm, `on arcs of R ${number(can.arc_radius_mm)} mm`],
    [can.square_corner_mm, "at square corners"]].filter(([value]) => value > tolerance);
}

function cautions() {
  const blind = blindSpots(), can = result.resolution;
  return blind.length ? el("div", { class: "banner warn", id: "blind" }, `With ${number(can.step_mm)} mm between positions, this log resolves `,
    blind.map(([value, words]) => `${fixed(value, 4)} mm ${words}`).join(" and "),
    `: more than the tolerance. Smaller errors there stay unseen; a higher rate or a lower feed shows them.`) : null;
}

// -- table ------------------------------------------------------------------------------------

function table(rows) {
  const head = [["Workingstep", ""], ["Gouge mm", "n"], ["Excess mm", "n"], ["Worst place", ""]];
  return [el("thead", {}, el("tr", {}, head.map(([text, kind]) => el("th", { scope: "col", class: kind }, text)))),
    el("tbody", {}, rows.map(line))];
}

function line(row) {
  const one = worse(row);
  const cell = (sign) => {
    const each = spot(row, sign);
    return el("td", { class: `n ${isWrong(each) ? "wrong" : isSeen(each) ? "seen" : "unseen-size"}` },
      fixed(each.size, 4), el("div", { class: "soft small thin" }, `± ${fixed(each.uncertainty, 4)}`));
  };
  return el("tr", { class: SIGNS.some((sign) => isWrong(spot(row, sign))) ? "wrong" : "", onclick: () => choose(row) },
    el("th", { scope: "row" }, el("button", { type: "button", class: "opener", "aria-pressed": "false" }, row.workingstep),
      el("div", { class: "soft small" }, [row.surface, row.feature].filter(Boolean).join(", "))),
    cell("gouge"), cell("excess"),
    el("td", { class: "place small" }, el("span", { class: "whole" }, xyz(one.at)), el("div", { class: "soft" },
      [one.block ? `block ${one.block}` : "", one.time === null ? "" : `${fixed(one.time, 2)} s`].filter(Boolean).join(", ") || "–")));
}

/** Select a surface: its worse place is marked on the map, and its details are shown. */
function choose(row) {
  const at = result.surfaces.indexOf(row);
  [...byId("surfaces").tBodies[0].rows].forEach((each, index) => {
    each.setAttribute("aria-selected", String(index === at));
    each.querySelector(".opener").setAttribute("aria-pressed", String(index === at));
  });
  const mark = (one) => markPlace(one.at, `${one.sign} ${size(one)}, ${on(row)}`);
  mark(worse(row));
  const link = (one) => el("button", { type: "button", class: "link", onclick: () => mark(one) }, xyz(one.at));
  const facts = [
    ...SIGNS.map((sign) => spot(row, sign)).map((one) => [one.sign === "gouge" ? "Gouge" : "Excess",
      [size(one), " at ", link(one), ` mm${one.block ? `, block ${one.block}` : ""}${one.time === null ? "" : `, ${fixed(one.time, 2)} s`}${one.by ? `, cut by ${one.by}` : ""}`]]),
    ["Beyond the uncertainty", `${percent(row.beyond, 1)} of ${fixed(row.area_mm2, 0)} mm²`],
    row.nominal_mm ? ["To the nominal feature", `${signed(row.nominal_mm[0])} to ${signed(row.nominal_mm[1])} mm`] : null,
    row.predicted_deflection_mm === null ? null
      : ["Predicted deflection of the tool", `${fixed(row.predicted_deflection_mm, 4)} mm, on top of the excess`],
  ].filter(Boolean);
  fill(byId("surface-detail"), el("h3", {}, `${row.workingstep}, ${row.surface}`),
    el("dl", { class: "facts" }, facts.flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)])));
}

const signed = (value) => `${value < 0 && fixed(value, 4) !== "0.0000" ? "−" : "+"}${fixed(Math.abs(value), 4)}`;

// -- what is beside the table -----------------------------------------------------------------

function bands(found) {
  fill(byId("bands"), el("thead", {}, el("tr", {}, ["± mm", "share of the area"].map((text) => el("th", { scope: "col" }, text)))),
    el("tbody", {}, found.bands.map(({ width_mm: width, share }) => el("tr", {},
      el("th", { scope: "row" }, number(width, 4)), el("td", {}, el("div", { class: "share" },
        el("span", {}, el("i", { style: `width:${100 * share}%` })), el("span", { class: "n" }, percent(share, 2))))))));
}

function resolution({ resolution: can, samples, cell_mm: cell }) {
  const facts = [
    ["Positions", `${samples.count.toLocaleString("en-GB")}${samples.interval_s ? `, every ${number(samples.interval_s)} s` : ""}`],
    ["Between positions in the cut", `${number(can.step_mm)} mm`],
    ["Rounding of positions", samples.rounding_mm ? `${number(samples.rounding_mm)} mm` : "none found"],
    ["On straights", `${fixed(can.straight_mm, 4)} mm`],
    ["On arcs", can.arc_radius_mm === null ? "no arcs" : `${fixed(can.arc_mm, 4)} mm at R ${number(can.arc_radius_mm)} mm`],
    ["At square corners", `${fixed(can.square_corner_mm, 4)} mm`],
    ["Gaps", samples.gaps ? `${samples.gaps}, up to ${duration(samples.longest_gap_s)}` : "none"],
    ["Places are known to", `a cell of ${number(cell)} mm`],
  ];
  fill(byId("resolution"), facts.flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]));
}

// -- downloads --------------------------------------------------------------------------------

const doing = (id, work) => byId(id).addEventListener("click", () => {
  tell(byId("download-problem"), null);
  work(`/v1/verifications/${job.id}`).catch((error) => tell(byId("download-problem"), error));
});
doing("open-report", (path) => show(`${path}/report`));
doing("download-csv", (path) => save(`${path}/places?form=csv`));
doing("download-parquet", (path) => save(`${path}/places?form=parquet`));
doing("download-log", (path) => save(`${path}/log`));
doing("download-json", async () => {
  const blob = new Blob([JSON.stringify(result, null, 2)], { type: "application/json" });
  const link = el("a", { href: URL.createObjectURL(blob), download: `verification-${job.id}.json` });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
});
