// The form that starts a run of the virtual machine.

import { announce, api, byId, el, fill, moment, tell } from "/dashboard/app.js";
import { KINDS, programOf, programTitle } from "/dashboard/records.js";
import { PACES } from "/dashboard/machine_words.js";

/** Create the form; `started(job)` receives the new run. `wanted` may preselect the program. */
export async function startForm(place, programs, wanted, started) {
  const [machines, materials, advice] = await Promise.all([
    api("/v1/machines"), api("/v1/materials"), api("/v1/jobs?kind=advice&state=succeeded&limit=50"),
  ]);
  programs = new Map([...programs].filter(([, program]) => program.kind === "step-nc"));
  if (!programs.size) {
    fill(place, el("p", { class: "empty", id: "no-programs" }, "No programs yet. ",
      el("a", { href: "/dashboard/plan.html" }, "Upload one on the page Plan"), ", or use an example there."));
    return;
  }
  const options = (entries) => entries.map(({ name, title }) => el("option", { value: name }, `${name}: ${title}`));
  const chosen = (value) => value === (wanted.advice ? `advice:${wanted.advice}` : `program:${wanted.program}`);
  const choice = (value, text) => el("option", { value, selected: chosen(value) }, text);
  const problem = el("div", { id: "start-problem" });
  const form = el("form", { id: "start", onsubmit: submit },
    el("div", { class: "fields" },
      el("label", { class: "wide" }, "Program", el("select", { id: "start-what", required: true, onchange: follow },
        el("optgroup", { label: "as uploaded" }, [...programs].map(([id, program]) => choice(`program:${id}`, programTitle(program)))),
        el("optgroup", { label: "as advised" }, advice.items.filter((job) => programs.has(job.program_id)).map((job) =>
          choice(`advice:${job.id}`, `${programOf({ ...job, advice_id: job.id }, programs)}, ${job.request.mode}, ${moment(job.created_at)}`))))),
      el("label", {}, "Machine", el("select", { id: "start-machine" },
        el("option", { value: "" }, "automatic"), options(machines))),
      el("label", {}, "Material", el("select", { id: "start-material" },
        el("option", { value: "" }, "as in the program"), options(materials))),
      el("label", {}, "Pace", el("select", { id: "start-pace" },
        PACES.map(([value, text]) => el("option", { value }, text))))),
    el("details", { class: "more" }, el("summary", {}, "Disturbances and sampling"),
      el("div", { class: "fields" },
        el("label", {}, "Factor on k_c", el("input", { id: "start-kc", type: "number", value: "1", min: "0.05", max: "100", step: "any" })),
        el("label", {}, "Sampling rate, Hz", el("input", { id: "start-rate", type: "number", value: "20", min: "1", max: "1000", step: "any" })),
        el("label", {}, "Sensor noise", el("select", { id: "start-noise" }, noises())),
        el("label", {}, "Seed", el("input", { id: "start-seed", type: "number", value: "0", min: "0", step: "1" })),
        el("label", { class: "inline" }, el("input", { id: "start-lag", type: "checkbox" }), "main drive lag"),
        el("label", { class: "inline" }, el("input", { id: "start-wear", type: "checkbox" }), "tool wear"))),
    problem,
    el("p", {}, el("button", { class: "main", id: "start-run" }, "Run")));
  fill(place, form);
  follow();
  const words = await noiseWords();
  fill(byId("start-noise"), words.map((each) => el("option", { value: each }, each)));

  /** Preset the machine and material for which a program was optimised. */
  function follow() {
    const [kind, id] = byId("start-what").value.split(":");
    const source = kind === "advice" ? advice.items.find((job) => job.id === id) : null;
    for (const name of ["machine", "material"]) {
      byId(`start-${name}`).value = source?.request[name] ?? "";
      if (byId(`start-${name}`).selectedIndex < 0) byId(`start-${name}`).value = "";
    }
  }

  async function submit(event) {
    event.preventDefault();
    const [kind, id] = byId("start-what").value.split(":");
    const value = (name) => byId(`start-${name}`).value, of = (name) => Number(value(name));
    byId("start-run").disabled = true;
    try {
      tell(problem, null);
      const job = await api("/v1/simulations", { method: "POST", json: {
        [`${kind}_id`]: id, machine: value("machine"), material: value("material"), pace: of("pace"),
        kc_factor: of("kc"), rate_hz: of("rate"), noise: value("noise"), seed: of("seed"),
        has_lag: byId("start-lag").checked, has_wear: byId("start-wear").checked } });
      announce(`${KINDS.simulation[0]} queued`);
      started(job);
    } catch (error) {
      tell(problem, error);
    } finally {
      byId("start-run").disabled = false;
    }
  }
}

const noises = () => el("option", { value: "none" }, "none");

/** Read the supported kinds of noise from the OpenAPI document. */
async function noiseWords() {
  const found = await api("/v1/openapi.json").catch(() => null);
  return found?.components?.schemas?.NoiseKind?.enum ?? ["none"];
}
