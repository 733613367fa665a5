// Results of a simulated run: totals, workingsteps, peaks, energy by component, files.

import { api, duration, el, fill, figure, fixed, number, percent, save, show } from "/dashboard/app.js";
import { framed } from "/dashboard/records.js";
import { COMPONENTS } from "/dashboard/machine_words.js";

/** Read the result of a job and show it; `goTo(time)` shows the state at a time. */
export async function results(place, job, goTo) {
  const path = `/v1/simulations/${job.id}`, found = await api(path);
  const { total } = found;
  const cutting = total.time_s ? total.cutting_time_s / total.time_s : null;
  fill(place, el("div", { class: "columns" },
    el("section", { class: "card", style: "grid-column: span 7", "aria-labelledby": "totals-title" },
      el("div", { class: "row spread" }, el("h2", { id: "totals-title" }, "Results"),
        el("div", { class: "row no-print" },
          el("a", { class: "button", id: "verify-run", href: `/dashboard/verify.html?run=${job.id}` }, "Verify positions"),
          el("button", { id: "get-samples", onclick: () => save(`${path}/samples`) }, "Samples (Parquet)"),
          el("button", { id: "get-report", onclick: () => show(`${path}/report`) }, "Report"))),
      el("div", { class: "figures", id: "totals" },
        figure("Time", duration(total.time_s)), figure("Cutting", percent(cutting), "of the time"),
        figure("Energy", number(total.energy_j.total / 1000, 4), "kJ"),
        figure("Removed", number(total.volume_mm3 / 1000, 3), "cm³"),
        figure("Peak spindle power (mains)", fixed(total.peak_spindle_power.value_w / 1000, 2), "kW"),
        figure("Peak cutting force", number(total.peak_cutting_force.value_n, 3), "N"),
        figure("CO₂ equivalent", number(found.carbon.total_g, 3), "g")),
      total.overload_time_s > 0 ? el("div", { class: "banner warn", id: "overload" },
        `${duration(total.overload_time_s)} above the continuous power of the spindle drive, or above the permitted force.`) : null,
      found.findings.length ? el("details", {}, el("summary", {}, `Findings of the run: ${found.findings.length}`),
        el("ul", {}, found.findings.map((each) => el("li", { class: each.severity === "error" ? "bad" : "" }, each.message)))) : null),
    el("section", { class: "card", style: "grid-column: span 5" }, el("h2", { id: "energy-title" }, "Energy by component"),
      framed("energy by component", energy(total.energy_j)),
      el("p", { class: "soft small" }, `CO₂ by ${number(found.carbon.factor_g_kwh, 3)} g/kWh: ${found.carbon.source}`)),
    el("section", { class: "card", style: "grid-column: 1 / -1" }, el("h2", { id: "steps-title" }, "Workingsteps"),
      framed("workingsteps of the run", steps(found.workingsteps, goTo)))));
  return found;
}

function steps(rows, goTo) {
  const head = ["Workingstep", "Time s", "Cutting s", "Air s", "Rapid s", "Waiting s", "Energy kJ",
    "Spindle kW", "Force N", "Removed cm³"];
  return el("table", { id: "steps", "aria-labelledby": "steps-title" },
    el("caption", {}, "Peak spindle power (mains) and force; click a name to show the state at the start of the workingstep."),
    el("thead", {}, el("tr", {}, head.map((text, at) => el("th", { scope: "col", class: at ? "n" : "" }, text)))),
    el("tbody", {}, rows.map((row) => el("tr", {},
      el("th", { scope: "row", class: "nowrap" }, el("button", { class: "link", onclick: () => goTo(row.begin_s),
        title: `begins at ${duration(row.begin_s)}` }, row.id ?? "outside workingsteps")),
      [fixed(row.time_s, 1), fixed(row.cutting_time_s, 1), fixed(row.air_time_s, 1), fixed(row.rapid_time_s, 1),
        fixed(row.waiting_time_s, 1), fixed(row.energy_j.total / 1000, 1), fixed(row.peak_spindle_power.value_w / 1000, 2),
        fixed(row.peak_cutting_force.value_n, 0), fixed(row.volume_mm3 / 1000, 2),
      ].map((text, at) => el("td", { class: `n ${at === 6 && row.overload_time_s > 0 ? "warn" : ""}` }, text))))));
}

function energy(joules) {
  const parts = COMPONENTS.map(({ energy: name, label, colour }) => ({ label, colour, value: joules[name] }))
    .sort((one, other) => other.value - one.value);
  const most = Math.max(...parts.map(({ value }) => value), 1e-9);
  return el("table", { id: "energy", "aria-labelledby": "energy-title" },
    el("thead", {}, el("tr", {}, ["Component", "kJ", "Share"].map((text, at) =>
      el("th", { scope: "col", class: at === 1 ? "n" : "" }, text)))),
    el("tbody", {}, parts.map(({ label, colour, value }) => el("tr", {},
      el("th", { scope: "row", class: "nowrap" }, label), el("td", { class: "n" }, number(value / 1000, 3)),
      el("td", {}, el("div", { class: "share" },
        el("i", { style: `width: ${(100 * value) / most}%; background: var(--${colour})` }),
        el("span", { class: "n" }, percent(joules.total ? value / joules.total : null, 1))))))),
    el("tfoot", {}, el("tr", {}, el("th", { scope: "row" }, "total"),
      el("td", { class: "n" }, number(joules.total / 1000, 4)), el("td", {}, ""))));
}
