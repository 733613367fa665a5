// The program of the plan page: upload, example or earlier upload, and its findings.

import { Problem, announce, api, byId, counted, el, fill, number, tell } from "/dashboard/app.js";
import { programTitle } from "/dashboard/records.js";

const RANK = ["error", "warning", "note"];
const KIND = { error: "bad", warning: "warn", note: "soft" };

/** Create counts of findings by severity, which expand to the list. */
export function findingsList(findings, what) {
  if (!findings.length) return el("p", { class: "soft small" }, `No findings ${what}.`);
  const counts = RANK.map((name) => [name, findings.filter((each) => each.severity === name).length])
    .filter(([, count]) => count);
  const sorted = [...findings].sort((a, b) => RANK.indexOf(a.severity) - RANK.indexOf(b.severity));
  return el("details", { class: "findings" },
    el("summary", {}, `Findings ${what}: `, counts.flatMap(([name, count]) =>
      [el("span", { class: `badge ${KIND[name]}` }, `${count} ${name}${count > 1 ? "s" : ""}`), " "])),
    el("ul", { class: "plain small" }, sorted.map((each) => el("li", {},
      el("span", { class: `badge ${KIND[each.severity] ?? ""}` }, each.severity), each.message,
      el("span", { class: "soft" }, place(each))))));
}

function place({ entity, attribute, line }) {
  const at = [[entity, attribute].filter(Boolean).join(" "), line ? `line ${line}` : ""];
  const told = at.filter(Boolean).join(", ");
  return told ? ` (${told})` : "";
}

/** Upload an example, or reuse its earlier copy while the service remembers the request. */
async function sample(name) {
  const path = `/v1/programs?example=${encodeURIComponent(name)}`;
  try {
    return await api(path, { method: "POST", headers: { "idempotency-key": `example ${name}` } });
  } catch (error) {
    // The copy was deleted, or the example has changed since.
    if (error.status === 404 || error.status === 409) return api(path, { method: "POST" });
    throw error;
  }
}

export const isCode = (program) => program.kind === "nc-code";

/**
 * Set up the choice of a program; calls `chosen(program, contents)`, or `chosen(null)` for none.
 * `takesCode`: whether NC code may be chosen too.
 */
export function programChoice(chosen, { takesCode = false } = {}) {
  const drop = byId("drop"), problem = byId("program-problem");
  const examples = byId("program-example"), known = byId("program-known");
  let wanted = 0;

  async function use(getting, words) {
    const mine = wanted += 1;
    tell(problem, null);
    fill(byId("program-shown"), el("p", { class: "soft" }, words));
    chosen(null);
    try {
      const program = await getting;
      if (isCode(program) && !takesCode)
        throw new Problem({ detail: `${program.name} is NC code: this page needs a STEP-NC program.` }, 0);
      const units = byId("units").value;
      const contents = await api(`/v1/programs/${program.id}/findings?units=${units}`);
      if (mine !== wanted) return;
      shown(program, contents);
      chosen(program, contents);
      announce(isCode(program) ? `${program.name}: NC code, ${counted(contents.blocks, "block")}`
        : `${program.name}: ${counted(contents.workingsteps.length, "workingstep")}`);
      await list(program.id);
    } catch (error) {
      if (mine !== wanted) return;
      fill(byId("program-shown"));
      tell(problem, error);
    }
  }

  const upload = (file) => use(api(`/v1/programs?name=${encodeURIComponent(file.name.replace(/\.gz$/, ""))}`,
    { method: "POST", body: file, headers: { "content-type": "application/octet-stream",
      ...(file.name.endsWith(".gz") ? { "content-encoding": "gzip" } : {}) } }), `reading ${file.name} …`);

  byId("program-file").addEventListener("change", (event) => {
    const [file] = event.target.files;
    if (file) upload(file);
    event.target.value = "";
    examples.value = known.value = "";
  });
  examples.addEventListener("change", () => {
    if (!examples.value) return;
    const name = examples.value;
    use(sample(name), `reading ${name} …`);
  });
  known.addEventListener("change", () => {
    if (!known.value) return;
    examples.value = "";
    use(api(`/v1/programs/${known.value}`), "reading …");
  });
  // A file dropped beside the target must not replace the page.
  for (const name of ["dragover", "drop"])
    document.addEventListener(name, (event) => event.preventDefault());
  for (const name of ["dragenter", "dragover"])
    drop.addEventListener(name, () => drop.classList.add("over"));
  for (const name of ["dragleave", "drop"])
    drop.addEventListener(name, () => drop.classList.remove("over"));
  drop.addEventListener("drop", (event) => {
    const [file] = event.dataTransfer.files;
    if (file) upload(file);
  });

  async function list(selected = "") {
    const page = await api("/v1/programs?limit=200");
    const items = page.items.filter((each) => takesCode || !isCode(each));
    fill(known, el("option", { value: "" }, items.length ? "choose …" : "none yet"),
      items.map((each) => el("option", { value: each.id }, programTitle(each))));
    known.value = selected;
  }

  async function begin() {
    const about = await api("/v1/about");
    examples.append(...about.samples.map((name) => el("option", { value: name }, name)));
    await list();
  }
  begin().catch((error) => tell(problem, error));

  return {
    use: (id) => use(api(`/v1/programs/${id}`), "reading …"),
    again: (id) => id && use(api(`/v1/programs/${id}`), "reading …"),
  };
}

/** Return the size of a program in words. */
const sizeWords = ({ size_bytes: size }) =>
  (size >= 1e6 ? `${(size / 1e6).toFixed(1)} MB` : `${(size / 1e3).toFixed(1)} kB`);

/** Show what NC code says: its control, and its moves by tool. */
function shownCode(program, contents) {
  const guessed = contents.hints.length ? `, recognised by ${contents.hints.slice(0, 4).join(", ")}` : "";
  const heads = ["Tool", "Moves", "Number", "Length, mm", "Feed, mm/min", "May change"];
  const feeds = ({ least_feed_mm_min: least, greatest_feed_mm_min: greatest }) =>
    (least === null ? "–" : least === greatest ? number(least) : `${number(least)} to ${number(greatest)}`);
  fill(byId("program-shown"),
    el("p", {}, el("b", { id: "program-name" }, program.name), " ", el("span", { class: "soft" },
      `NC code for ${contents.control} (${contents.machine}${guessed}), ${contents.units}, ${counted(contents.blocks, "block")}, `
      + `${counted(contents.executed_moves, "move")}, ${sizeWords(program)}`)),
    el("div", { class: "scroll moves", tabindex: "0", role: "region", "aria-label": "Moves by tool" },
      el("table", { class: "small", id: "moves" },
        el("thead", {}, el("tr", {}, heads.map((title, at) => el("th", { scope: "col", class: at > 1 ? "n" : undefined }, title)))),
        el("tbody", {}, contents.moves.map((row) => el("tr", {},
          el("th", { scope: "row" }, row.tool === null ? "–" : `T${row.tool}`), el("td", {}, row.kind),
          [row.count, number(row.length_mm), feeds(row), row.advisable].map((text) => el("td", { class: "n" }, String(text)))))))),
    findingsList(contents.findings, "in the code"));
}

function shown(program, contents) {
  if (isCode(program)) { shownCode(program, contents); return; }
  const count = contents.workingsteps.length;
  fill(byId("program-shown"),
    el("p", {}, el("b", { id: "program-name" }, program.name), " ", el("span", { class: "soft" },
      `${counted(count, "workingstep")}, ${counted(contents.instances, "instance")}, ${sizeWords(program)}`)),
    contents.is_usable ? null
      : el("div", { class: "banner bad", role: "alert" }, "This program cannot be optimised: see its errors."),
    findingsList(contents.findings, "in the file"));
  if (!contents.is_usable) {
    const list = byId("program-shown").querySelector("details");
    if (list) list.open = true;
  }
}
