// The page of verifications: positions, program and options; progress; the result.

import { AWAY_WORDS, announce, api, byId, el, fill, followed, patiently, tell } from "/dashboard/app.js";
import { programChoice } from "/dashboard/plan_program.js";
import { showCycle } from "/dashboard/verify_cycle.js";
import { FileField, TOOL_FILES } from "/dashboard/verify_files.js";
import { logChoice } from "/dashboard/verify_log.js";
import { showResult } from "/dashboard/verify_result.js";

const form = byId("verify-form"), button = byId("verify"), problem = byId("verify-problem");
let program = null, working = false, tools = null, required = null;

const log = logChoice(ready);
const choice = programChoice((chosen, contents) => { program = chosen && contents.is_usable ? chosen : null; ready(); });
tools = new FileField(byId("tools-place"), { id: "tools-file", kind: "tools", accept: TOOL_FILES,
  title: "Measured tools", hint: "tool table: TOML, CSV or of CAM", changed: ready });
required = new FileField(byId("required-place"), { id: "required-file", kind: "required-part", accept: ".stl,.step,.stp",
  title: "Required part", hint: ".stl in mm, or .step; else the features", changed: ready });
for (const name of ["stock", "machine"]) byId(name).addEventListener("input", ready);

byId("units").addEventListener("change", () => choice.again(program?.id));
byId("zero-how").addEventListener("change", showZero);

function showZero() {
  byId("zero-place").hidden = byId("zero-how").value !== "given";
}

function ready() {
  const isOfRun = log?.hasProgram ?? false, fields = log?.fields ?? null;
  byId("program-choice").hidden = isOfRun;
  byId("program-of-run").hidden = !isOfRun;
  const missing = working ? "" : !fields ? "Choose positions first." : !isOfRun && !program && !isEnough() ? "Choose a program first." : "";
  button.disabled = working || Boolean(missing);
  // A program is enough for its cycle time.
  byId("cycle").disabled = working || !(program || (isOfRun && fields));
  byId("verify-hint").textContent = missing;
}

/** Whether the options tell enough without a program. */
function isEnough() {
  return Boolean(byId("machine").value && byId("stock").value.trim() && tools?.id && required?.id);
}

async function library(path, select) {
  const entries = await api(path);
  select.append(...entries.map((each) => el("option", { value: each.name },
    each.title === each.name ? each.name : `${each.name}: ${each.title}`)));
}

function wish() {
  const how = byId("zero-how").value, cell = byId("cell");
  return { ...log.fields, ...(log.hasProgram ? {} : { program_id: program?.id ?? null }),
    machine: byId("machine").value, material: byId("material").value, units: byId("units").value, stock: byId("stock").value.trim(),
    tolerance_mm: byId("tolerance").valueAsNumber, zero: how === "given" ? byId("zero").value.trim() : how,
    cell_mm: cell.value === "" ? null : cell.valueAsNumber, has_deflection: byId("deflection").checked,
    tools_id: tools.id, required_id: required.id, required_solid: byId("required-solid").value.trim() };
}

/** Fill the form from the request of a job. */
async function recall({ request, program_id: id }) {
  for (const name of ["machine", "material", "units"]) byId(name).value = request[name];
  byId("tolerance").value = request.tolerance_mm;
  byId("cell").value = request.cell_mm ?? "";
  byId("stock").value = request.stock ?? "";
  byId("required-solid").value = request.required_solid ?? "";
  byId("zero-how").value = ["", "fit"].includes(request.zero) ? request.zero : "given";
  byId("zero").value = byId("zero-how").value === "given" ? request.zero : "";
  byId("deflection").checked = request.has_deflection;
  showZero();
  await Promise.all([log.recall(request), tools.use(request.tools_id), required.use(request.required_id),
    id && !request.run_id ? choice.use(id) : null]);
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  if (!button.disabled) ask("/v1/verifications", wish(), "id", "result", showVerification);
});

byId("cycle").addEventListener("click", () => {
  const { program_id: id = null, machine, units } = wish();
  ask("/v1/cycle-times", { ...log.fields, program_id: id, machine, units }, "cycle", "cycle-card", showCycleTime);
});

/** Queue a job, wait for its end and show its result in a part of the page. */
async function ask(path, json, name, part, shown) {
  tell(problem, null);
  byId(part).hidden = true;
  try {
    const asked = await api(path, { method: "POST", json,
      headers: { "idempotency-key": crypto.randomUUID?.() ?? String(Math.random()) } });
    history.replaceState(null, "", `?${name}=${asked.id}`);
    await follow(asked, part, shown);
  } catch (error) {
    const isCancelled = error.message === "the job is cancelled";
    if (isCancelled) fill(problem, el("p", { class: "soft" }, "Cancelled."));
    else tell(problem, error);
    announce(isCancelled ? "cancelled" : error.message);
  }
}

async function showVerification(job, line) {
  const [result, map] = await Promise.all([patiently(`/v1/verifications/${job.id}`, line),
    patiently(`/v1/verifications/${job.id}/map`, line)]);
  byId("result").hidden = false;
  await showResult(job, result, map);
  announce(result.verdict);
}

async function showCycleTime(job, line) {
  const result = await patiently(`/v1/cycle-times/${job.id}`, line);
  showCycle(job, result);
  announce(`cycle time ${result.total.predicted_s.toFixed(1)} s predicted`);
}

/** Wait for the end of a job, and show its result. */
async function follow(asked, part, shown) {
  const place = byId("verify-work"), bar = el("progress", { max: 1, "aria-label": "progress" });
  const words = el("span", { class: "soft small" }, "waiting …");
  const cancel = el("button", { type: "button", id: "cancel-verify", onclick: () => {
    cancel.disabled = true;
    words.textContent = "cancelling …";
    api(`/v1/jobs/${asked.id}/cancel`, { method: "POST" }).catch((error) => tell(problem, error));
  } }, "Cancel");
  fill(place, el("div", { class: "row" }, bar, cancel), words);
  place.hidden = false;
  working = true;
  ready();
  const news = (job) => {
    if (job.share) bar.value = job.share;
    if (!cancel.disabled) words.textContent = job.state === "queued" ? "queued …" : job.message || "comparing …";
  };
  const line = { lost: () => { words.textContent = AWAY_WORDS; }, back: () => { words.textContent = "…"; } };
  try {
    const job = await followed(asked, news, line);
    await shown(job, line);
    place.hidden = true;  // before the scroll distance is measured
    const isCalm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    byId(part).scrollIntoView({ behavior: isCalm ? "auto" : "smooth", block: "start" });
  } finally {
    working = false;
    place.hidden = true;
    ready();
  }
}

async function begin() {
  const asked = new URLSearchParams(location.search);
  await Promise.all([library("/v1/machines", byId("machine")), library("/v1/materials", byId("material")), log.ready]);
  if (asked.get("id")) {
    const job = await api(`/v1/jobs/${asked.get("id")}`);
    await recall(job);
    await follow(job, "result", showVerification);
  } else if (asked.get("cycle")) {
    const job = await api(`/v1/jobs/${asked.get("cycle")}`);
    const { log_id: id, run_id: run, monitor } = job.request;
    for (const name of ["machine", "units"]) byId(name).value = job.request[name];
    if (id || run || monitor) await log.recall(job.request);
    if (job.program_id && !run) await choice.use(job.program_id);
    await follow(job, "cycle-card", showCycleTime);
  } else if (asked.get("run")) await log.recall({ run_id: asked.get("run") });
  else if (asked.get("monitor")) await log.recall({ monitor: asked.get("monitor") });
}

begin().catch((error) => tell(problem, error));
