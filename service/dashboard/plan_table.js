// The table of workingsteps, sortable by its headings; each row expands to its limits.

import { announce, el, fill, fixed, number, percent, words } from "/dashboard/app.js";
import { measured, unitOf } from "/dashboard/units.js";

const TURNING = /^(facing|contouring|grooving|cutting_in|threading|knurling)/;
export const isTurning = (step) => TURNING.test(step.operation);

/** Return a limit's name in words; tools without teeth have a feed per revolution. */
export function limitWords(name, step) {
  const isWhole = isTurning(step) || / per revolution /.test(step.reason);
  return words(name === "feed_per_tooth" && isWhole ? "feed_per_revolution" : name);
}

const set = (step) => step.advised ?? step.programmed;
const saved = (step) => (step.time_s.before ?? 0) - (step.time_s.after ?? step.time_s.before ?? 0);

const COLUMNS = [
  { key: "step", title: "Workingstep", by: (step) => step.id },
  { key: "feed", title: `Feed, ${unitOf("mm/min")}`, n: true, by: (step) => set(step)?.feed_mm_min ?? -1 },
  { key: "speed", title: "Speed, rpm", n: true, by: (step) => set(step)?.spindle_rpm ?? -1 },
  { key: "depth", title: `Depth, ${unitOf("mm")} × passes`, n: true, by: (step) => set(step)?.axial_depth_mm ?? -1 },
  { key: "time", title: "Time, s", n: true, by: saved },
  { key: "limit", title: "Limit", by: (step) => step.active_limit ?? "" },
  { key: "why", title: "Reason", by: (step) => step.reason },
];

/** Fill the table. */
export function stepsTable(table, steps) {
  let sorting = null, open = null;
  const rows = el("tbody", {});
  const heads = COLUMNS.map((column) => {
    const head = el("th", { scope: "col", class: column.n ? "n" : undefined, "aria-sort": "none" },
      el("button", { type: "button", id: `sort-${column.key}`, onclick: () => sort(column) }, column.title));
    return head;
  });

  function sort(column) {
    // Numbers sort largest first, names from A; then reversed; then in program order.
    const first = column.n ? "descending" : "ascending";
    const turn = sorting?.column !== column ? first
      : sorting.turn === first ? (column.n ? "ascending" : "descending") : null;
    sorting = turn ? { column, turn } : null;
    heads.forEach((head, at) => head.setAttribute("aria-sort",
      COLUMNS[at] === column && turn ? turn : "none"));
    announce(turn ? `sorted by ${column.title}, ${turn}` : "in program order");
    draw();
  }

  function draw() {
    const order = [...steps.keys()];
    if (sorting) {
      const sign = sorting.turn === "ascending" ? 1 : -1;
      const value = order.map((at) => sorting.column.by(steps[at]));
      order.sort((a, b) => sign * (typeof value[a] === "number" ? value[a] - value[b]
        : value[a].localeCompare(value[b], "en", { numeric: true })) || a - b);
    }
    fill(rows, order.flatMap((at) => [row(at), open === at ? detail(steps[at], at) : null]));
  }

  function choose(at, isKept) {
    open = open === at ? null : at;
    draw();
    if (isKept) rows.querySelector(`[data-at="${at}"] .opener`).focus();
    table.dispatchEvent(new CustomEvent("step", { detail: open }));
  }

  function row(at) {
    const step = steps[at], isOpen = open === at;
    return el("tr", { class: `step ${step.status}`, role: "row", "data-at": String(at),
      "aria-selected": String(isOpen), onclick: (event) => {
        if (!event.target.closest("button") && !getSelection().toString()) choose(at, true);
      } },
    el("th", { scope: "row" },
      el("button", { type: "button", class: "opener", "aria-expanded": String(isOpen),
        "aria-controls": isOpen ? `detail-${at}` : undefined, onclick: () => choose(at, true) }, step.id),
      el("div", { class: "under soft small" }, `${words(step.operation)} · ${step.tool}`)),
    el("td", { class: "n", "data-label": COLUMNS[1].title },
      change(step.programmed?.feed_mm_min, step.advised?.feed_mm_min, feedIn)),
    el("td", { class: "n", "data-label": COLUMNS[2].title }, change(step.programmed?.spindle_rpm, step.advised?.spindle_rpm)),
    el("td", { class: "n", "data-label": COLUMNS[3].title }, depths(step)),
    el("td", { class: "n", "data-label": COLUMNS[4].title },
      change(step.time_s.before, step.time_s.after, (value) => fixed(value, 1))),
    el("td", { class: "limit" }, mark(step)),
    el("td", { class: "why" }, step.reason));
  }

  rows.addEventListener("keydown", (event) => {
    const move = { ArrowDown: 1, ArrowUp: -1, Home: -Infinity, End: Infinity }[event.key];
    const openers = [...rows.querySelectorAll(".opener")], at = openers.indexOf(event.target);
    if (move === undefined || at < 0) return;
    event.preventDefault();
    openers[Math.min(Math.max(at + move, 0), openers.length - 1)].focus();
  });

  fill(table, el("caption", { class: "unseen" }, "Workingsteps: as programmed and as advised"),
    el("thead", {}, el("tr", {}, heads)), rows);
  draw();
}

const four = (value) => number(value, 4);
const feedIn = (value) => four(measured(value, "mm/min")), lengthIn = (value) => four(measured(value, "mm"));

/** Create `before → after`, or one number where nothing changes. */
function change(before, after, form = four) {
  const was = form(before), is = form(after);
  if (after === undefined || after === null || was === is) return el("span", { class: "change" }, was);
  if (before === undefined || before === null) return el("span", { class: "change" }, el("b", {}, is));
  return el("span", { class: "change" }, el("span", { class: "was" }, was),
    el("span", { class: "arrow", "aria-label": "becomes" }, "→"), el("b", {}, is));
}

/** Format depth and passes; unknown passes of the program do not count as a change. */
function depths({ programmed, advised }) {
  const cuts = (setting) => (!setting?.axial_depth_mm ? null
    : number(measured(setting.axial_depth_mm, "mm"), 3) + (setting.passes ? ` × ${setting.passes}` : ""));
  const isSame = !programmed?.passes && programmed?.axial_depth_mm === advised?.axial_depth_mm;
  return change(cuts(isSame ? advised : programmed), cuts(advised), (text) => text ?? "–");
}

/** Create a badge with the active limit, or the reason why there is none. */
function mark(step) {
  if (step.status === "infeasible") return el("span", { class: "badge bad" }, "infeasible");
  if (step.status === "untouched") return el("span", { class: "badge soft" }, "untouched");
  return step.active_limit ? limitWords(step.active_limit, step) : "–";
}

// -- details of a row ---------------------------------------------------------------------------

function detail(step, at) {
  return el("tr", { class: "detail", id: `detail-${at}` }, el("td", { colspan: String(COLUMNS.length) },
    el("div", { class: "inside" }, el("div", { class: "limits" }, limits(step)),
      el("div", { class: "words" }, facts(step), sentences(step), front(step)))));
}

function limits(step) {
  if (!step.limits.length) return el("p", { class: "soft" }, "No limits were evaluated.");
  const used = ({ value, bound, sense, safety_factor: safety }) =>
    (sense === "at least" ? bound / value : safety * value / bound);
  const sorted = [...step.limits].sort((a, b) => used(b) - used(a));
  // An exceeded limit of a step that the plan leaves alone is not one of the plan.
  const isOfPlan = Boolean(step.advised) || step.status === "infeasible";
  const told = step.advised ? "as advised" : isOfPlan ? "as programmed" : "as programmed, not of this plan";
  return el("table", {}, el("caption", {}, `Limits ${told}, nearest first`),
    el("thead", {}, el("tr", {}, ["Limit", "Value and bound", "Use", "Margin"].map((title, at) =>
      el("th", { scope: "col", class: at % 2 ? "n" : undefined }, title)))),
    el("tbody", {}, sorted.map((limit) => {
      const share = used(limit), isOver = isOfPlan && limit.margin < -1e-6, isNear = limit.margin < 1e-3;
      const name = limitWords(limit.name, step);
      return el("tr", {},
        el("th", { scope: "row" }, limit.name === step.active_limit && isNear ? el("b", {}, name) : name),
        el("td", { class: "n" }, four(measured(limit.value, limit.unit)),
          limit.safety_factor === 1 ? "" : ` × ${four(limit.safety_factor)}`, limit.sense === "at least" ? " ≥ " : " ≤ ",
          `${four(measured(limit.bound, limit.unit))} ${unitOf(limit.unit)}`),
        el("td", { class: "bar" }, el("div", { class: `meter ${isOver ? "over" : isNear ? "near" : ""}`,
          role: "img", "aria-label": `${percent(share)} of ${name} used` },
        el("div", { style: `width:${(100 * Math.min(Math.max(share, 0), 1)).toFixed(1)}%` }))),
        el("td", { class: `n ${isOver ? "bad" : isNear ? "warn" : ""}` },
          limit.margin > 9.99 ? "> 999 %" : limit.margin < -9.99 ? "< −999 %" : percent(limit.margin, isNear && !isOver ? 0 : 1)));
    })));
}

function facts(step) {
  const tooth = limitWords("feed_per_tooth", step);
  const both = (name, form = four) => change(step.programmed?.[name], step.advised?.[name], form);
  const lines = [
    [`${tooth[0].toUpperCase()}${tooth.slice(1)}, ${unitOf("mm")}`, both("feed_per_tooth_mm", lengthIn)],
    step.plunge ? [`Plunge feed, ${unitOf("mm/min")}`, both("plunge_feed_mm_min", feedIn)] : null,
    [`Depth of a pass, ${unitOf("mm")}`, both("axial_depth_mm", lengthIn)],
    ["Motor power, kW", number(step.motor_power_kw)],
    ["Cutting force, N", number(step.cutting_force_n)],
    step.roughness_ra_um ? [`Roughness Ra, µm (${step.roughness_basis})`, number(step.roughness_ra_um)] : null,
    step.roughness_expected_um ? ["Roughness Ra expected, µm", number(step.roughness_expected_um)] : null,
    step.roughness_probability === null || step.roughness_probability === undefined ? null
      : ["Probability of keeping the required Ra", `${Math.round(100 * step.roughness_probability)} %`],
    ["Energy, kJ", step.energy_j === null ? "–" : number(step.energy_j / 1000, 4)],
    ["Operation", words(step.operation)],
    ["Tool", step.tool],
    ["Instance", step.instance],
  ];
  return [el("h3", {}, step.advised ? "As advised" : "As programmed"),
    el("dl", {}, lines.filter(Boolean).flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]))];
}

/** State the savings from raising a limit by one step. */
function sentences(step) {
  const found = [];
  const { sensitivity, prices } = step, deepest = step.deepest_pass_first_time_s;
  if (sensitivity) {
    const { one_more: more, unit, saves_s: saves } = sensitivity, name = limitWords(sensitivity.limit, step);
    found.push(saves > 0.005 ? `${number(more)} ${unit} more of ${name} saves ${number(saves)} s.`
      : `More ${name} alone saves nothing: another limit is just as close.`);
  }
  for (const [name, price] of Object.entries(prices ?? {}))
    found.push(`1 % more ${limitWords(name, step)} lowers the cost by ${number(price, 2)} %.`);
  if (deepest && step.time_s.after && deepest - step.time_s.after > 0.05)
    found.push(`Fewest passes would take ${fixed(deepest, 1)} s instead of ${fixed(step.time_s.after, 1)} s.`);
  return found.length ? [el("h3", {}, "Effect of higher limits"), ...found.map((text) => el("p", {}, text))] : null;
}

function front(step) {
  if (!step.pareto.length) return null;
  return el("table", {}, el("caption", {}, "Front of time, roughness (Ra ideal, not measured) and energy"),
    el("thead", {}, el("tr", {}, ["Time, s", "Ideal Ra, µm", "Energy, kJ", `Feed, ${unitOf("mm/min")}`, "Speed, rpm", "Passes"].map((title) =>
      el("th", { scope: "col", class: "n" }, title)))),
    el("tbody", {}, step.pareto.map((point) => el("tr", {}, [fixed(point.time_s, 1), number(point.roughness_ra_um),
      number(point.energy_j / 1000, 4), feedIn(point.feed_mm_min), four(point.spindle_rpm),
      String(point.passes ?? "–")].map((text) => el("td", { class: "n" }, text))))));
}

// -- CSV file -----------------------------------------------------------------------------------

/** Return the table as comma-separated values. */
export function stepsCsv(steps) {
  const columns = {
    workingstep: (step) => step.id, instance: (step) => step.instance, operation: (step) => step.operation,
    tool: (step) => step.tool, status: (step) => step.status,
    feed_programmed_mm_min: (step) => step.programmed?.feed_mm_min,
    feed_advised_mm_min: (step) => step.advised?.feed_mm_min,
    spindle_programmed_rpm: (step) => step.programmed?.spindle_rpm,
    spindle_advised_rpm: (step) => step.advised?.spindle_rpm,
    depth_programmed_mm: (step) => step.programmed?.axial_depth_mm,
    depth_advised_mm: (step) => step.advised?.axial_depth_mm,
    passes_programmed: (step) => step.programmed?.passes, passes_advised: (step) => step.advised?.passes,
    time_before_s: (step) => step.time_s.before, time_after_s: (step) => step.time_s.after,
    active_limit: (step) => step.active_limit, reason: (step) => step.reason,
  };
  // An apostrophe keeps a spreadsheet from taking a text for a formula.
  const cell = (value) => {
    const text = typeof value === "string" ? value.replace(/^[=+\-@\t\r]/, "'$&") : String(value ?? "");
    return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  const lines = [Object.keys(columns), ...steps.map((step) => Object.values(columns).map((of) => of(step)))];
  return `${lines.map((line) => line.map(cell).join(",")).join("\r\n")}\r\n`;
}
