// Factors on k_c, proposed and accepted, with their uncertainty; a person accepts or withdraws them.

import { announce, api, counted, done, el, fill, fixed, moment, percent, tell } from "/dashboard/app.js";
import { colour, layout, plot } from "/dashboard/charts.js";
import { confirmed, framed } from "/dashboard/records.js";

const PERSON = "stepnc.person";
const HEAD = ["Context", "Latest proposal", "Within ±10 %", "In force", "Objections"];

const contextOf = (each) => [each.machine, each.material, each.tool].join("\u0000");
const half = (each) => 0.5 * (each.factor_high - each.factor_low);
const factorWords = (each) => `k_c × ${fixed(each.factor, 2)} ± ${fixed(half(each), 2)}`;
const contextWords = (each) => `${each.tool} in ${each.material} on ${each.machine}`;

const act = (kind, word, label, work) => el("button", { class: "small", "data-act": kind, "aria-label": label, onclick: work }, word);

/** Badge with the latest decision; none for a factor that another has replaced. */
const standing = (each, inForce) => (each.standing === "accepted" && each !== inForce ? null
  : el("span", { class: `badge ${{ proposed: "accent", accepted: "good", withdrawn: "warn" }[each.standing]}` },
    each.standing === "accepted" ? "in force" : each.standing));

const before = (entry) => (entry.inForce ? `Until now: ${factorWords(entry.inForce)}, accepted by ${entry.inForce.decided_by}.`
  : "Until now: the catalogue's k_c.");

/** Show the section; `told(count)` receives the number of open proposals. */
export async function factors(place, { review, told }) {
  let found = review ? await api(`/v1/reviews/${review}`) : null;
  const trouble = el("div", { id: "factors-problem" }), inside = el("div", {});
  const progress = el("span", { class: "soft small", id: "review-progress", role: "status" });
  const button = el("button", { class: "main", id: "review", onclick: look }, "Review");
  fill(place, el("div", { class: "row" }, button,
    el("span", { class: "soft small" }, "learns from all outcomes and proposes factors; nothing changes until a person accepts"), progress),
  trouble, inside);
  if (!found) {
    const last = (await api("/v1/jobs?kind=review&state=succeeded&limit=1")).items[0];
    if (last) found = await api(`/v1/reviews/${last.id}`).catch(() => null);
  }
  await refresh();

  async function look() {
    button.disabled = true;
    tell(trouble, null);
    try {
      const job = await done("/v1/reviews", {}, (now) => { progress.textContent = now.state; });
      found = await api(`/v1/reviews/${job.id}`);
      const fresh = found.contexts.filter(({ change }) => change === "proposed").length;
      await refresh();
      progress.textContent = fresh ? `new proposals: ${fresh}` : "nothing new since the last review";
      announce(`review: ${progress.textContent}`);
    } catch (error) {
      progress.textContent = "";
      tell(trouble, error);
    } finally {
      button.disabled = false;
    }
  }

  async function refresh() {
    const { corrections } = await api("/v1/corrections");
    const contexts = new Map();
    for (const each of corrections) {
      const entry = contexts.get(contextOf(each)) ?? { all: [] };
      entry.all.push(each);
      entry.latest = each;
      contexts.set(contextOf(each), entry);
    }
    const reviewed = new Map((found?.contexts ?? []).map((each) => [contextOf(each), each]));
    for (const [name, entry] of contexts) {
      const accepted = entry.all.filter(({ standing }) => standing === "accepted")
        .sort((one, other) => new Date(other.decided_at) - new Date(one.decided_at));
      [entry.inForce, entry.next] = accepted;
      entry.isOpen = entry.latest.standing === "proposed";
      const seen = reviewed.get(name);
      entry.objections = seen?.correction?.id === entry.latest.id ? seen.objections : [];
    }
    const list = [...contexts.values()].sort((one, other) => contextOf(one.latest).localeCompare(contextOf(other.latest)));
    told(list.filter(({ isOpen }) => isOpen).length);
    await draw(list, corrections);
  }

  async function draw(list, corrections) {
    const nothing = (found?.contexts ?? []).filter(({ correction }) => !correction);
    const left = nothing.length ? el("details", {}, el("summary", {}, `Contexts with nothing to learn from yet: ${nothing.length}`),
      el("ul", {}, nothing.map((each) => el("li", {}, `${contextWords(each)}: `,
        Object.entries(each.left_out).map(([why, count]) => `${count} × ${why}`).join(", ") || "no outcome with a force ratio")))) : null;
    if (!list.length) {
      fill(inside, el("p", { class: "empty", id: "no-factors" }, "No correction yet: “Review” compares measured with expected forces and proposes a factor for each machine, material and tool."), left);
      return;
    }
    const chart = el("div", { class: "chart", id: "factor-plot", role: "figure",
      "aria-label": "factor on k_c of each machine, material and tool, with the interval of 9 in 10 next runs; the table below lists the numbers" });
    fill(inside,
      el("ul", { class: "keys", "aria-label": "marks" },
        el("li", {}, el("span", { "aria-hidden": "true", style: "color: var(--curve-2)" }, "◇ "), "latest proposal"),
        el("li", {}, el("span", { "aria-hidden": "true", style: "color: var(--curve-1)" }, "● "), "in force"),
        el("li", {}, "bars: interval of 9 in 10 next runs; 1 is the catalogue's k_c")),
      chart, framed("factors on k_c", table(list)), left, history(corrections));
    await plot(chart, () => picture(list));
  }

  function table(list) {
    const head = [...HEAD, ""];
    return el("table", { id: "factor-table" }, el("caption", { class: "unseen" }, "Factors on k_c"),
      el("thead", {}, el("tr", {}, head.map((text, at) => el("th", { scope: "col", class: at === 2 ? "n" : "" }, text || el("span", { class: "unseen" }, "decide"))))),
      el("tbody", {}, list.map((entry) => line(entry))));
  }

  function line(entry) {
    const { latest, inForce, isOpen } = entry, name = contextWords(latest);
    const decide = [];
    if (latest.standing !== "accepted") decide.push(act("accept", "Accept", `accept for ${name}`, () => accept(entry)));
    if (isOpen) decide.push(act("refuse", "Reject", `reject for ${name}`, () => withdraw(entry, latest)));
    if (inForce) decide.push(act("withdraw", "Withdraw", `withdraw the factor in force for ${name}`, () => withdraw(entry, inForce)));
    return el("tr", { id: `factor-${latest.id}` },
      el("th", { scope: "row" }, latest.tool, el("div", { class: "soft small thin" }, `${latest.material} on ${latest.machine}`)),
      el("td", { class: "proposal", "data-label": HEAD[1] }, `× ${fixed(latest.factor, 2)} ± ${fixed(half(latest), 2)} `, standing(latest, inForce),
        el("div", { class: "soft small" }, `next run ${fixed(latest.factor_low, 2)} to ${fixed(latest.factor_high, 2)}; ${counted(latest.outcomes, "outcome")}`)),
      el("td", { class: "n", "data-label": HEAD[2] }, percent(latest.confidence)),
      el("td", { "data-label": HEAD[3] }, inForce ? [`× ${fixed(inForce.factor, 2)} ± ${fixed(half(inForce), 2)}`,
        el("div", { class: "soft small" }, `${inForce.decided_by}, ${moment(inForce.decided_at)}`)] : el("span", { class: "soft" }, "the catalogue's")),
      el("td", { class: "against", "data-label": HEAD[4] }, entry.objections.length && latest.standing !== "accepted"
        ? el("ul", { class: "plain warn small" }, entry.objections.map(({ message }) => el("li", {}, message))) : el("span", { class: "soft" }, "–")),
      el("td", { class: "jobs-acts" }, el("div", { class: "row end-row" }, decide)));
  }

  async function decided(title, texts, word, path, said) {
    const name = el("input", { id: "decide-by", required: true, maxlength: "100", autocomplete: "name", pattern: ".*\\S.*",
      value: localStorage.getItem(PERSON) ?? "" });
    if (!(await confirmed(title, texts, word, [el("label", {}, "Your name", name)]))) return;
    const by = name.value.trim();
    localStorage.setItem(PERSON, by);
    tell(trouble, null);
    try {
      await api(path, { method: "POST", json: { by } });
      await refresh();
      announce(said);
    } catch (error) {
      tell(trouble, error);
    }
  }

  function accept(entry) {
    const { latest } = entry;
    return decided("Accept a factor", [
      el("strong", {}, `${factorWords(latest)} for ${contextWords(latest)}: the next plan uses it.`),
      `Learned from ${counted(latest.outcomes, "outcome")}; the next run lies between ${fixed(latest.factor_low, 2)} and ${fixed(latest.factor_high, 2)} in 9 of 10 cases. Plans use the upper end, so that one run in ten needs more force than planned.`,
      before(entry),
      ...entry.objections.map(({ message }) => el("span", { class: "warn" }, `Objection: ${message}`)),
    ], "Accept", `/v1/corrections/${latest.id}/accept`, `${factorWords(latest)} for ${contextWords(latest)} is in force`);
  }

  function withdraw(entry, which) {
    const isInForce = which === entry.inForce;
    const after = entry.next ? `Then ${factorWords(entry.next)}, accepted earlier by ${entry.next.decided_by}, is in force again.`
      : "Then the next plans use the catalogue's k_c.";
    return decided(isInForce ? "Withdraw a factor" : "Reject a proposal", [
      el("strong", {}, `${factorWords(which)} for ${contextWords(which)}${isInForce ? " will no longer be used." : " will no longer be proposed."}`),
      isInForce ? after : before(entry),
    ], isInForce ? "Withdraw" : "Reject", `/v1/corrections/${which.id}/withdraw`, `${factorWords(which)} for ${contextWords(which)} is withdrawn`);
  }
}

/** Plot the factors with their intervals, a line for each context. */
function picture(list) {
  const places = list.map((_, at) => list.length - 1 - at);
  const isOne = new Set(list.map(({ latest }) => latest.machine + latest.material)).size === 1;
  const marks = (entries, shift, more) => ({ type: "scatter", mode: "markers", ...more,
    x: entries.map(([each]) => each.factor), y: entries.map(([, at]) => at + shift),
    error_x: { type: "data", symmetric: false, array: entries.map(([each]) => each.factor_high - each.factor),
      arrayminus: entries.map(([each]) => each.factor - each.factor_low), thickness: 2, width: 5, color: more.marker.color },
    text: entries.map(([each]) => `${contextWords(each)}<br>× ${fixed(each.factor, 2)}, ${fixed(each.factor_low, 2)} to ${fixed(each.factor_high, 2)}`),
    hovertemplate: "%{text}<extra></extra>" });
  const open = list.map(({ latest }, at) => [latest, places[at]]).filter(([{ standing }]) => standing === "proposed");
  const inForce = list.map((entry, at) => [entry.inForce, places[at]]).filter(([each]) => each);
  return {
    data: [marks(open, 0.14, { name: "proposed", marker: { color: colour("curve-2"), symbol: "diamond-open", size: 10, line: { width: 2 } } }),
      marks(inForce, -0.14, { name: "in force", marker: { color: colour("curve-1"), symbol: "circle", size: 9 } })],
    layout: layout({ height: 90 + 34 * list.length, hovermode: "closest",
      shapes: [{ type: "line", x0: 1, x1: 1, yref: "paper", y0: 0, y1: 1, line: { color: colour("soft"), width: 1.2, dash: "dash" } }],
      xaxis: { title: { text: "factor on k_c", standoff: 6 } },
      yaxis: { tickvals: places, ticktext: list.map(({ latest }) => (isOne ? latest.tool : `${latest.tool}<br>${latest.material}, ${latest.machine}`)),
        range: [-0.6, list.length - 0.4], tickfont: { size: 11 }, zeroline: false } }),
  };
}

function history(corrections) {
  return el("details", { id: "history" }, el("summary", {}, `All corrections: ${corrections.length}`),
    framed("all corrections", el("table", {}, el("caption", { class: "unseen" }, "All corrections, newest first"),
      el("thead", {}, el("tr", {}, ["No.", "Context", "Factor", "Proposed", "Status", "By", "Decided"].map((text) => el("th", { scope: "col" }, text)))),
      el("tbody", {}, [...corrections].reverse().map((each) => el("tr", {}, el("th", { scope: "row" }, String(each.id)),
        el("td", {}, contextWords(each)), el("td", { class: "nowrap" }, `× ${fixed(each.factor, 2)} ± ${fixed(half(each), 2)}`),
        el("td", {}, moment(each.proposed_at)), el("td", {}, each.standing), el("td", {}, each.decided_by || "–"),
        el("td", {}, moment(each.decided_at))))))));
}
