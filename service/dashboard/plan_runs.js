// Simulations of the program before and after optimisation: reused or started, then shown.

import { AWAY_WORDS, Problem, announce, api, byId, el, fill, patiently, save, show, tell } from "/dashboard/app.js";
import { showLoad } from "/dashboard/plan_load.js";
import { showPath } from "/dashboard/plan_path.js";
import { showSimulated } from "/dashboard/plan_result.js";

const NAMES = { before: "as programmed", after: "as advised" };
/** Options of simulations started by this page; runs with other options are not reused. */
const PLAIN = { control: "fir", noise: "none", has_lag: false, has_wear: false, has_power_deviation: false, kc_factor: 1,
  pace: 0 };

let turn = 0;

/** Hide everything that belongs to the previous advice. */
export function endRuns() {
  turn += 1;
  for (const id of ["runs", "path-card", "load-card"]) byId(id).hidden = true;
}

/** Offer both simulations of an advice, or start them. */
export function beginRuns(job, result, { rate, isWanted }) {
  endRuns();
  const card = byId("runs"), button = byId("simulate");
  card.hidden = false;
  fill(byId("runs-work"));
  tell(byId("runs-problem"), null);
  button.onclick = () => {
    button.hidden = true;
    simulate(job, result, rate, turn);
  };
  button.hidden = isWanted;
  if (isWanted) simulate(job, result, rate, turn);
}

async function simulate(job, result, rate, mine) {
  const problem = byId("runs-problem"), button = byId("simulate"), asked = new Map();
  tell(problem, null);
  const cancel = el("button", { type: "button", id: "cancel-simulations", onclick: () => {
    cancel.disabled = true;
    for (const run of asked.values()) api(`/v1/jobs/${run.id}/cancel`, { method: "POST" }).catch(() => {});
  } }, "Cancel");
  const away = el("span", { class: "soft small", role: "status" });
  const wanted = Object.keys(NAMES).filter((which) => which === "before" || result.is_written);
  const lines = Object.fromEntries(wanted.map((which) => {
    const bar = el("progress", { max: 1, value: 0, "aria-label": NAMES[which] });
    const words = el("span", { class: "soft small nowrap" }, NAMES[which]);
    return [which, { bar, words, line: el("div", { class: "row" }, words, bar) }];
  }));
  fill(byId("runs-work"), wanted.map((which) => el("div", { class: "work" }, lines[which].line)),
    el("div", { class: "row work" }, cancel, away));

  const earlier = await api("/v1/simulations?limit=200").then((page) => page.items).catch(() => []);
  const one = async (which) => {
    const body = { machine: job.request.machine || result.machine, material: job.request.material || result.material,
      units: job.request.units, rate_hz: rate,
      ...(which === "after" ? { advice_id: job.id } : { program_id: job.program_id }) };
    const run = earlier.find((each) => isSame(each, body, job))
      ?? await api("/v1/simulations", { method: "POST", json: body });
    asked.set(which, run);
    const ask = (path) => patiently(path, { lost: () => { away.textContent = AWAY_WORDS; },
      back: () => { away.textContent = ""; } });
    await ended(run, ask, (news) => { lines[which].bar.value = news.state === "succeeded" ? 1 : news.share; });
    const [summary, path] = await Promise.all([ask(`/v1/simulations/${run.id}`), ask(`/v1/simulations/${run.id}/path`)]);
    return { id: run.id, summary, path };
  };
  const ends = await Promise.allSettled(wanted.map(one));
  if (mine !== turn) return;
  const runs = {};
  ends.forEach((end, at) => { if (end.status === "fulfilled") runs[wanted[at]] = end.value; });
  fill(byId("runs-work"));
  const failed = ends.find((end) => end.status === "rejected");
  if (failed) tell(problem, failed.reason);
  button.hidden = !failed;
  byId("runs").hidden = !failed;
  if (!Object.keys(runs).length) return;
  announce("simulated: tool path and load are shown");
  showSimulated(runs.before?.summary, runs.after?.summary);
  files(runs);
  try {
    await showPath(runs, result);
    await showLoad(runs);
  } catch (error) { tell(problem, error); byId("runs").hidden = false; }
}

/** Wait for the end of a job by polling, because its stream would send rows that are not needed. */
async function ended(run, ask, heard) {
  let job = run;
  while (["queued", "running"].includes(job.state)) {
    await new Promise((again) => setTimeout(again, 400));
    job = await ask(`/v1/jobs/${run.id}`);
    heard(job);
  }
  heard(job);
  if (job.state !== "succeeded") throw new Problem(job.problem ?? { detail: `The simulation was ${job.state}.` }, 0);
}

/** Whether an existing or queued simulation matches the wanted one. */
function isSame(run, body, job) {
  if (!["queued", "running", "succeeded"].includes(run.state) || run.is_cancelling) return false;
  if ((run.advice_id ?? null) !== (body.advice_id ?? null) || run.program_id !== job.program_id) return false;
  const plain = Object.entries(PLAIN).every(([name, value]) => run.request[name] === value);
  return plain && ["machine", "material", "units", "rate_hz"].every((name) => run.request[name] === body[name]);
}

function files(runs) {
  fill(byId("load-downloads"), Object.entries(runs).flatMap(([which, run]) => [
    el("button", { type: "button", id: `samples-${which}`, onclick: () => save(`/v1/simulations/${run.id}/samples`) },
      `Samples ${NAMES[which]} (Parquet)`),
    el("button", { type: "button", id: `simulation-report-${which}`, onclick: () => show(`/v1/simulations/${run.id}/report`) },
      `Report ${NAMES[which]}`),
  ]));
}
