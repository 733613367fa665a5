// The knowledge page: planned against measured values, and learned factors on k_c.

import { api, byId, counted, done, el, figure, fill, moment, number, save, show, tell, words } from "/dashboard/app.js";
import { factors } from "/dashboard/knowledge_factors.js";
import { outcomePlots } from "/dashboard/knowledge_plots.js";
import { evaluationTable } from "/dashboard/knowledge_table.js";

const asked = new URLSearchParams(location.search);
const MOST = 2000;
const GROUPINGS = ["feature", "kind"];
const FILTERS = ["all", "violated", "wasted", "with remarks", "with trend", "factor pending"];
const SORTS = ["name", "grade", "runs", "latest", "force", "time", "feed", "roughness", "time to win"];
const NAMED = ["machine", "material", "tool", "feature_kind", "program"];

const select = (id, label, options, all) => el("label", {}, label, el("select", { id },
  all ? el("option", { value: "" }, all) : null, options.map((each) => el("option", { value: each }, words(each)))));

const main = byId("main"), trouble = el("div", { id: "problem" });
fill(main,
  el("div", { class: "title" }, el("h1", {}, "Knowledge"),
    el("span", { class: "soft" }, "planned and measured values, and corrections for the next plans")),
  trouble, el("div", { id: "content", class: "pieces" }));

/** Return the request body from the fields of the form. */
function selection() {
  const day = (id, days) => {
    if (!byId(id).value) return null;
    const at = new Date(`${byId(id).value}T00:00`);
    at.setDate(at.getDate() + days);
    return at.toISOString();
  };
  const named = NAMED.map((name) => [name, byId(`filter-${name}`).value || null]);
  return { ...Object.fromEntries(named), since: day("filter-since", 0), until: day("filter-until", 1) };
}

function restore(request) {
  for (const name of NAMED) choose(`filter-${name}`, request[name] ?? "");
  const date = (text, days) => {
    if (!text) return "";
    const at = new Date(text);
    at.setDate(at.getDate() - days);
    return `${at.getFullYear()}-${String(at.getMonth() + 1).padStart(2, "0")}-${String(at.getDate()).padStart(2, "0")}`;
  };
  byId("filter-since").value = date(request.since, 0);
  byId("filter-until").value = date(request.until, 1);
  for (const name of ["grouping", "only", "sort"]) choose(`table-${name}`, request[name]);
}

function choose(id, value) {
  const place = byId(id);
  if (![...place.options].some((option) => option.value === value)) place.append(el("option", { value }, value));
  place.value = value;
}

async function outcomes() {
  const query = new URLSearchParams({ limit: String(MOST) });
  for (const [name, value] of Object.entries(selection())) if (value) query.set(name, value);
  return api(`/v1/outcomes?${query}`);
}

// -- the page ---------------------------------------------------------------------------------

function build(known, all) {
  const distinct = (name, entries) => [...new Set(entries.map((each) => each[name]))].sort();
  const form = el("form", { id: "filters", onsubmit: (event) => { event.preventDefault(); make(); } },
    el("div", { class: "fields" },
      select("filter-machine", "Machine", distinct("machine", known), "any"),
      select("filter-material", "Material", distinct("material", known), "any"),
      select("filter-tool", "Tool", distinct("tool", known), "any"),
      select("filter-feature_kind", "Kind of feature", distinct("feature_kind", all.outcomes), "any"),
      select("filter-program", "Program", distinct("program", all.outcomes), "any"),
      el("label", {}, "From (date)", el("input", { type: "date", id: "filter-since" })),
      el("label", {}, "To (inclusive)", el("input", { type: "date", id: "filter-until" })),
      select("table-grouping", "Group rows by", GROUPINGS), select("table-only", "Rows", FILTERS),
      select("table-sort", "Sort by", SORTS)),
    el("div", { class: "row actions" }, el("button", { class: "main", id: "make-table" }, "Compute table"),
      el("button", { type: "reset", id: "reset-filters", onclick: () => setTimeout(make) }, "All outcomes"),
      el("span", { class: "soft small", id: "table-progress", role: "status" })));
  fill(byId("content"),
    el("section", { class: "card", "aria-label": "summary" }, el("div", { class: "figures", id: "known" },
      figure("Outcomes", number(all.total, 7)),
      figure("Runs", number(distinct("run", all.outcomes).length, 7), all.total > all.outcomes.length ? `of the last ${counted(all.outcomes.length, "outcome")}` : ""),
      figure("Contexts", String(known.length), "machine, material, tool"),
      el("div", { class: "figure" }, el("div", { class: "name" }, "open k_c proposals"),
        el("div", {}, el("a", { href: "#factors", class: "value", id: "known-proposals" }, "–"))))),
    el("section", { class: "card", "aria-labelledby": "evaluation-title" },
      el("div", { class: "row spread" }, el("h2", { id: "evaluation-title" }, "Evaluation"),
        el("div", { class: "row no-print", id: "table-files" })),
      form, el("div", { id: "table-problem" }), el("div", { id: "table-place" })),
    el("div", { id: "plots" }),
    el("section", { class: "card", id: "factors", "aria-labelledby": "factors-title" },
      el("h2", { id: "factors-title" }, "Specific cutting force k_c"), el("div", { id: "factors-place" })));
}

async function make() {
  const button = byId("make-table"), place = byId("table-progress");
  button.disabled = true;
  tell(byId("table-problem"), null);
  const rest = { grouping: byId("table-grouping").value, only: byId("table-only").value, sort: byId("table-sort").value };
  try {
    const job = await done("/v1/evaluations", { ...selection(), ...rest },
      (now) => { place.textContent = now.state === "queued" ? "queued" : now.message || now.state; });
    await open(job);
    place.textContent = "";
  } catch (error) {
    place.textContent = "";
    tell(byId("table-problem"), error);
  } finally {
    button.disabled = false;
  }
}

/** Show the table of an evaluation, and its outcomes. */
async function open(job) {
  const path = `/v1/evaluations/${job.id}`;
  restore(job.request);
  history.replaceState(null, "", `?evaluation=${job.id}${location.hash}`);
  const [table, found] = await Promise.all([api(path), outcomes()]);
  fill(byId("table-files"),
    el("button", { id: "get-csv", onclick: () => save(`${path}/table?form=csv`) }, "CSV"),
    el("button", { id: "get-parquet", onclick: () => save(`${path}/table?form=parquet`) }, "Parquet"),
    el("button", { id: "get-report", onclick: () => show(`${path}/report`) }, "Report"));
  const newest = found.outcomes[0]?.recorded_at;
  const isOld = newest && new Date(newest) > new Date(table.made_at);
  fill(byId("table-place"),
    el("p", { class: "soft small", id: "table-facts" },
      `Computed ${moment(table.made_at)} from ${counted(table.outcomes, "outcome")}: rows ${table.rows.length}` +
      `${table.rows_left_out ? ` and ${table.rows_left_out} not shown` : ""}.`,
      isOld ? el("span", { class: "warn" }, " There are newer outcomes: compute it again.") : null),
    evaluationTable(table));
  await outcomePlots(byId("plots"), found);
}

function empty() {
  fill(byId("content"), el("section", { class: "card", id: "nothing-known" },
    el("h2", {}, "No outcomes yet"),
    el("p", {}, "An outcome describes one workingstep of one run: force, feed, time and roughness, planned and measured. " +
      "The table, the plots and the factors on k_c are based on outcomes. They are recorded in two ways:"),
    el("ul", {},
      el("li", {}, "A controlled run on the page ", el("a", { href: "/dashboard/control.html" }, "Control"), " is recorded when it ends."),
      el("li", {}, "On the command line, into the knowledge base of this service: ",
        el("code", {}, "stepnc control part.stpnc --machine vmc15 --material c45 --preview --kb DATA/knowledge.db"),
        ", where DATA is the service's data folder; measured values of a real machine with ", el("code", {}, "stepnc kbe add"), ".")),
    el("p", {}, "After a few runs, “Review” proposes a factor on k_c; once a person has accepted it, the next plans apply it.")));
}

async function begin() {
  const [known, all] = await Promise.all([api("/v1/outcomes/contexts"), api(`/v1/outcomes?limit=${MOST}`)]);
  if (!all.total) { empty(); return; }
  build(known.contexts, all);
  const told = (count) => { byId("known-proposals").textContent = String(count); };
  const learning = factors(byId("factors-place"), { review: asked.get("review"), told })
    .catch((error) => tell(byId("factors-place"), error));
  if (asked.get("review")) byId("factors").scrollIntoView();
  const wanted = asked.get("evaluation");
  const job = wanted ? await api(`/v1/jobs/${wanted}`)
    : (await api("/v1/jobs?kind=evaluation&state=succeeded&limit=1")).items[0];
  if (job?.state === "succeeded") await open(job).catch((error) => tell(byId("table-problem"), error));
  else await make();
  await learning;
  if (asked.get("review")) byId("factors").scrollIntoView();
}

begin().catch((error) => tell(trouble, error));
