/**
 * Under the Gantt chart: what differs from the schedule under it, the critical path, and how each
 * operator's time is spent. The numbers are the server's.
 * @module
 */
import { looksOf } from "./looks.js";
import { marked, measures } from "./measures.js";
import { beneath, cell, forgetEarlier, picked, point, proposal } from "./state.js";
import { shown, t } from "./words.js";
import { html, observed } from "./view.js";

/** @typedef {import("./measures.js").Fare} Fare */

/** What differs from the schedule whose bars are drawn as ghosts. */
export const Changed = observed(() => {
  const under = beneath.value;
  const changed = measures.value?.changed;
  if (!under || !changed || proposal.value) return null;
  return html`<p class="changed-since" role="note">
    ${t("changed.since", { point: under.name })} <b>${changed.sentence}</b>
    ${under.earlier ? html`<button class="quiet" onClick=${forgetEarlier}>${t("changed.hide")}</button>` : null}
  </p>`;
});

export const Balance = observed(() => {
  const now = measures.value;
  if (!point.value || !now) return null;
  if (!now.sound) return html`<p class="hint">${t("balance.unsound")}</p>`;
  return html`<div class="balance"><${Path} path=${now.path ?? []} /><${Operators} operators=${now.operators ?? []} /></div>`;
});

const Path = observed((/** @type {{path: string[]}} */ { path }) => html`
  <div class="path">
    <button aria-pressed=${marked.value} onClick=${() => (marked.value = !marked.value)}>${t("balance.path")}</button>
    <ol aria-label=${t("balance.path")}>
      ${path.map((task) => html`<li key=${task}><button class="link" aria-label=${t("balance.to_bar", { task })} onClick=${() => goToBar(task)}>${task}</button></li>`)}
    </ol>
  </div>
`);

/** Chooses a task's bar and goes there. @param {string} task */
function goToBar(task) {
  picked.value = task;
  requestAnimationFrame(() => {
    const bar = /** @type {HTMLElement | null} */ (document.querySelector(`button.bar[data-task="${CSS.escape(task)}"]`));
    bar?.focus();
    bar?.scrollIntoView({ block: "nearest", inline: "nearest" });
  });
}

const SPENT = /** @type {const} */ (["working", "changing", "resting", "idle"]);

const Operators = observed((/** @type {{operators: Fare[]}} */ { operators }) => {
  const looks = looksOf(cell.value);
  const heads = SPENT.filter((key) => key === "working" || key === "idle" || operators.some((one) => one[key] > 0));
  return html`<div class="sheet"><table class="fares" aria-label=${t("balance.title")}>
    <thead><tr>
      <th scope="col">${t("operators.name")}</th>
      <th scope="col">${t("balance.spent")}</th>
      ${heads.map((key) => html`<th scope="col" class="number">${t(`balance.${key}`)}</th>`)}
      <th scope="col" class="number">${t("balance.share")}</th>
      <th scope="col" class="number">${t("column.stress")}</th>
    </tr></thead>
    <tbody>${operators.map((one) => {
      const look = looks.get(one.operator);
      return html`<tr key=${one.operator}>
        <th scope="row"><span class="swatch ${look?.class}" aria-hidden="true"></span> ${look?.label ?? one.operator}</th>
        <td><${Spent} one=${one} look=${look?.class ?? ""} /></td>
        ${heads.map((key) => html`<td class="number">${shown(one[key])}</td>`)}
        <td class="number">${shown(Math.round(100 * one.share))} %</td>
        <td class="number">${one.stress === null ? "–" : one.stress_limit === null ? shown(one.stress) : t("balance.limit", { stress: one.stress, limit: one.stress_limit })}</td>
      </tr>`;
    })}</tbody>
  </table></div>`;
});

/** An operator's time as a bar; the numbers beside it say the same. */
const Spent = observed((/** @type {{one: Fare, look: string}} */ { one, look }) => html`<span class="spent" aria-hidden="true">
  ${SPENT.map((key) => html`<span class="${key} ${key === "working" ? `swatch ${look}` : ""}" style=${{ flexGrow: one[key] }}></span>`)}
</span>`);
