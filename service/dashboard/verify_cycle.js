// The cycle time of a program: as programmed, by the block rate, predicted, and as logged.

import { byId, el, figure, fill, fixed, number, show, tell } from "/dashboard/app.js";
import { findingsList } from "/dashboard/plan_program.js";

const HEAD = ["Workingstep", "Tool", "Blocks", "Length over feed s", "By block rate s", "Predicted s", "Logged s", "Predicted off"];
const LOST = ["Workingstep", "Blocks", "Spacing mm", "Feed mm/min", "Reached mm/min", "Lost s", "Held by"];
let job = null;

/** Show a cycle time. */
export function showCycle(asked, found) {
  job = asked;
  const { total } = found;
  byId("cycle-card").hidden = false;
  byId("cycle-of").textContent = [found.program, found.log, found.machine, found.block_time_ms === null
    ? "block time unknown" : `${number(found.block_time_ms)} ms a block`, `control ${found.control}`].filter(Boolean).join(" · ");
  fill(byId("cycle-figures"), figure("Length over feed", fixed(total.theoretical_s, 1), "s"),
    figure("Predicted", fixed(total.predicted_s, 1), "s"),
    total.actual_s === null ? null : figure("Logged", fixed(total.actual_s, 1), "s"),
    total.actual_s === null ? null : figure("Predicted off", off(total), ""));
  fill(byId("cycle-hints"), found.hints.map((text) => el("div", { class: "banner warn" }, text)),
    findingsList(found.findings, "of the cycle time"));
  byId("cycle-rows").replaceChildren(head(HEAD, 1), el("tbody", {}, found.rows.map(line)), el("tfoot", {}, line(total)));
  byId("cycle-more").hidden = !found.stretches.length;
  byId("cycle-stretches").replaceChildren(head(LOST, 1, LOST.length - 1), el("tbody", {}, found.stretches.map((each) => el("tr", {},
    el("th", { scope: "row" }, each.workingstep || "–"),
    [each.first_block === each.last_block ? `${each.first_block}` : `${each.first_block}–${each.last_block}`,
      number(each.spacing_mm), fixed(each.feed_mm_min, 0), fixed(each.reached_mm_min, 0), fixed(each.lost_s, 2)]
      .map((text) => el("td", { class: "n" }, text)), el("td", {}, each.cause)))));
}

const head = (names, from, to = names.length) => el("thead", {}, el("tr", {}, names.map((text, at) =>
  el("th", { scope: "col", class: at >= from && at < to ? "n" : "" }, text))));

const line = (row) => el("tr", {}, el("th", { scope: "row" }, row.workingstep || "outside workingsteps"),
  [row.tool === null ? "–" : `T${row.tool}`, row.blocks.toLocaleString("en-GB"), fixed(row.theoretical_s, 2), fixed(row.block_rate_s, 2),
    fixed(row.predicted_s, 2), fixed(row.actual_s, 2), off(row)].map((text) => el("td", { class: "n" }, text)));

function off(row) {
  if (!row.actual_s) return "–";
  const share = 100 * (row.predicted_s / row.actual_s - 1), told = fixed(Math.abs(share), 2);
  return told === "0.00" ? "0.00 %" : `${share < 0 ? "−" : "+"}${told} %`;
}

byId("cycle-report").addEventListener("click", () => {
  tell(byId("cycle-problem"), null);
  show(`/v1/cycle-times/${job.id}/report`).catch((error) => tell(byId("cycle-problem"), error));
});
