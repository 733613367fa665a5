// The evaluation table: the two-level header of Ridwan, Xu and Liu, Table 1; a line for each side.

import { announce, el, fill, fixed, number, words } from "/dashboard/app.js";
import { framed } from "/dashboard/records.js";
import { measured, unitOf } from "/dashboard/units.js";

const GRADES = ["violated", "wasted", "D", "C", "B", "A", "unknown"];
const TONES = { violated: "bad", wasted: "warn", D: "bad", C: "warn", B: "good", A: "good", unknown: "soft" };

const sides = (row) => [row.roughing, row.finishing].filter(Boolean);
const isFinishing = (side) => side.operation === "finishing";
const change = (before, after) => {
  const [planned, was] = [number(before), number(after)];
  if (after === null || planned === was) return planned;
  return before === null ? was : `${planned} → ${was}`;
};

/** Format mean, scatter and trend of a deviation. */
function deviation(seen) {
  if (seen.mean_percent === null) return "–";
  const mean = Math.round(seen.mean_percent) + 0;
  const scatter = seen.deviation_percent === null ? "" : ` ± ${fixed(seen.deviation_percent, 0)}`;
  const arrow = seen.trend_is_significant ? (seen.trend_percent_per_run > 0 ? " ↑" : " ↓") : "";
  return `${mean > 0 ? "+" : ""}${String(mean).replace("-", "−")}${scatter}${arrow}`;
}

function toneOf(name, seen) {
  const off = name === "roughness" ? Math.max(seen.mean_percent ?? 0, 0) : Math.abs(seen.mean_percent ?? 0);
  return off > 20 ? "bad" : off > 10 ? "warn" : "";
}

const deviating = (name, label) => ({ label, order: (side) => Math.abs(side.deviations[name].mean_percent ?? -1),
  text: (side) => deviation(side.deviations[name]), tone: (side) => toneOf(name, side.deviations[name]), isFigure: true });
const ofRow = (label, text, more = {}) => ({ label, isOfRow: true, text: (side, row) => text(row), ...more });
const figures = (label, text, order) => ({ label, isFigure: true, text, order });

/**
 * Columns by the upper level of the header: results first, then conditions; `order` returns the sort key of a
 * side.
 */
function columns(rows) {
  const programs = new Set(rows.map((row) => row.program));
  return [
    ["", [ofRow("#", (row) => String(row.at), { isFigure: true, order: (side, row) => row.at }),
      ofRow("Machine_ID", (row) => row.machine), programs.size > 1 ? ofRow("Program", (row) => row.program || "–") : null,
      ofRow("Feature_ID", (row) => words(row.feature), { isHead: true }),
      { label: "Side", text: (side) => (isFinishing(side) ? "finish" : "rough") },
      { label: "Grade", text: (side) => side.grade, isBadge: true, order: (side) => GRADES.length - GRADES.indexOf(side.grade) }]],
    ["Deviation from plan, %", [figures("runs", (side) => String(side.runs), (side) => side.runs),
      deviating("roughness", "surface"), deviating("time", "time"), deviating("force", "force"), deviating("feed", "feed")]],
    ["Learned", [
      figures("k_c factor", (side) => (side.kc_factor === null ? "–"
        : `${fixed(side.kc_factor, 2)} (${fixed(side.kc_factor_low, 2)}–${fixed(side.kc_factor_high, 2)})${side.kc_factor_is_pending ? "*" : ""}`),
      (side) => side.kc_factor ?? -1)]],
    ["Geometrical data", [
      ofRow("L/X mm", (row) => (row.length_mm === null && row.width_mm === null ? "–" : `${number(row.length_mm, 4)}/${number(row.width_mm, 4)}`),
        { isFigure: true, order: (side, row) => row.length_mm ?? -1 }),
      ofRow("a_t mm", (row) => number(row.total_depth_mm), { isFigure: true, order: (side, row) => row.total_depth_mm ?? -1 }),
      figures("a_s mm", (side) => (isFinishing(side) ? "" : depth(side)), (side) => side.step_depth_predicted_mm ?? -1)]],
    ["Workpiece material", [ofRow("ID", (row) => row.material),
      figures("k_c N/mm²", (side) => number(side.k_c11_n_mm2, 4), (side) => side.k_c11_n_mm2 ?? -1)]],
    ["Cutting tool", [{ label: "ID", text: (side) => side.tool || "–", isWrapped: true },
      figures(`V_c ${unitOf("m/min")}`, (side) => number(measured(side.cutting_speed_m_min, "m/min")), (side) => side.cutting_speed_m_min ?? -1)]],
    ["Roughing f_z, mm", [
      figures("predicted", (side) => (isFinishing(side) ? "" : number(side.feed_per_tooth_predicted_mm)), (side) => side.feed_per_tooth_predicted_mm ?? -1),
      figures("evaluated", (side) => (isFinishing(side) ? "" : number(side.feed_per_tooth_evaluated_mm)), (side) => side.feed_per_tooth_evaluated_mm ?? -1)]],
    ["Finishing, mm", [
      figures("f_z", (side) => (isFinishing(side) ? change(side.feed_per_tooth_predicted_mm, side.feed_per_tooth_evaluated_mm) : ""),
        (side) => (isFinishing(side) ? side.feed_per_tooth_predicted_mm ?? 0 : -1)),
      figures("a_s", (side) => (isFinishing(side) ? depth(side) : ""), (side) => (isFinishing(side) ? side.step_depth_predicted_mm ?? 0 : -1))]],
    ["Cutting", [{ label: "Type", text: (side) => side.immersion_type || "–" },
      { label: "Strategy", text: (side) => words(side.strategy) || "–", isWrapped: true }]],
  ].map(([title, list]) => [title, list.filter(Boolean)]);
}

const depth = (side) => change(side.step_depth_predicted_mm, side.step_depth_evaluated_mm);

/** Create the table, with recommended actions below each row. */
export function evaluationTable(found) {
  if (!found.rows.length) return el("p", { class: "empty", id: "no-rows" }, "No rows: no outcome matches the selection, or the filter removes all.");
  const rows = found.rows.map((row, at) => ({ ...row, at: at + 1 }));
  const groups = columns(rows), flat = groups.flatMap(([, list]) => list);
  let sorted = null;
  const body = el("table", { class: "sides", id: "evaluation" });
  const legend = el("p", { class: "soft small" },
    "Deviation: measured over planned, minus one; mean ± standard deviation; ↑ ↓ significant trend from run to run. " +
    "Grade: A within 5 %, B 10 %, C 20 %, D more; violated: the force exceeded its bound; wasted: it stayed far below. " +
    "k_c factor: measured over catalogue value, with the interval of 9 in 10 next runs; * differs from the factor that plans apply.");

  function sort(column) {
    const isFalling = sorted?.column === column ? !sorted.isFalling : Boolean(column.order) && column.label !== "#";
    sorted = { column, isFalling };
    const keyOf = (row) => {
      const keys = sides(row).map((side) => (column.order ?? column.text)(side, row));
      return keys.reduce((one, other) => ((isFalling ? other > one : other < one) ? other : one));
    };
    const compare = (one, other) => {
      const [a, b] = [keyOf(one), keyOf(other)];
      const by = typeof a === "number" ? a - b : a.localeCompare(b, "en", { numeric: true });
      return (isFalling ? -by : by) || one.at - other.at;
    };
    draw([...rows].sort(compare));
    body.querySelectorAll("thead button")[flat.indexOf(column)].focus();
    announce(`sorted by ${column.label}, ${isFalling ? "largest" : "smallest"} first`);
  }

  function draw(shown) {
    fill(body, el("caption", { class: "unseen" }, "Evaluation of outcomes, feature by feature"),
      el("thead", {},
        el("tr", {}, groups.map(([title, list]) => el("th", { scope: "colgroup", colspan: String(list.length), class: title ? "first" : "" }, title))),
        el("tr", {}, groups.flatMap(([title, list]) => list.map((column, at) => el("th", { scope: "col",
          class: `${column.isFigure ? "n" : ""} ${title && !at ? "first" : ""} ${column.isHead ? "kept" : ""}`,
          "aria-sort": sorted?.column === column ? (sorted.isFalling ? "descending" : "ascending") : undefined },
        el("button", { type: "button", "aria-label": `${title} ${column.label}`.trim(), onclick: () => sort(column) }, column.label,
          el("span", { class: "order", "aria-hidden": "true" }, sorted?.column !== column ? "" : sorted.isFalling ? "▾" : "▴"))))))),
      shown.map((row) => el("tbody", {}, lines(row), remarks(row))));
  }

  function lines(row) {
    const both = sides(row);
    return both.map((side, line) => el("tr", {}, groups.flatMap(([title, list]) => list.map((column, at) => {
      if (column.isOfRow && line) return null;
      const tag = column.isHead ? "th" : "td", tone = column.tone?.(side) ?? "";
      const text = column.text(side, row);
      return el(tag, { scope: column.isHead ? "rowgroup" : undefined,
        rowspan: column.isOfRow && both.length > 1 ? String(both.length) : undefined,
        class: `${column.isFigure ? "n" : ""} ${title && !at ? "first" : ""} ${tone} ${column.isHead ? "kept" : ""} ${column.isWrapped ? "wrapped" : ""}` },
      column.isBadge ? el("span", { class: `badge ${TONES[text]}` }, text) : text);
    }))));
  }

  const remarked = (row) => sides(row).flatMap((side) => side.remarks.map((each) => [side, each]));

  function remarks(row) {
    const all = remarked(row);
    if (!all.length) return null;
    return el("tr", {}, el("td", { class: "remarks", colspan: String(flat.length) }, el("div", {},
      el("ul", { class: "plain small", "aria-label": `recommended actions for ${row.feature}` }, all.map(([side, each]) =>
        el("li", {}, el("span", { class: "soft" }, `${isFinishing(side) ? "finish" : "rough"}: `), `${each.observed}: `, el("strong", {}, each.advice)))))));
  }

  draw(rows);
  const frame = framed("evaluation table", body);
  frame.classList.add("tall");
  return el("div", {}, frame, legend);
}
