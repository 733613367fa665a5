// The positions to verify: a log file, the samples of a finished run, or a monitored machine.

import { announce, api, byId, el, fill, moment, tell } from "/dashboard/app.js";
import { KINDS, allPrograms, programOf } from "/dashboard/records.js";
import { sizeWords, upload } from "/dashboard/verify_files.js";

const SOURCES = ["log", "run", "monitor"];

/** Make the choice usable; `changed()` is called after each change. */
export function logChoice(changed) {
  const known = Object.fromEntries(SOURCES.map((name) => [name, byId(`${name}-known`)]));
  const files = new Map(), runs = new Map();
  const problem = byId("log-problem"), shown = byId("log-shown");
  let from = "log", isReading = false;

  function turn(name) {
    from = name;
    for (const button of byId("log-from").children)
      button.setAttribute("aria-pressed", String(button.dataset.value === name));
    for (const each of document.querySelectorAll(".from")) each.hidden = each.dataset.from !== name;
    tell(problem, null);
    show();
  }

  function show() {
    const stored = files.get(known.log.value);
    fill(shown, from === "log" && stored ? [el("b", { id: "log-name" }, stored.name),
      ` ${sizeWords(stored)}, ${moment(stored.created_at)}`] : []);
    changed();
  }

  byId("log-from").addEventListener("click", (event) => {
    const value = event.target.closest("button")?.dataset.value;
    if (value) turn(value);
  });
  for (const name of SOURCES) known[name].addEventListener("change", show);
  byId("log-file").addEventListener("change", async (event) => {
    const [file] = event.target.files;
    event.target.value = "";
    if (!file) return;
    tell(problem, null);
    isReading = true;
    known.log.value = "";
    show();
    shown.textContent = `uploading ${file.name} …`;
    try {
      const stored = await upload(file, "log");
      files.set(stored.id, stored);
      known.log.querySelector("option").after(el("option", { value: stored.id }, title(stored)));
      known.log.value = stored.id;
      announce(`${stored.name} is uploaded`);
    } catch (error) {
      tell(problem, error);
      announce(error.message);
    }
    isReading = false;
    show();
  });

  const title = (stored) => `${stored.name}, ${moment(stored.created_at)}`;

  async function list() {
    const ended = (kind) => api(`/v1/jobs?kind=${kind}&state=succeeded&limit=100`);
    const [logs, simulations, controlled, monitors, programs] = await Promise.all([
      api("/v1/files?kind=log&limit=200"), ended("simulation"), ended("control-run"), api("/v1/monitors"), allPrograms()]);
    for (const each of logs.items) files.set(each.id, each);
    const jobs = [...simulations.items, ...controlled.items].sort((a, b) => (a.created_at < b.created_at ? 1 : -1));
    for (const each of jobs) runs.set(each.id, each);
    options(known.log, logs.items.map((each) => [each.id, title(each)]), "none yet");
    options(known.run, jobs.map((each) => [each.id, [programOf(each, programs), KINDS[each.kind][0],
      each.request.machine || "automatic machine", moment(each.created_at)].join(" · ")]), "none yet");
    options(known.monitor, monitors.map(({ name, url }) => [name, `${name}, MTConnect agent ${url}`]), "none");
    if (!monitors.length) byId("monitor-note").textContent = "No machine is monitored: start the service with --agent NAME=URL.";
    show();
  }

  function options(select, entries, none) {
    fill(select, el("option", { value: "" }, entries.length ? "choose …" : none),
      entries.map(([value, text]) => el("option", { value }, text)));
  }

  return {
    ready: list(),
    /** Whether the run brings its program. */
    get hasProgram() { return from === "run"; },
    /** Fields of the request; null while nothing is chosen. */
    get fields() {
      const value = isReading ? "" : known[from].value;
      return value ? { [from === "monitor" ? from : `${from}_id`]: value } : null;
    },
    /** Choose what a request names. */
    async recall(request) {
      const name = request.monitor ? "monitor" : request.run_id ? "run" : "log";
      const value = request.monitor || request.run_id || request.log_id;
      if (![...known[name].options].some((each) => each.value === value))
        known[name].append(el("option", { value }, `${value} (not listed)`));
      known[name].value = value;
      turn(name);
    },
  };
}
