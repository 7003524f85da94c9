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
/** @typedef {{cell: any, columns: Read[], rows: string[][], notes: {message: string}[]}} Answer */

/** The workbook that is looked at: its bytes, the meanings that were given by hand, what came of them. */
const book = signal(/** @type {{name: string, bytes: ArrayBuffer, meanings: Record<string, string>, answer: Answer | null, faults: string[]} | null} */ (null));

export const Import = observed(
  () => html`<label class="file">${t("import.button")}<input
    type="file"
    accept=${ACCEPTED}
    onChange=${async (/** @type {any} */ event) => {
      const file = event.currentTarget.files[0];
      event.currentTarget.value = "";
      if (!file) return;
      book.value = { name: file.name, bytes: await file.arrayBuffer(), meanings: {}, answer: null, faults: [] };
      await read();
    }}
  /></label>`,
);

/** Asks the server what the workbook says; an answer that was there stays when a new meaning is refused. */
async function read() {
  const now = book.value;
  if (!now) return;
  const meanings = Object.entries(now.meanings).map(([column, meaning]) => `${column}=${meaning}`);
  try {
    const { status, document } = await api.importWorkbook(now.name, meanings, language.value, now.bytes);
    if (book.value !== now) return;
    if (status === 200) {
      book.value = { ...now, answer: document, faults: [] };
      say("status.read", { name: now.name, n: document.cell.tasks.length });
    } else {
      const faults = document.errors?.map((/** @type {any} */ one) => (one.where ? `${one.where}: ${one.message}` : one.message)) ?? [document.error];
      book.value = { ...now, faults };
      say("status.refused", { reason: faults[0] }, "bad");
    }
  } catch (error) {
    if (!(error instanceof api.Unreachable)) throw error;
  }
}

/** @param {Read} column @returns {string} the letters of the column in its sheet. */
const lettersOf = (column) => /!([A-Z]+)\d*$/.exec(column.place)?.[1] ?? column.header;

/** @param {Read} column @param {string} meaning */
function mean(column, meaning) {
  if (!book.value) return;
  const { [lettersOf(column)]: _, ...others } = book.value.meanings;
  const meanings = meaning.trim() ? { ...others, [lettersOf(column)]: meaning.trim() } : others;
  book.value = { ...book.value, meanings };
  read();
}

function take() {
  const now = book.value;
  if (!now?.answer) return;
  change({ cell: now.answer.cell, hand: null, locks: [] });
  say("status.imported", { name: now.name, n: now.answer.cell.tasks.length });
  book.value = null;
}

export const Preview = observed(() => {
  const now = book.value;
  if (!now) return null;
  const { answer, faults } = now;
  return html`<section class="preview" aria-label=${t("import.title", { name: now.name })}>
    <div class="heading">
      <h2>${t("import.title", { name: now.name })}</h2>
      <span class="tools">
        ${answer ? html`<button class="first" onClick=${take} disabled=${faults.length > 0}>${t("import.take", { n: answer.cell.tasks.length })}</button>` : null}
        <button onClick=${() => (book.value = null)}>${t("button.discard")}</button>
      </span>
    </div>
    ${faults.length ? html`<div class="faults"><ul>${faults.map((one) => html`<li>${one}</li>`)}</ul></div>` : null}
    ${answer ? html`<${Columns} answer=${answer} />` : null}
  </section>`;
});

const Columns = observed((/** @type {{answer: Answer}} */ { answer }) => html`
  <p class="hint">${t("import.hint")}</p>
  <div class="sheet">
    <table>
      <thead>
        <tr>${answer.columns.map((column) => html`<th scope="col">${column.header || lettersOf(column)}</th>`)}</tr>
        <tr>${answer.columns.map(
          (column) => html`<td class="meaning"><${Field}
            aria-label=${t("import.meaning", { column: column.header || lettersOf(column) })}
            placeholder=${column.meaning ?? t("import.unread")}
            value=${book.value?.meanings[lettersOf(column)] ?? ""}
            commit=${(/** @type {string} */ text) => mean(column, text)}
          /></td>`,
        )}</tr>
      </thead>
      <tbody>${answer.rows.map((row) => html`<tr>${row.map((text) => html`<td>${text}</td>`)}</tr>`)}</tbody>
    </table>
  </div>
  ${answer.notes.length ? html`<ul class="sentences">${answer.notes.map((note) => html`<li>${note.message}</li>`)}</ul>` : null}
`);
