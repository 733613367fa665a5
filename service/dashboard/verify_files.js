// Files of a verification: uploads of logs, tool tables and required parts.

import { announce, api, el, fill, tell } from "/dashboard/app.js";

/** File name extensions of tool tables. */
export const TOOL_FILES = ".toml,.csv,.tbl,.json,.tools,.hsmlib,.gz";

/** Upload a file of a kind; one that ends in .gz is unpacked by the service. */
export function upload(file, kind) {
  const name = file.name.replace(/\.gz$/, "");
  return api(`/v1/files?kind=${kind}&name=${encodeURIComponent(name)}`, { method: "POST", body: file,
    headers: { "content-type": "application/octet-stream",
      ...(file.name.endsWith(".gz") ? { "content-encoding": "gzip" } : {}) } });
}

/** Return the size of a file in words. */
export const sizeWords = ({ size_bytes: size }) =>
  (size >= 1e6 ? `${(size / 1e6).toFixed(1)} MB` : `${(size / 1e3).toFixed(1)} kB`);

/** A field for an optional file, in an element of the page. Running state: the file's id. */
export class FileField {
  constructor(place, { id, kind, title, hint, accept, changed }) {
    Object.assign(this, { place, kind, title, hint, accept, changed, input: id, id: null });
    this.show(null);
  }

  /** Use a stored file; null: none. */
  async use(id) {
    this.show(id === null ? null : await api(`/v1/files/${id}`).catch(() => null));
  }

  show(stored, words = "") {
    this.id = stored?.id ?? null;
    const problem = el("div", {});
    const field = el("input", { id: this.input, class: "unseen", type: "file", accept: this.accept,
      onchange: ({ target }) => this.take(target.files[0], problem) });
    fill(this.place, el("div", { class: "soft small" }, this.title),
      el("div", { class: "given" }, stored
        ? [el("span", { class: "name" }, stored.name), el("button", { type: "button", class: "plain",
            "aria-label": `do not use ${stored.name}`, onclick: () => this.show(null) }, "✕")]
        : [el("label", { class: "button small" }, "Choose", field), el("span", { class: "soft small" }, words || this.hint)]),
      problem);
    this.changed();
  }

  async take(file, problem) {
    if (!file) return;
    try {
      const stored = await upload(file, this.kind);
      this.show(stored);
      announce(`${stored.name} is uploaded`);
    } catch (error) {
      tell(problem, error);
      announce(error.message);
    }
  }
}
