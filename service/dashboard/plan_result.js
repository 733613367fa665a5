// An advice: its figures, downloads, times as bars; the table is in plan_table.js.

import { api, byId, counted, duration, el, fill, fixed, number, save, show, tell } from "/dashboard/app.js";
import { showAlong } from "/dashboard/plan_along.js";
import { findingsList } from "/dashboard/plan_program.js";
import { showConfirmation } from "/dashboard/plan_confirm.js";
import { stepsCsv, stepsTable } from "/dashboard/plan_table.js";

const MODES = { TC: "least time", QC: "roughness kept", EC: "least energy", CC: "least cost" };
const CONTROL = "stepnc.control";
let job = null, result = null;

/** Create a figure `before → after`. */
function pair(name, before, after, unit, kind = "") {
  return el("div", { class: `figure ${kind}` }, el("div", { class: "name" }, name),
    el("div", {}, el("span", { class: "was" }, before), el("span", { class: "was arrow", "aria-label": "becomes" }, "→"),
      el("span", { class: "value" }, after), unit ? el("span", { class: "unit" }, unit) : null));
}

/** Create a figure of two times in the same unit. */
function times(name, before, after, kind = "") {
  const longer = Math.max(before, after);
  return pair(name, duration(before, longer), duration(after, longer), "", kind);
}

/** Create a figure of a saving or an increase; one in which anything stays open (`isPart`) is never green. */
function saving(name, before, after, isPart) {
  const share = before ? (before - after) / before : null;
  const [word, colour] = share === null || Math.abs(share) < 5e-4 ? ["no change", "soft"]
    : share > 0 ? ["saved", isPart ? "soft" : "good"] : ["more", "warn"];
  return el("div", { class: "figure big" }, el("div", { class: "name" }, name),
    el("div", {}, el("span", { class: `value ${colour}`, id: "time-saved" }, share === null ? "–" : `${fixed(100 * Math.abs(share), 1)} %`),
      el("span", { class: "unit" }, word)));
}

const isSlower = (time) => Boolean(time) && time.after > time.before;

/** Whether an advice is on NC code. */
export const isOnCode = (found) => "control" in found;

/** Return the time before and after of an advice, in s. */
export const timesOf = (found) => (isOnCode(found) ? found.along_path.time_s : found.total_time_s);

/** Show an advice. */
export function showResult(asked, found) {
  job = asked;
  result = found;
  const isCode = isOnCode(found);
  for (const card of document.querySelectorAll(".of-advised")) card.hidden = isCode;
  for (const name of ["download-program", "download-csv"]) byId(name).hidden = isCode;
  byId("download-feeds").hidden = !found.along_path;
  byId("compare-link").hidden = isCode;
  byId("compare-link").href = `/dashboard/compare.html?program=${job.program_id}&advice=${job.id}`;
  showControls(found, isCode);
  showAlong(job, found.along_path);
  if (isCode) showCode(found); else showSteps(found);
}

/** Offer the control that NC code is written for; one that was simulated to the end is kept. */
function showControls(found, isCode) {
  const place = byId("download-control"), isFixed = isCode || Boolean(found.along_path);
  const mine = found.nc_control ?? localStorage.getItem(CONTROL) ?? place.options[0].value;
  place.hidden = isFixed;
  if ([...place.options].some((option) => option.value === mine)) place.value = mine;
  byId("download-nc").disabled = isFixed && !found.nc_control;
  byId("download-nc").title = byId("download-nc").disabled
    ? "feeds along the paths are written for the control chosen before optimising" : "";
  byId("download-nc").textContent = isFixed && found.nc_control ? `NC code, ${found.nc_control}` : "NC code";
}

/** Show the advice on NC code. */
function showCode(found) {
  const { before, after } = found.along_path.time_s, { changed, added, restored, unchanged } = found.blocks;
  byId("result-of").textContent = [found.program, found.machine, found.material, `stock in ${found.frame}`].join(" · ");
  const slower = found.slower_than_programmed ?? [], deep = found.depth_risks ?? [];
  fill(byId("figures"), times("Machining time, simulated", before, after, "big"),
    saving("Time", before, after, found.is_checked === false || slower.length > 0 || deep.length > 0));
  fill(byId("result-findings"), slower.map((text) => el("div", { class: "banner warn", role: "alert" }, text)),
    deep.length ? el("div", { class: "banner warn", role: "alert" },
      `Not fully checked: too deep in ${deep.map((each) => each.id).join(", ")}. The findings name depth and bound.`) : null,
    el("p", { class: "soft small" },
      `${counted(changed, "block")} changed, ${added} added by splitting, ${restored} got the programmed feed back, ${unchanged.length} not as advised.`),
    findingsList(found.findings, "of the plan"));
  showConfirmation(null);
}

/** Show the advice on the workingsteps of a STEP-NC program. */
function showSteps(found) {
  const { before, after } = found.total_time_s, steps = found.workingsteps;
  const count = (status) => steps.filter((step) => step.status === status).length;
  byId("result-of").textContent = [found.program, found.machine, found.material,
    `${found.mode}, ${MODES[found.mode]}`].join(" · ");
  const infeasible = count("infeasible");
  const unchecked = steps.reduce((sum, step) => sum + (step.status === "advised" ? step.unchecked?.length ?? 0 : 0), 0);
  const unlikely = found.unlikely_surfaces ?? [];
  fill(byId("figures"), times("Machining time", before, after, "big"),
    saving(infeasible ? "Time, where feasible" : "Time", before, after, infeasible > 0 || unchecked > 0 || unlikely.length > 0
      || found.confirmation?.passed.length > 0 || isSlower(found.along_path?.time_s)),
    el("div", { class: "figure" }, el("div", { class: "name" }, "Workingsteps advised"),
      el("div", {}, el("span", { class: "value" }, `${count("advised")} of ${steps.length}`),
        count("untouched") ? el("span", { class: "unit" }, `${count("untouched")} untouched`) : null)),
    infeasible ? el("div", { class: "figure" }, el("div", { class: "name" }, "Infeasible"),
      el("div", {}, el("span", { class: "value bad" }, String(infeasible)))) : null,
    el("div", { class: "figures", id: "figures-simulated" }));
  fill(byId("result-findings"), el("p", { class: "soft small" },
    "As planned: without tool changes and moves between workingsteps. " + (found.safety.cost_s
      ? `Bounds are kept at the ${number(100 * found.safety.quantile, 4)} % quantile of k_c, which costs ${number(found.safety.cost_s, 3)} s.`
      : "")),
  infeasible ? el("div", { class: "banner bad", role: "alert" },
    `${infeasible} workingstep${infeasible > 1 ? "s have" : " has"} no feasible feed: the table says why. They stay as programmed, also in the NC code; times compare the others.`) : null,
  unchecked ? el("div", { class: "banner warn", role: "alert" },
    `Not fully checked: ${unchecked} required limit${unchecked > 1 ? "s" : ""} could not be looked at. The reasons name what to give.`) : null,
  unlikely.length ? el("div", { class: "banner warn", role: "alert" },
    `Roughness is not promised in ${unlikely.join(", ")}: it is kept with less than 90 % probability. Measure own surfaces, or plan with a greater roughness quantile.`) : null,
  found.is_written ? null : el("div", { class: "banner warn" }, "No optimised program was written, because nothing would change."),
  findingsList(found.findings, "of the plan"));
  byId("download-program").disabled = !found.is_written;
  stepsTable(byId("steps"), steps);
  showConfirmation(found.confirmation);
  bars(steps);
}

/** Add the figures from the simulations: time with all moves, energy. */
export function showSimulated(before, after) {
  const place = byId("figures-simulated");
  if (!before || !after || !place) return;
  // With all moves the plan may be slower than its workingsteps alone.
  if (isSlower({ before: before.total.time_s, after: after.total.time_s })) byId("time-saved")?.classList.replace("good", "warn");
  const kj = (run) => number(run.total.energy_j.total / 1000, 4);
  fill(place, pair("Energy, simulated", kj(before), kj(after), "kJ"),
    times("Time, simulated with all moves", before.total.time_s, after.total.time_s));
}

/** Draw the time of each workingstep as bars. */
function bars(steps) {
  const known = steps.filter((step) => step.time_s.before || step.time_s.after);
  const most = Math.max(...known.flatMap((step) => [step.time_s.before ?? 0, step.time_s.after ?? 0]), 1e-9);
  const bar = (kind, value) => el("div", { class: kind, style: `width:${(100 * (value ?? 0) / most).toFixed(2)}%` });
  fill(byId("times"), known.length ? el("div", { class: "times" }, known.map((step) => {
    const { before } = step.time_s, after = step.time_s.after ?? before;
    return el("div", { class: "time" }, el("span", { class: "name", title: step.id }, step.id),
      el("div", { class: "pair-bars", "aria-hidden": "true" }, bar("was", before), bar("is", after)),
      el("span", { class: "told" }, `${fixed(before, 1)} → ${fixed(after, 1)}`));
  })) : el("p", { class: "empty" }, "No times available."));
}

// -- downloads --------------------------------------------------------------------------------

const stem = () => result.program.replace(/\.[^.]+$/, "");

function keep(text, name, type) {
  const link = el("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const DOWNLOADS = {
  "download-program": () => save(`/v1/advice/${job.id}/file`),
  "download-nc": () => {
    const place = byId("download-control");
    if (!place.hidden) localStorage.setItem(CONTROL, place.value);
    return save(`/v1/advice/${job.id}/nc${place.hidden ? "" : `?control=${place.value}`}`);
  },
  "open-report": () => show(`/v1/advice/${job.id}/report`),
  "download-json": async () => keep(JSON.stringify(await api(`/v1/advice/${job.id}`), null, 2),
    `${stem()}.advice.json`, "application/json"),
  "download-feeds": () => save(`/v1/advice/${job.id}/feeds`),
  "download-csv": () => keep(stepsCsv(result.workingsteps), `${stem()}.advice.csv`, "text/csv"),
};
for (const [id, action] of Object.entries(DOWNLOADS))
  byId(id).addEventListener("click", async () => {
    tell(byId("download-problem"), null);
    try { await action(); } catch (error) { tell(byId("download-problem"), error); }
  });

