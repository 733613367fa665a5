// Comparison of a plan with its simulated run: predicted and found values, exceeded bounds.

import { byId, el, fill, fixed, number } from "/dashboard/app.js";

const FIGURES = [
  ["time_s", "Time, s"], ["cutting_force_n", "Force, N"], ["thrust_n", "Thrust, N"],
  ["deflection_um", "Deflection, µm"], ["cutting_power_w", "Cutting, W"], ["drive_power_w", "Drive, W"],
];
const PASSED = 1.01;  // ratio to the bound, as in service/simulation/confirmation.py

/** Show the comparison; hide it if it was not requested. */
export function showConfirmation(confirmation) {
  byId("confirmed").hidden = !confirmation;
  if (!confirmation) return;
  fill(byId("confirmed-passed"), confirmation.passed.map((text) =>
    el("div", { class: "banner bad", role: "alert" }, `Bound exceeded: ${text}`)));
  fill(byId("confirmed-figures"), el("caption", { class: "unseen" }, "Predicted and found"),
    el("thead", {}, el("tr", {}, ["Workingstep", ...FIGURES.map(([, title]) => title)].map((title, at) =>
      el("th", { scope: "col", class: at ? "n" : undefined }, title)))),
    el("tbody", {}, confirmation.workingsteps.map((step) => el("tr", {},
      el("th", { scope: "row" }, step.id), FIGURES.map(([key]) => figure(step[key]))))));
}

/** Create a cell with predicted value, found value and their ratio. */
function figure({ promised, found, ratio, bound }) {
  if (ratio === null && !found) return el("td", { class: "n" }, "–");
  const isPassed = bound !== null && found > PASSED * bound;
  return el("td", { class: `n ${isPassed ? "bad" : ""}` },
    el("span", { class: "change" }, el("span", { class: "was" }, number(promised, 4)),
      el("span", { class: "arrow", "aria-label": "becomes" }, "→"), el("b", {}, number(found, 4))),
    el("div", { class: "soft small" }, ratio === null ? "" : fixed(ratio, 3),
      isPassed ? ` exceeds ${number(bound, 4)}` : ""));
}
