// Options of NC code: its tool table, raw part, control, and tools with feeds of their own.

import { api, byId, el, fill, moment } from "/dashboard/app.js";
import { FileField, TOOL_FILES } from "/dashboard/verify_files.js";

/** Make the options usable; `changed()` is called after each change. */
export function codeOptions(changed) {
  const known = byId("tools-known");
  let tools = null;
  tools = new FileField(byId("tools-place"), { id: "tools-file", kind: "tools", accept: TOOL_FILES,
    title: "Tool table", hint: "TOML, CSV, LinuxCNC, Fusion, HSMWorks", changed: () => { chosen(); changed(); } });
  known.addEventListener("change", () => tools.use(known.value || null));
  for (const name of ["code-stock", "material"]) byId(name).addEventListener("input", changed);

  /** Show in the list what is chosen. */
  function chosen() {
    const id = tools?.id ?? null;
    if (id && ![...known.options].some((each) => each.value === id)) {
      const name = byId("tools-place").querySelector(".name").textContent;
      known.append(el("option", { value: id }, name));
    }
    known.value = id ?? "";
  }

  async function list() {
    const { items } = await api("/v1/files?kind=tools&limit=200");
    fill(known, el("option", { value: "" }, items.length ? "choose …" : "none yet"),
      items.map((each) => el("option", { value: each.id }, `${each.name}, ${moment(each.created_at)}`)));
    chosen();
  }

  const names = (id) => byId(id).value.split(/[\s,;]+/).filter(Boolean);

  return {
    ready: list(),
    /** What is missing, in words; empty if nothing is. */
    get missing() {
      const wanted = [[tools.id, "a tool table"], [byId("code-stock").value.trim(), "the raw part"], [byId("material").value, "a material"]];
      const words = wanted.filter(([value]) => !value).map(([, text]) => text);
      return words.length ? `NC code needs ${words.join(", ")}.` : "";
    },
    /** Fields of the request. */
    get fields() {
      return { tools_id: tools.id, stock: byId("code-stock").value.trim(), dialect: byId("dialect").value || null,
        finish: names("finish"), keep: names("keep"), is_marked: byId("mark").checked,
        is_unrolled: byId("unroll").checked, allow_plunge: byId("allow-plunge").checked,
        ...(byId("greatest-rise").value === "" ? {} : { greatest_rise: byId("greatest-rise").valueAsNumber }) };
    },
    /** Fill the options from a request. */
    async recall(request) {
      byId("code-stock").value = request.stock;
      byId("dialect").value = request.dialect ?? "";
      byId("mark").checked = request.is_marked ?? false;
      byId("unroll").checked = request.is_unrolled ?? false;
      byId("allow-plunge").checked = request.allow_plunge ?? false;
      byId("greatest-rise").value = request.greatest_rise ?? "";
      for (const name of ["finish", "keep"]) byId(name).value = (request[name] ?? []).join(", ");
      await tools.use(request.tools_id ?? null);
    },
  };
}
