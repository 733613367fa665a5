// The panes Input and Machine, for a trial cut and for a program.

import { el, fill } from "/dashboard/app.js";
import { checkField, choiceField, described, numberField, told } from "/dashboard/control_fields.js";

const STEPS = { tool_diameter_mm: 1, teeth: 1, cutting_edge_angle_deg: 5, radial_width_mm: 1,
  cutting_speed_m_min: 10, efficiency: 0.05, feed_per_tooth_mm: 0.01, axial_depth_mm: 0.5,
  motor_power_kw: 0.5, axial_depth_max_mm: 0.5,
  motor_power_percent: 5, depth_percent: 5, hardness_percent: 5 };
const WORDS = { efficiency: "efficiency", motor_power_percent: "allowed motor power",
  depth_percent: "depth", hardness_percent: "hardness" };
const UNITS = { depth_percent: "%", hardness_percent: "%" };
const MILLING = { full: "full: a slot", up: "up: conventional", down: "down: climb",
  symmetric: "symmetric: the middle" };
const LAWS = { "log-pi": "log PI", "pi": "PI", "fuzzy": "fuzzy", "self-tuning": "self-tuning",
  "mrac": "model reference (MRAC)", "mpc": "predictive (MPC)", "none": "none: only monitoring" };
/** disturbances that are set before the start, as in the option --disturb */
const DISTURBANCES = [["kc:1.3", "k_c 30 % above the catalogue's"], ["depth:+50%@12s", "depth, from 12 s on"],
  ["hardness:+30%@12s", "k_c, from 12 s on"], ["tooth:1@12s", "the first tooth breaks"],
  ["wear:0.05mm/min", "flank wear in each minute of cutting"], ["silence:2s@12s", "no force readings for 2 s"],
  ["override:80%@12s", "the axes run 80 %, whatever is commanded"], ["line:off@12s", "the connection breaks"]];
const PACES = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];

/** Read inputs and control laws from the OpenAPI document of the service. */
export function bookOf(document) {
  const { schemas } = document.components;
  const example = document.paths["/v1/trials"].post.requestBody.content["application/json"].example;
  const usualRun = Object.fromEntries(Object.entries(schemas.ControlRequest.properties)
    .map(([name, property]) => [name, property.default]));
  return { trial: schemas.TrialInputs, run: schemas.ControlChanges, usual: example.inputs, usualRun,
    milling: schemas.MillingType.enum, laws: schemas.LawName.enum,
    paceTrial: schemas.TrialBody.properties.pace.default };
}

function number(schema, name, ask) {
  const spec = described(schema, name);
  return numberField({ ...spec, words: WORDS[name] ?? spec.words, unit: UNITS[name] ?? spec.unit,
    step: STEPS[name] }, ask);
}

/** Options of materials; those of the shop can be chosen only when a program is started. */
export const materialOptions = (materials, hasOwn = false) => materials
  .filter((each) => hasOwn || !each.is_own).map(({ name, title }) => [name, `${name} · ${title}`]);

export const paceField = (ask) => choiceField({ name: "pace", words: "Pace", isNumber: true },
  PACES.map((pace) => [pace, `${pace} ×`]), ask);

const pane = (id, title, fields, ...more) => el("section", { class: "card pane", id,
  "aria-labelledby": `${id}-title` }, el("h2", { id: `${id}-title` }, title), more,
el("div", { class: "grid" }, fields.map((field) => field.node)));

/** Create the panes of the trial cut. */
export function trialPanes(book, materials, ask) {
  const milling = choiceField({ name: "milling_type", words: "milling type" },
    book.milling.map((each) => [each, MILLING[each] ?? each]), ask);
  const material = choiceField({ name: "material", words: "workpiece material" },
    materialOptions(materials), ask);
  const inputs = ["tool_diameter_mm", "teeth", "cutting_edge_angle_deg", "radial_width_mm",
    "cutting_speed_m_min", "efficiency", "feed_per_tooth_mm", "axial_depth_mm"]
    .map((name) => number(book.trial, name, ask));
  const machine = ["motor_power_kw", "axial_depth_max_mm"].map((name) => number(book.trial, name, ask));
  milling.node.classList.add("half");
  material.node.classList.add("half");
  const width = inputs.find((field) => field.spec.name === "radial_width_mm");
  return {
    fields: [milling, material, ...inputs, ...machine],
    nodes: [pane("input", "Input", [milling, material, ...inputs]), pane("machine", "Machine", machine)],
    /** In a slot the width equals the cutter diameter. */
    fit(values) {
      const isFull = values.milling_type === "full";
      width.enable(!isFull && width.isFree);
      if (isFull) width.show(values.tool_diameter_mm, false);
      width.node.title = isFull ? "in full milling the width equals the tool diameter" : "";
    },
    enable(isFree) {
      for (const field of this.fields) { field.isFree = isFree; field.enable(isFree); }
    },
  };
}

/** Create the panes of a running program under control. */
export function programPanes(book, materials, ask) {
  const material = choiceField({ name: "material", words: "workpiece material" },
    materialOptions(materials), ask);
  material.node.classList.add("wide");
  const hidden = ["depth_percent", "hardness_percent"].map((name) => number(book.run, name, ask));
  const power = number(book.run, "motor_power_percent", ask);
  const shown = { program: told("program", "program"), workingstep: told("workingstep", "workingstep"),
    tool: told("tool", "tool"), depth: told("depth", "actual depth", "mm"),
    motor: told("motor", "motor power available", "kW"), done: told("progress", "program done", "%") };
  for (const each of [shown.program, shown.workingstep, shown.tool]) each.node.classList.add("wide");
  return {
    fields: [material, ...hidden, power], told: shown,
    nodes: [
      pane("input", "Input", [shown.program, shown.workingstep, shown.tool, shown.depth, shown.done,
        material, ...hidden], el("p", { class: "soft small" },
        "The program fixes tool, width and speed. Material, depth and hardness, in % of the plan, "
        + "are changed without telling the loop, which notices them by the force.")),
      pane("machine", "Machine", [power, shown.motor]),
    ],
    fit() {},
    enable(isFree) { for (const field of this.fields) field.enable(isFree); },
  };
}

/** Create the form that starts a program. */
export function startPanes(book, { programs, advices, machines, materials }) {
  const choice = (name, words, options) => choiceField({ name, words }, options, () => {});
  const program = choice("program", "program", []);
  fill(program.select,
    programs.length ? el("optgroup", { label: "as uploaded" }, programs.map((each) =>
      el("option", { value: `program:${each.id}` }, each.title))) : null,
    advices.length ? el("optgroup", { label: "with advised feeds" }, advices.map((each) =>
      el("option", { value: `advice:${each.id}` }, each.title))) : null);
  const machine = choice("machine", "machine", [["", "automatic"],
    ...machines.map(({ name, title }) => [name, `${name} · ${title}`])]);
  const material = choice("material", "workpiece material",
    [["", "as in the program"], ...materialOptions(materials, true)]);
  const law = choice("law", "control law", book.laws.map((each) => [each, LAWS[each] ?? each]));
  const disturbances = el("input", { id: "in-disturbances", type: "text", placeholder: "kc:1.3 depth:+50%@12s",
    "aria-describedby": "disturbances-help" });
  const preview = checkField({ name: "has_preview", words: "use a preview of the cut ahead" }, () => {});
  const recorded = checkField({ name: "is_recorded", words: "record the outcome in the knowledge base" }, () => {});
  const fields = [program, machine, material, law, preview, recorded];
  for (const field of fields) field.node.classList.add("wide");
  for (const field of [law, preview, recorded]) field.show(book.usualRun[field.spec.name]);
  const isEmpty = !programs.length && !advices.length;
  program.enable(!isEmpty);
  return {
    fields,
    nodes: [pane("input", "Input", fields, el("label", { for: disturbances.id }, "disturbances, unknown to the loop", disturbances),
      el("details", { class: "small" }, el("summary", {}, "What can be disturbed"), el("ul", { id: "disturbances-help" },
        DISTURBANCES.map(([word, text]) => el("li", {}, el("code", {}, word), ` ${text}`)))), isEmpty ? el("p", { class: "banner warn", id: "no-programs" },
      "No programs yet: ", el("a", { href: "/dashboard/plan.html" }, "upload one"), ".") : null)],
    isEmpty,
    /** Return the body for POST /v1/control-runs. */
    body() {
      const [kind, id] = program.read().split(":");
      return { [`${kind}_id`]: id, machine: machine.read(), material: material.read(), law: law.read(),
        disturbances: disturbances.value.split(/[\s,;]+/).filter(Boolean),
        has_preview: preview.node.firstChild.checked, is_recorded: recorded.node.firstChild.checked };
    },
    /** Fill the form from the request of another run. */
    preset(request) {
      const source = request.advice_id ? `advice:${request.advice_id}` : `program:${request.program_id}`;
      if ([...program.select.options].some((option) => option.value === source)) program.show(source);
      for (const field of fields.slice(1)) field.show(request[field.spec.name]);
      disturbances.value = (request.disturbances ?? []).join(" ");
    },
    fit() {},
    enable() {},
  };
}
