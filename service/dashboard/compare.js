// The compare page: advice on one program side by side, with what differs in words.

import { announce, api, byId, el, fill, fixed, moment, number, tell } from "/dashboard/app.js";
import { colour, layout, plot } from "/dashboard/charts.js";
import { allPrograms, framed, programTitle } from "/dashboard/records.js";
import { measured, unitOf } from "/dashboard/units.js";

const asked = new URLSearchParams(location.search);
/** Colours that the colour-blind can tell apart (Okabe and Ito, 2008), and marks that need none. */
const COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"];
const SHAPES = ["circle", "square", "diamond", "cross", "triangle-up", "star"];
const MOST = 12;

const trouble = el("div", { id: "problem" });
const program = el("select", { id: "compare-program", onchange: () => offer() });
const choices = el("fieldset", { id: "compare-plans", class: "plain" }, el("legend", { class: "unseen" }, "plans"));
const found = el("div", { id: "compared" });
let advice = [], turn = 0, isWhole = false;

fill(byId("main"), el("div", { class: "title" }, el("h1", {}, "Compare plans"), el("span", { class: "soft" }, "of one program, by workingstep")),
  trouble, el("section", { class: "card", "aria-label": "plans" }, el("label", { class: "inline" }, "Program", program), choices), found);

begin().catch((error) => tell(trouble, error));

async function begin() {
  const [programs, page] = await Promise.all([allPrograms(), api("/v1/advice?limit=500")]);
  advice = page.items.filter((job) => job.state === "succeeded" && programs.get(job.program_id)?.kind !== "nc-code");
  const known = [...new Set(advice.map((job) => job.program_id))].filter((id) => programs.has(id));
  fill(program, known.map((id) => el("option", { value: id, selected: id === asked.get("program") }, programTitle(programs.get(id)))));
  if (!known.length) {
    fill(choices, el("p", { class: "empty" }, "No plans yet: request advice on the page Plan, in two modes or on two machines."));
    return;
  }
  offer();
}

/** Offer the plans of the chosen program, oldest first; the newest of each kind are chosen. */
function offer() {
  const plans = advice.filter((job) => job.program_id === program.value).reverse(), kinds = new Map(plans.map((job) => [words(job), job.id]));
  const newest = [...kinds.values()].slice(-4);
  fill(choices, el("legend", { class: "unseen" }, "plans"), plans.map((job) =>
    el("label", { class: "inline" }, el("input", { type: "checkbox", value: job.id,
      checked: newest.includes(job.id) || job.id === asked.get("advice"), onchange: compare }), `${words(job)}, ${moment(job.created_at)}`)));
  compare();
}

/** What was asked of a plan, in words. */
function words({ request: { mode, machine, material, free, safety } }) {
  return [mode, machine, material, free?.length ? `free: ${free.join(", ")}` : "", safety ? `margin ${safety}` : ""].filter(Boolean).join(" · ");
}

async function compare() {
  const mine = turn += 1;
  const ids = [...choices.querySelectorAll("input:checked")].map((box) => box.value);
  tell(trouble, null);
  if (ids.length < 2 || ids.length > MOST) {
    fill(found, el("p", { class: "empty" }, `Choose 2 to ${MOST} plans; ${ids.length} chosen.`));
    return;
  }
  try {
    const result = await api(`/v1/comparisons?${ids.map((id) => `advice=${id}`).join("&")}`);
    if (mine === turn) await show(result, ids);
  } catch (error) { if (mine === turn) { tell(trouble, error); fill(found); } }
}

async function show(result, ids) {
  const trade = el("div", { id: "compare-trade", role: "figure", "aria-label": "time and energy of each plan" });
  const times = el("div", { id: "compare-times", role: "figure", "aria-label": "time of each workingstep by plan" });
  const table = el("table", { id: "compare-steps" });
  const whole = el("input", { type: "checkbox", id: "compare-whole", checked: isWhole, onchange: () => { isWhole = whole.checked; steps(table, result); } });
  fill(found,
    el("section", { class: "card", "aria-label": "totals" }, framed("totals", totals(result)),
      el("ul", { id: "compare-differences" }, result.differences.map((text) => el("li", {}, text)))),
    el("section", { class: "card", "aria-label": "time and energy" }, el("h2", {}, "Time and energy"),
      el("p", { class: "soft small" }, "A click on a plan opens it."), trade),
    el("section", { class: "card", "aria-label": "time by workingstep" }, el("h2", {}, "Time by workingstep"), times),
    el("section", { class: "card", "aria-label": "workingsteps" }, el("div", { class: "row spread" }, el("h2", {}, "Workingsteps"),
      el("label", { class: "inline" }, whole, "also those that are the same")), framed("workingsteps", table)));
  steps(table, result);
  announce(`${result.plans.length} plans are compared`);
  await plot(trade, () => ({ data: result.plans.map((plan, at) => ({ x: [plan.time_s], y: [plan.energy_j / 1000], name: plan.plan, mode: "markers",
    marker: { size: 13, color: COLOURS[at % COLOURS.length], symbol: SHAPES[at % SHAPES.length], line: { color: colour("ink"), width: 1 } } })),
  layout: layout({ height: 300, showlegend: true, hovermode: "closest", xaxis: { title: { text: "time s" } }, yaxis: { title: { text: "energy kJ" } } }) }));
  trade.on("plotly_click", ({ points: [point] }) => { location.href = `/dashboard/plan.html?advice=${ids[point.curveNumber]}`; });
  await plot(times, () => ({ data: result.plans.map((plan, at) => {
    const mine = result.workingsteps.filter((step) => step.plan === plan.plan);
    return { type: "bar", name: plan.plan, x: mine.map((step) => step.workingstep), y: mine.map((step) => step.time_s), marker: { color: COLOURS[at % COLOURS.length] } };
  }), layout: layout({ height: 320, barmode: "group", showlegend: true, yaxis: { title: { text: "time s" } } }) }));
}

function totals(result) {
  const fastest = Math.min(...result.plans.map((plan) => plan.time_s));
  return el("table", { id: "compare-totals" }, el("caption", { class: "unseen" }, "Totals of each plan"),
    el("thead", {}, el("tr", {}, ["Plan", "Time s", "Energy kJ", "Unchecked limits"].map((text, at) => el("th", { scope: "col", class: at ? "n" : "" }, text)))),
    el("tbody", {}, result.plans.map((plan) => el("tr", {}, el("th", { scope: "row" }, plan.plan),
      // Never green with limits that nobody checked.
      el("td", { class: `n ${plan.time_s === fastest && !plan.unchecked ? "good" : ""}` }, fixed(plan.time_s, 1)),
      el("td", { class: "n" }, fixed(plan.energy_j / 1000, 1)),
      el("td", { class: `n ${plan.unchecked ? "warn" : ""}` }, plan.unchecked ?? "0")))));
}

/** Fill the table; without those that run alike in all plans unless they are asked for. */
function steps(table, { plans, workingsteps }) {
  const rows = [];
  for (let at = 0; at < workingsteps.length; at += plans.length) {
    const group = workingsteps.slice(at, at + plans.length);
    const like = ({ feed_mm_min: feed, spindle_rpm: speed, depth_x_passes: depth }) => [number(feed, 6), number(speed, 6), depth].join();
    if (isWhole || new Set(group.map(like)).size > 1) rows.push(group);
  }
  fill(table, el("caption", { class: "unseen" }, "Workingsteps in each plan"),
    el("thead", {}, el("tr", {}, ["Workingstep", "Plan", `Feed ${unitOf("mm/min")}`, "rpm", "Depth mm × passes", "Limit", "Ideal Ra µm", "Time s"].map((text, at) =>
      el("th", { scope: "col", class: [2, 3, 4, 6, 7].includes(at) ? "n" : "" }, text)))),
    rows.length ? rows.map((group) => el("tbody", {}, group.map((step, at) => el("tr", {},
      at ? null : el("th", { scope: "rowgroup", rowspan: String(group.length) }, step.workingstep),
      el("td", {}, step.plan), el("td", { class: "n" }, step.feed_mm_min === null ? "–" : fixed(measured(step.feed_mm_min, "mm/min"), 1)),
      el("td", { class: "n" }, step.spindle_rpm === null ? "–" : fixed(step.spindle_rpm, 0)),
      el("td", { class: "n" }, (step.depth_x_passes ?? "–").replace("x", "×")), el("td", {}, step.active_limit),
      el("td", { class: "n" }, step.roughness_ra_um === null ? "–" : number(step.roughness_ra_um)),
      el("td", { class: "n" }, step.time_s === null ? "–" : fixed(step.time_s, 1))))))
      : el("tbody", {}, el("tr", {}, el("td", { colspan: "8", class: "soft" }, "All workingsteps run alike in these plans."))));
}
