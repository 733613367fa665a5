// Table of a measured run beside its prediction, workingstep by workingstep.

import { el, fill, fixed } from "/dashboard/app.js";
import { framed } from "/dashboard/records.js";

const kilo = (value) => (value === null ? null : value / 1000);

/** Show a comparison. `run` is the measured run; null: the machine has not run a program yet. */
export function comparisonTable(place, found, run) {
  const isOther = found.measured_program && found.measured_program !== found.program;
  fill(place, el("section", { class: "card", "aria-labelledby": "comparison-title" },
    el("h2", { id: "comparison-title" }, "Time and energy by workingstep"),
    isOther ? el("p", { class: "warn", id: "other-program" },
      `The machine runs ${found.measured_program}; the prediction is of ${found.program}.`) : null,
    found.parts.length ? null : el("p", { class: "soft", id: "not-aligned" }, run
      ? "The beginning of this program was not observed: the predicted curves follow with the next workingstep."
      : "The predicted curves follow when the machine begins a program."),
    framed("time and energy by workingstep", table(found))));
}

function table(found) {
  const head = ["Workingstep", "State", "Time measured s", "predicted s", "ratio", "Energy measured kJ", "predicted kJ", "ratio"];
  return el("table", { id: "comparison-table", "aria-labelledby": "comparison-title" },
    el("caption", {}, "Measured so far; the ratio is measured over predicted, once a workingstep is done."),
    el("thead", {}, el("tr", {}, head.map((text, at) =>
      el("th", { scope: "col", class: at > 1 ? "n" : "" }, text)))),
    el("tbody", {}, found.workingsteps.map((step) => el("tr", {},
      el("th", { scope: "row", class: "nowrap" }, step.id || "outside workingsteps"),
      el("td", { class: step.state === "running" ? "good" : "soft" }, step.state), cells(step)))),
    el("tfoot", {}, el("tr", {}, el("th", { scope: "row" }, "done and predicted"), el("td", {}), cells(found.done))));
}

const cells = (step) => [
  fixed(step.measured_time_s, 1), fixed(step.predicted_time_s, 1), fixed(step.time_ratio, 3),
  fixed(kilo(step.measured_energy_j), 1), fixed(kilo(step.predicted_energy_j), 1), fixed(step.energy_ratio, 3),
].map((text) => el("td", { class: "n" }, text));
