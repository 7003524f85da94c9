/**
 * A workbook on its way in: what was read of it, how each column was understood, and what was left
 * out, before anything of it is taken. What a column means can be said by hand.
 * @module
 */
import * as api from "./api.js";
import { change, say } from "./state.js";
import { language, t } from "./words.js";
import { Field, html, observed, signal } from "./view.js";

const ACCEPTED = ".xlsx,.xlsm,.xls,.xlsb,.ods,.csv,.tsv";

/** @typedef {{place: string, header: string, meaning: string | null}} Read a column of the workbook. */
/** @typedef {{sheet: string | null, sheets: string[], columns: Read[], operators: {name: string, kind: string}[], rows: string[][], notes: {message: string}[]}} Seen */
/** @typedef {{meanings: Record<string, string>, kinds: Record<string, string>, sheet?: string}} Said what was said by hand: what columns mean, what operators are, which sheet it is. */

const KINDS = ["human", "robot", "machine"];

/** The workbook that is looked at: its bytes, what was said by hand, what there is to see of it, and the cell that came of it. */
const book = signal(/** @type {{name: string, bytes: ArrayBuffer, said: Said, seen: Seen | null, cell: any, faults: string[]} | null} */ (null));

export const Import = observed(
  () => html`<label class="file">${t("import.button")}<input
    type="file"
    accept=${ACCEPTED}
    onChange=${async (/** @type {any} */ event) => {
      const file = event.currentTarget.files[0];
      event.currentTarget.value = "";
      if (!file) return;
      book.value = { name: file.name, bytes: await file.arrayBuffer(), said: { meanings: {}, kinds: {} }, seen: null, cell: null, faults: [] };
      await read();
    }}
  /></label>`,
);

/** Asks the server what the workbook says; what was seen before stays when a new meaning is refused. */
async function read() {
  const now = book.value;
  if (!now) return;
  const { meanings, kinds, sheet } = now.said;
  /** @type {[string, string][]} */
  const query = [["name", now.name], ["lang", language.value]];
  if (sheet) query.push(["sheet", sheet]);
  for (const [column, meaning] of Object.entries(meanings)) query.push(["map", `${column}=${meaning}`]);
  for (const [name, kind] of Object.entries(kinds)) query.push([kind, name]);
  try {
    const { status, document } = await api.importWorkbook(query, now.bytes);
    if (book.value !== now) return;
    if (status === 200) {
      book.value = { ...now, seen: document, cell: document.cell, faults: [] };
      say("status.read", { name: now.name, n: document.cell.tasks.length });
    } else {
      const faults = document.errors?.map((/** @type {any} */ one) => (one.where ? `${one.where}: ${one.message}` : one.message)) ?? [document.error];
      book.value = { ...now, seen: document.seen ?? now.seen, cell: null, faults };
      say("status.refused", { reason: faults[0] }, "bad");
    }
  } catch (error) {
    if (!(error instanceof api.Unreachable)) throw error;
  }
}

/** @param {Read} column @returns {string} the letters of the column in its sheet. */
const lettersOf = (column) => /!([A-Z]+)\d*$/.exec(column.place)?.[1] ?? column.header;

/** @param {Read} column @param {Seen} seen @returns {string} what it is called where its meaning is said: its header, or its letters where that is none of its own. */
function nameOf(column, seen) {
  const alone = seen.columns.filter((other) => other.header === column.header).length === 1;
  return column.header && alone && !/^[A-Z]{1,2}$/.test(column.header) ? column.header : lettersOf(column);
}

/** @param {Partial<Said>} part */
function tell(part) {
  if (!book.value) return;
  book.value = { ...book.value, said: { ...book.value.said, ...part } };
  read();
}

/** @param {string} column @param {string} meaning */
function mean(column, meaning) {
  const { [column]: _, ...others } = book.value?.said.meanings ?? {};
  tell({ meanings: meaning.trim() ? { ...others, [column]: meaning.trim() } : others });
}

function take() {
  const now = book.value;
  if (!now?.cell) return;
  change({ cell: now.cell, hand: null, locks: [] });
  say("status.imported", { name: now.name, n: now.cell.tasks.length });
  book.value = null;
}

export const Preview = observed(() => {
  const now = book.value;
  if (!now) return null;
  const { seen, faults } = now;
  return html`<section class="preview" aria-label=${t("import.title", { name: now.name })}>
    <div class="heading">
      <h2>${t("import.title", { name: now.name })}</h2>
      <span class="tools">
        ${now.cell ? html`<button class="first" onClick=${take}>${t("import.take", { n: now.cell.tasks.length })}</button>` : null}
        <button onClick=${() => (book.value = null)}>${t("button.discard")}</button>
      </span>
    </div>
    ${faults.length ? html`<div class="faults"><ul>${faults.map((one) => html`<li>${one}</li>`)}</ul></div>` : null}
    ${seen ? html`<${Sheet} seen=${seen} /><${Columns} seen=${seen} /><${Kinds} seen=${seen} />` : null}
  </section>`;
});

/** Which sheet has the tasks, where there are several. */
const Sheet = observed((/** @type {{seen: Seen}} */ { seen }) => {
  if (seen.sheets.length < 2) return null;
  return html`<p><label>${t("import.sheet")} <select value=${seen.sheet} onChange=${(/** @type {any} */ event) => tell({ sheet: event.currentTarget.value, meanings: {} })}>
    ${seen.sheets.map((name) => html`<option key=${name} value=${name} selected=${name === seen.sheet}>${name}</option>`)}
  </select></label></p>`;
});

/** What each operator is, where the names do not say it. */
const Kinds = observed((/** @type {{seen: Seen}} */ { seen }) => {
  if (seen.operators.length === 0) return null;
  return html`<p class="kinds">${t("import.kinds")} ${seen.operators.map(
    ({ name, kind }) => html`<label key=${name}>${name} <select aria-label=${t("import.kind", { name })}
      onChange=${(/** @type {any} */ event) => tell({ kinds: { ...book.value?.said.kinds, [name]: event.currentTarget.value } })}>
      ${KINDS.map((one) => html`<option key=${one} value=${one} selected=${one === kind}>${t(`kind.${one}`)}</option>`)}
    </select></label>`,
  )}</p>`;
});

const Columns = observed((/** @type {{seen: Seen}} */ { seen }) => html`
  <p class="hint">${t("import.hint")}</p>
  <div class="sheet">
    <table>
      <thead>
        <tr>${seen.columns.map((column) => html`<th scope="col">${column.header || lettersOf(column)}</th>`)}</tr>
        <tr>${seen.columns.map(
          (column) => html`<td class="meaning"><${Field}
            aria-label=${t("import.meaning", { column: column.header || lettersOf(column) })}
            placeholder=${column.meaning ?? t("import.unread")}
            value=${book.value?.said.meanings[nameOf(column, seen)] ?? ""}
            commit=${(/** @type {string} */ text) => mean(nameOf(column, seen), text)}
          /></td>`,
        )}</tr>
      </thead>
      <tbody>${seen.rows.map((row) => html`<tr>${row.map((text) => html`<td>${text}</td>`)}</tr>`)}</tbody>
    </table>
  </div>
  ${seen.notes.length ? html`<ul class="sentences">${seen.notes.map((note) => html`<li>${note.message}</li>`)}</ul>` : null}
`);
