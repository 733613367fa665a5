// The plan page: choose a program, set options, see the advice and its reasons.

import { AWAY_WORDS, Problem, announce, api, byId, duration, el, fill, followed, patiently, tell } from "/dashboard/app.js";
import { codeOptions } from "/dashboard/plan_code.js";
import { isCode, programChoice } from "/dashboard/plan_program.js";
import { isOnCode, showResult, timesOf } from "/dashboard/plan_result.js";
import { beginRuns, endRuns } from "/dashboard/plan_runs.js";

const form = byId("advice-form"), button = byId("optimise"), hint = byId("optimise-hint");
let program = null, working = null;

// -- the program ------------------------------------------------------------------------------

const choice = programChoice((chosen, contents) => {
  program = chosen && (isCode(chosen) || contents.is_usable) ? chosen : null;
  if (chosen) suit(isCode(chosen));
  ready();
  const steps = chosen && !isCode(chosen) ? contents.workingsteps : [];
  const place = byId("only-steps");
  place.hidden = steps.length < 2;
  fill(place, el("legend", {}, "Workingsteps"), steps.map((step) =>
    el("label", { class: "inline" }, el("input", { type: "checkbox", name: "only",
      value: step.instance, checked: true }), step.id)));
}, { takesCode: true });
const code = codeOptions(ready);
code.ready.catch((error) => tell(byId("advice-problem"), error));

/** Show the options that suit the kind of the program. */
function suit(isOfCode) {
  for (const each of form.querySelectorAll(".of-program")) each.hidden = isOfCode;
  for (const each of form.querySelectorAll(".of-code")) each.hidden = !isOfCode;
  // NC code has no energy or cost to choose by: its depths and speeds stay.
  if (isOfCode && ["EC", "CC"].includes(form.elements.mode.value)) form.elements.mode.value = "TC";
  byId("roughness").placeholder = isOfCode ? "none" : "as in the program";
  byId("material").options[0].textContent = isOfCode ? "choose …" : "as in the program";
  showAlongFields();
}

/** Show the options of feeds along the path where they are chosen. */
function showAlongFields() {
  const isAlong = byId("along").checked || !byId("code-options").hidden;
  byId("along-fields").hidden = !isAlong;
  byId("write-toolpaths").disabled = !isAlong;
  for (const each of byId("along-fields").querySelectorAll("input")) each.disabled = !isAlong;
}

byId("along").addEventListener("change", showAlongFields);
showAlongFields();

byId("units").addEventListener("change", () => choice.again(program?.id));

function ready() {
  const missing = !program ? "Choose a program first." : isCode(program) ? code.missing : "";
  button.disabled = Boolean(missing) || working !== null;
  hint.textContent = working ? "" : missing;
}

// -- options ---------------------------------------------------------------------------------

async function library(path, select) {
  const entries = await api(path);
  select.append(...entries.map((each) => el("option", { value: each.name },
    each.title === each.name ? each.name : `${each.name}: ${each.title}`)));
}

const checked = (name) =>
  [...form.querySelectorAll(`input[name="${name}"]:checked`)].map((each) => each.value);
const numeric = (id) => (byId(id).value === "" ? null : byId(id).valueAsNumber);

/** Return the options of feeds along the path. */
function alongWish() {
  const smooth = numeric("smooth");
  return { smooth_share: smooth === null ? null : smooth / 100, levels: numeric("levels"), max_feed_mm_min: numeric("max-feed"),
    least_feed_mm_min: numeric("least-feed"), stock_margin_mm: numeric("stock-margin"), corner_tolerance_mm: numeric("corner-tolerance") };
}

/** Return the request body for NC code. */
function codeWish() {
  const safety = numeric("safety");
  return { mode: form.elements.mode.value, machine: byId("machine").value, material: byId("material").value,
    roughness_um: numeric("roughness"), ...code.fields, ...alongWish(),
    ...(safety === null ? {} : { safety: safety / 100 }) };
}

/** Return the request body. Throws a problem if an input is missing. */
function wish() {
  if (isCode(program)) return codeWish();
  const free = checked("free"), only = checked("only");
  const all = form.querySelectorAll('input[name="only"]').length;
  if (!free.length) throw new Problem({ detail: "Select at least one quantity that may change: feed, depth or speed." }, 0);
  if (all && !only.length) throw new Problem({ detail: "Select at least one workingstep." }, 0);
  const safety = numeric("safety");
  return {
    mode: form.elements.mode.value, machine: byId("machine").value, material: byId("material").value,
    units: byId("units").value, roughness_um: numeric("roughness"), free,
    workingsteps: only.length < all ? only : [], profile: byId("profile").value,
    nc_control: byId("nc-control").value || null, has_pareto: byId("pareto").checked,
    tool_change_s: numeric("tool-change") ?? 0, has_corrections: byId("corrections").checked,
    is_confirmed: byId("confirm").checked, stock: byId("stock").value.trim(),
    ...(safety === null ? {} : { safety: safety / 100 }),
    ...(byId("along").checked ? { is_along_path: true, writes_toolpaths: byId("write-toolpaths").checked, ...alongWish() } : {}),
  };
}

/** Fill the form from a request. */
function recall(request) {
  const put = (id, value) => { byId(id).value = value ?? ""; };
  for (const each of form.querySelectorAll('input[name="mode"]')) each.checked = each.value === request.mode;
  for (const each of form.querySelectorAll('input[name="free"]')) each.checked = request.free.includes(each.value);
  for (const [id, name] of [["machine", "machine"], ["material", "material"], ["units", "units"],
    ["roughness", "roughness_um"], ["profile", "profile"], ["nc-control", "nc_control"],
    ["tool-change", "tool_change_s"], ["stock", "stock"], ["levels", "levels"], ["max-feed", "max_feed_mm_min"],
    ["least-feed", "least_feed_mm_min"]]) put(id, request[name]);
  put("stock-margin", request.stock_margin_mm ?? 1);
  put("corner-tolerance", request.corner_tolerance_mm ?? 0.05);
  put("smooth", request.smooth_share ? Number((100 * request.smooth_share).toFixed(6)) : null);
  byId("along").checked = request.is_along_path ?? false;
  byId("write-toolpaths").checked = request.writes_toolpaths ?? false;
  showAlongFields();
  byId("pareto").checked = request.has_pareto;
  byId("confirm").checked = request.is_confirmed ?? false;
  byId("corrections").checked = request.has_corrections;
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  if (program && !working) optimise();
});

async function optimise() {
  const problem = byId("advice-problem");
  tell(problem, null);
  let body;
  try { body = wish(); } catch (error) { tell(problem, error); return; }
  endRuns();
  byId("result").hidden = true;
  try {
    const asked = await api(`/v1/programs/${program.id}/advice`, { method: "POST", json: body,
      headers: { "idempotency-key": crypto.randomUUID?.() ?? String(Math.random()) } });
    history.replaceState(null, "", `?advice=${asked.id}`);
    await follow(asked);
  } catch (error) {
    const isCancelled = error.message === "the job is cancelled";
    if (isCancelled) fill(problem, el("p", { class: "soft" }, "Cancelled."));
    else tell(problem, error);
    announce(isCancelled ? "cancelled" : error.message);
  }
}

/** Wait for the result of an advice job, and show it. */
async function follow(asked) {
  const place = byId("advice-work"), bar = el("progress", { max: 1, "aria-label": "progress" });
  const words = el("span", { class: "soft small" }, "waiting …");
  const cancel = el("button", { type: "button", id: "cancel-advice", onclick: () => {
    cancel.disabled = true;
    words.textContent = "cancelling …";
    api(`/v1/jobs/${asked.id}/cancel`, { method: "POST" }).catch((error) => tell(byId("advice-problem"), error));
  } }, "Cancel");
  fill(place, el("div", { class: "row" }, bar, cancel), words);
  place.hidden = false;
  working = asked;
  ready();
  const begun = performance.now();
  const news = (job) => {
    if (job.share) bar.value = job.share;
    if (!cancel.disabled) words.textContent = job.state === "queued" ? "queued …"
      : job.message || "optimising …";
  };
  const line = { lost: () => { words.textContent = AWAY_WORDS; }, back: () => { words.textContent = "…"; } };
  try {
    const job = await followed(asked, news, line);
    const result = await patiently(`/v1/advice/${job.id}`, line);
    byId("result").hidden = false;
    showResult(job, result);
    const { before, after } = timesOf(result), longer = Math.max(before, after);
    announce(`Optimised: ${duration(before, longer)} becomes ${duration(after, longer)}`);
    performance.measure("optimise to table", { start: begun });
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches && begun)
    {
      place.hidden = true;  // before the scroll distance is measured
      byId("result").scrollIntoView({ behavior: "smooth", block: "start" });
    }
    if (isOnCode(result)) return;
    beginRuns(job, result, { rate: byId("rate").valueAsNumber || 20,
      isWanted: byId("simulate-after").checked });
  } finally {
    working = null;
    place.hidden = true;
    ready();
  }
}

// -- advice of an earlier request ---------------------------------------------------------------

async function reopen(id) {
  const job = await api(`/v1/jobs/${id}`);
  recall(job.request);
  await code.recall(job.request);
  if (job.program_id) await choice.use(job.program_id);
  await follow(job);
}

async function begin() {
  const asked = new URLSearchParams(location.search);
  await Promise.all([library("/v1/machines", byId("machine")), library("/v1/materials", byId("material"))]);
  if (asked.get("advice")) await reopen(asked.get("advice"));
  else if (asked.get("program")) await choice.use(asked.get("program"));
}

begin().catch((error) => tell(byId("advice-problem"), error));
