/**
 * Copies of the cell beside the one that is edited: each with a name, planned, and compared with it
 * key by key and point by point. One of them can be taken up, and kept as the file.
 * @module
 */
import * as api from "./api.js";
import { textOf } from "./ordered.js";
import { cell, change, faults, file, options, plan, pointName, save, say, stale } from "./state.js";
import { language, shown, t } from "./words.js";
import { computed, effect, html, observed, signal, untracked } from "./view.js";

/** @typedef {import("./ordered.js").Cell} Cell */
/** @typedef {{makespan: number, stress: number}} Pair */
/** @typedef {{front: Pair[], complete: boolean, recommended: number}} Planned the front of a cell; the recommended point counted from 0. */
/** @typedef {{name: string, cell: Cell, planned: Planned | null, error?: string, busy?: boolean}} Scenario */
/** @typedef {{changes: {sentence: string}[], front_changes: {makespan: number, stress: number, makespan_then: number | null, stress_then: number | null, seconds: number | null, more_stress: number | null}[]}} Compared */

const MOST_CHANGES = 4;
const KEPT = "tandem.scenarios.";

const scenarios = signal(/** @type {Scenario[]} */ ([]));
const named = signal("");
/** Per scenario, what the server says of it beside the cell as it stands. */
const compared = signal(/** @type {Map<string, Compared>} */ (new Map()));

/** The plan of the cell as it stands, if that is what was planned last. */
const standing = computed(() => (plan.value && !plan.value.running && !stale.value && plan.value.document.front?.length ? plannedOf(plan.value.document) : null));

/** @param {any} document of a plan @returns {Planned} */
const plannedOf = (document) => ({
  front: document.front.map((/** @type {Pair} */ { makespan, stress }) => ({ makespan, stress })),
  complete: document.complete,
  recommended: (document.recommended?.point ?? 1) - 1,
});

/** @param {string} name @param {Partial<Scenario>} part */
const update = (name, part) => (scenarios.value = scenarios.value.map((one) => (one.name === name ? { ...one, ...part } : one)));

function keepCopy() {
  const name = named.value.trim() || t("scenarios.number", { n: scenarios.value.length + 1 });
  const copy = { name, cell: cell.value, planned: standing.value };
  const others = scenarios.value.filter((one) => one.name !== name);
  scenarios.value = [...others, copy];
  named.value = "";
  say("status.scenario", { name });
}

/** @param {Scenario} one */
async function planOne(one) {
  update(one.name, { busy: true, error: undefined });
  try {
    const { status, document } = await api.plan({ cell: one.cell, options: options.value });
    if (status === 200) update(one.name, { busy: false, planned: plannedOf(document) });
    else update(one.name, { busy: false, planned: null, error: document.error });
  } catch (error) {
    update(one.name, { busy: false });
    if (!(error instanceof api.Unreachable)) throw error;
  }
}

async function planAll() {
  for (const one of scenarios.value) if (!one.planned && !one.busy) await planOne(one);
}

/** Puts a scenario into the editor; undo brings back what was there. @param {Scenario} one */
function take(one) {
  change({ cell: one.cell, hand: null, locks: [] });
  say("status.scenario_taken", { name: one.name });
}

/** @param {Scenario} one */
async function keepAsFile(one) {
  take(one);
  await save();
}

/** Asks what differs whenever the cell, a scenario or the language has changed, and remembers the scenarios for as long as this tab is open. */
export function watchScenarios() {
  effect(() => {
    const kept = sessionStorage.getItem(keptAs.value);
    scenarios.value = kept ? JSON.parse(kept) : [];
  });
  effect(() => {
    const kept = scenarios.value.map(({ busy: _, ...one }) => one);
    sessionStorage.setItem(untracked(() => keptAs.value), JSON.stringify(kept));
  });
  effect(() => {
    const all = scenarios.value;
    if (all.length && faults.value.length === 0) compareAll(all, cell.value, standing.value, language.value);
  });
}

const keptAs = computed(() => KEPT + file.value.name);

let latest = 0;
/** @param {Scenario[]} all @param {Cell} base @param {Planned | null} planned @param {string} lang */
async function compareAll(all, base, planned, lang) {
  const turn = ++latest;
  const pairs = (/** @type {Planned | null} */ one) => (one?.front ?? []).map(({ makespan, stress }) => [makespan, stress]);
  try {
    const told = await Promise.all(
      all.map((one) => api.compare({ cell: base, other: one.cell, points: pairs(planned), other_points: planned ? pairs(one.planned) : [], lang })),
    );
    if (turn !== latest) return;
    compared.value = new Map(all.flatMap((one, place) => (told[place].status === 200 ? [[one.name, told[place].document]] : [])));
  } catch (error) {
    if (!(error instanceof api.Unreachable)) throw error;
  }
}

export const Scenarios = observed(() => {
  const all = scenarios.value;
  return html`
    <div class="heading">
      <h2>${t("scenarios.title")}</h2>
      <form class="tools" onSubmit=${(/** @type {Event} */ event) => (event.preventDefault(), keepCopy())}>
        <input aria-label=${t("scenarios.name")} placeholder=${t("scenarios.name")} value=${named.value} onInput=${(/** @type {any} */ event) => (named.value = event.currentTarget.value)} />
        <button disabled=${faults.value.length > 0}>${t("scenarios.copy")}</button>
        ${all.length ? html`<button type="button" onClick=${planAll} disabled=${all.every((one) => one.planned || one.busy)}>${t("scenarios.plan_all")}</button>` : null}
      </form>
    </div>
    ${all.length === 0
      ? html`<p class="empty">${t("scenarios.empty")}</p>`
      : html`<div class="sheet"><table class="compared" aria-label=${t("scenarios.title")}>
          <thead><tr>${["scenario", "differs", "points", "quickest", "recommended", "calmest"].map((key) => html`<th scope="col">${t(`scenarios.${key}`)}</th>`)}</tr></thead>
          <tbody>
            <tr><th scope="row">${t("scenarios.standing")}</th><td>–</td><${Front} planned=${standing.value} /></tr>
            ${all.map((one) => html`<${One} key=${one.name} one=${one} told=${compared.value.get(one.name)} />`)}
          </tbody>
        </table></div>
        <${PointByPoint} all=${all} />`}
  `;
});

const One = observed((/** @type {{one: Scenario, told: Compared | undefined}} */ { one, told }) => {
  const said = (told?.changes ?? []).map((change) => change.sentence);
  const rest = said.length - MOST_CHANGES;
  return html`<tr>
    <th scope="row">${one.name}</th>
    <td class="differs">${said.length === 0 ? (told ? t("scenarios.same") : "") : html`<ul>${said.slice(0, MOST_CHANGES).map((sentence) => html`<li>${sentence}</li>`)}${rest > 0 ? html`<li>${t("scenarios.more", { n: rest })}</li>` : null}</ul>`}
      <span class="tools">
        <button onClick=${() => planOne(one)} disabled=${one.busy} aria-label=${t("scenarios.plan_one", { name: one.name })}>${t("button.plan")}</button>
        <button onClick=${() => take(one)} aria-label=${t("scenarios.take_one", { name: one.name })}>${t("scenarios.take")}</button>
        <button onClick=${() => keepAsFile(one)} aria-label=${t("scenarios.keep_one", { name: one.name })}>${t("scenarios.keep")}</button>
        <button onClick=${() => (scenarios.value = scenarios.value.filter((other) => other.name !== one.name))} aria-label=${t("operators.remove", { name: one.name })}>✕</button>
      </span></td>
    ${one.error ? html`<td colspan="4" class="error">${one.error}</td>` : html`<${Front} planned=${one.planned} busy=${one.busy} />`}
  </tr>`;
});

/** The front of a cell in four columns. @param {{planned: Planned | null, busy?: boolean}} props */
function Front({ planned, busy }) {
  if (!planned) return html`<td colspan="4" class="faint">${t(busy ? "scenarios.planning" : "scenarios.unplanned")}</td>`;
  const { front, complete, recommended } = planned;
  const points = [front[0], front[Math.max(0, Math.min(recommended, front.length - 1))], front[front.length - 1]];
  return html`<td>${t(complete ? "scenarios.proven" : "scenarios.open", { n: front.length })}</td>${points.map((point) => html`<td>${pointName(/** @type {any} */ (point))}</td>`)}`;
}

/** What becomes of each compromise of the cell as it stands. */
const PointByPoint = observed((/** @type {{all: Scenario[]}} */ { all }) => {
  const base = standing.value;
  const columns = all.filter((one) => one.planned && compared.value.get(one.name)?.front_changes.length);
  if (!base || columns.length === 0) return null;
  return html`<div class="sheet"><table class="compared" aria-label=${t("scenarios.point_by_point")}>
    <thead><tr><th scope="col">${t("scenarios.standing")}</th>${columns.map((one) => html`<th scope="col">${one.name}</th>`)}</tr></thead>
    <tbody>${base.front.map((point, place) => html`<tr>
      <th scope="row">${pointName(/** @type {any} */ (point))}</th>
      ${columns.map((one) => html`<td>${becomes(compared.value.get(one.name)?.front_changes[place])}</td>`)}
    </tr>`)}</tbody>
  </table></div>`;
});

/** @param {Compared["front_changes"][0] | undefined} change */
function becomes(change) {
  if (!change) return "";
  const { makespan_then, stress_then, seconds, more_stress } = change;
  const time = makespan_then === null ? t("scenarios.no_stress") : t("scenarios.then_time", { n: makespan_then, more: signed(seconds) });
  const stress = stress_then === null ? t("scenarios.no_time") : t("scenarios.then_stress", { n: stress_then, more: signed(more_stress) });
  return html`${time}<br />${stress}`;
}

/** @param {number | null} value */
const signed = (value) => (value ? `${value > 0 ? "+" : "−"}${shown(Math.abs(value))}` : "±0");
