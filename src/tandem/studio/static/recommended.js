/**
 * Which compromise is recommended: the planner's own choice, or, once a slider is moved, the one that
 * the server names for these limits and this share of attention for stress. The plan on show follows.
 * @module
 */
import * as api from "./api.js";
import { choose, front, hand, plan, pointName, proposal, running, selected } from "./state.js";
import { shown, t } from "./words.js";
import { batch, computed, html, observed, signal } from "./view.js";

/** @typedef {{point: number | null, weights: [number, number] | null, within: number[]}} Answer */

/** Percent of attention for stress; null as long as nobody has said. */
const share = signal(/** @type {number | null} */ (null));
/** Limits on what may be recommended. */
const limits = signal(/** @type {{max_makespan?: number, max_stress?: number}} */ ({}));
const answer = signal(/** @type {{of: unknown, told: Answer} | null} */ (null));
/** The server's answer, while it is about the front on show. */
const told = computed(() => (answer.value && answer.value.of === front.value ? answer.value.told : null));

/** Index of the recommended point; -1 where there is none. */
export const recommended = computed(() => ((told.value ? told.value.point : plan.value?.document.recommended?.point) ?? 0) - 1);
/** @param {number} index @returns {boolean} whether the point breaks a limit of the sliders. */
export const isOutside = (index) => told.value !== null && !told.value.within.includes(index + 1);

let latest = 0;
async function ask() {
  const points = front.value;
  const turn = ++latest;
  if (share.value === null && Object.keys(limits.value).length === 0) return (answer.value = null);
  const body = { points: points.map((one) => [one.makespan, one.stress]), ...limits.value, ...(share.value !== null && { share: share.value / 100 }) };
  try {
    const { status, document } = await api.recommend(body);
    if (turn !== latest || status !== 200 || points !== front.value) return;
    answer.value = { of: points, told: document };
    const to = document.point === null ? -1 : document.point - 1;
    if (to >= 0 && to !== selected.value && !hand.value && !proposal.value) choose(to);
  } catch (error) {
    if (!(error instanceof api.Unreachable)) throw error;
  }
}

function reset() {
  batch(() => {
    share.value = null;
    limits.value = {};
    answer.value = null;
  });
}

/** @param {"max_makespan" | "max_stress"} key @param {number} value @param {boolean} free whether it forbids nothing. */
function limit(key, value, free) {
  const { [key]: _, ...others } = limits.value;
  limits.value = free ? others : { ...others, [key]: value };
  ask();
}

export const Sliders = observed(() => {
  const points = front.value;
  if (running.value || points.length < 2) return null;
  const moved = share.value !== null || Object.keys(limits.value).length > 0;
  return html`<fieldset class="sliders">
    <legend>${t("sliders.title")}</legend>
    <label>${t("sliders.share")}
      <span class="ends"><span aria-hidden="true">${t("sliders.time")}</span>
      <input type="range" min="0" max="100" step="1" value=${share.value ?? 50}
        aria-valuetext=${t("sliders.share_is", { n: share.value ?? 50 })}
        onInput=${(/** @type {any} */ event) => ((share.value = Number(event.currentTarget.value)), ask())} />
      <span aria-hidden="true">${t("sliders.stress")}</span></span>
    </label>
    <${Limit} name="max_makespan" values=${points.map((one) => one.makespan)} />
    <${Limit} name="max_stress" values=${points.map((one) => one.stress).reverse()} />
    <p class="said"><span aria-live="polite">${moved ? words() : t("sliders.hint")}</span>${moved ? html` <button class="quiet" onClick=${reset}>${t("sliders.reset")}</button>` : null}</p>
  </fieldset>`;
});

/** A slider whose stops are the values that the front has. */
const Limit = observed((/** @type {{name: "max_makespan" | "max_stress", values: number[]}} */ { name, values }) => {
  const last = values.length - 1;
  const given = limits.value[name];
  const at = given === undefined ? last : Math.max(0, values.findLastIndex((value) => value <= given));
  const text = given === undefined ? t("sliders.free") : t(`sliders.${name}_is`, { n: given });
  return html`<label>${t(`sliders.${name}`)} <span class="value">${text}</span>
    <input type="range" min="0" max=${last} step="1" value=${at} aria-valuetext=${text}
      onInput=${(/** @type {any} */ event) => limit(name, values[Number(event.currentTarget.value)], Number(event.currentTarget.value) === last)} />
  </label>`;
});

/** The point in words, and the options that mean the same on the command line. */
function words() {
  const now = told.value;
  if (!now) return t("sliders.asking");
  if (now.point === null) return t("sliders.none");
  const point = pointName(front.value[now.point - 1]);
  return now.weights ? t("sliders.weighted", { point, weights: now.weights.map((one) => String(one)).join(",") }) : t("sliders.within", { point, n: shown(now.within.length) });
}
