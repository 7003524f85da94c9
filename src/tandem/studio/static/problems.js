/**
 * What is wrong, with a way to where it stands: faults of the cell, and what cannot be kept together
 * where there is no plan.
 * @module
 */
import { cellOf } from "./columns.js";
import { cell, faults, infeasible } from "./state.js";
import { columns, goTo } from "./table.js";
import { t } from "./words.js";
import { html, observed } from "./view.js";

const MOST = 20;

/** @param {string[]} place @returns {string} what a field is marked with, so that it is found by its place in the cell. */
export const at = (...place) => place.join("\u001f");

/** @param {string[]} place @returns {HTMLElement | null} the field that says what stands at a place of the cell, or is nearest to it. */
function fieldAt(place) {
  for (let length = place.length; length > 0; length -= 1) {
    const name = CSS.escape(at(...place.slice(0, length)));
    const found = document.querySelector(`[data-at="${name}"]`) ?? document.querySelector(`[data-at^="${name}\u001f"]`);
    if (found) return /** @type {HTMLElement} */ (found);
  }
  return null;
}

/** @param {string[]} place @returns {boolean} whether there is something to go to. */
const leads = (place) => place.length > 0;

/** Goes to where something stands: a cell of the table, or a field of a panel, which opens. @param {string[]} place */
function goToPlace(place) {
  const rows = new Map(cell.value.tasks.map((task, row) => [task.name, row]));
  const there = cellOf(place, columns.value, rows);
  if (there) return goTo(there.row, there.column);
  const field = fieldAt(place);
  if (!field) return;
  for (let around = field.closest("details"); around; around = around.parentElement?.closest("details") ?? null) around.open = true;
  field.scrollIntoView({ block: "center" });
  field.focus();
}

export const Problems = observed(() => {
  const all = faults.value;
  if (all.length === 0) return null;
  return html`<div class="faults" aria-live="polite">
    <b>${t("table.problems", { n: all.length })}</b>
    <ul>${all.slice(0, MOST).map((fault) => {
      const place = fault.place.map(String);
      return html`<li>${leads(place) ? html`<button class="link" onClick=${() => goToPlace(place)}>${fault.message}</button>` : fault.message}</li>`;
    })}</ul>
  </div>`;
});

/** Why there is no plan: the smallest set that cannot be kept together, each with a way to where it stands. */
export const Why = observed(() => {
  const why = infeasible.value;
  if (!why) return null;
  return html`<div class="faults">
    <b>${t("infeasible.title")}</b>
    <ul>${(why.reasons ?? [why.message]).map((/** @type {string} */ one) => html`<li>${one}</li>`)}</ul>
    ${why.together?.length ? html`<p class="hint">${t("infeasible.members")}</p>` : null}
    ${(why.together ?? []).map((/** @type {{words: string, where?: string[]}} */ one) => {
      const place = (one.where ?? []).map(String);
      return html`<button onClick=${() => goToPlace(place)} disabled=${!leads(place)}>${one.words}</button>`;
    })}
  </div>`;
});
