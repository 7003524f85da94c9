/**
 * What the server says of the schedule on show: how each operator fares, what is critical, why each
 * task starts when it does, and what differs from the schedule under it. Nothing of it is counted here.
 * @module
 */
import * as api from "./api.js";
import { beneath, cell, faults, point } from "./state.js";
import { language } from "./words.js";
import { computed, effect, signal } from "./view.js";

/** @typedef {{operator: string, tasks: number, working: number, changing: number, resting: number, idle: number, share: number, stress: number | null, stress_limit: number | null}} Fare */
/** @typedef {{kind: string, what: string, start: number, end: number}} Shaded a time in which an operator works on no task */
/** @typedef {{operator: string, busy: number, share: number, shaded: Shaded[], waits: {task: string, start: number, end: number}[]}} LaneTold */
/** @typedef {{task: string, slack: number, critical: boolean, sentence: string}} Held */
/** @typedef {{sound: boolean, lanes: LaneTold[] | null, operators: Fare[] | null, tasks: Held[] | null, path: string[] | null, changed: {tasks: {task: string, what: string}[], sentence: string} | null}} Measures */

/** Of the schedule on show; null while it is asked, and where there is none. */
export const measures = signal(/** @type {Measures | null} */ (null));
/** Whether the critical path is marked. */
export const marked = signal(true);
/** What a lane shows besides its bars, by operator. */
export const laneOf = computed(() => new Map((measures.value?.lanes ?? []).map((one) => [one.operator, one])));
/** The kinds of time without a task that are on show. */
export const kindsShaded = computed(() => [...new Set((measures.value?.lanes ?? []).flatMap((lane) => lane.shaded.map((off) => off.kind)))]);
const held = computed(() => new Map((measures.value?.tasks ?? []).map((one) => [one.task, one])));

/** @param {string} task @returns {boolean} whether its bar is to be marked as critical. */
export const isCritical = (task) => marked.value && (held.value.get(task)?.critical ?? false);
/** @param {string} task @returns {string | undefined} why it starts when it does. */
export const whyThen = (task) => held.value.get(task)?.sentence;

let latest = 0;
/** Asks anew whenever another schedule is on show; the last answer counts. */
export function watchMeasures() {
  effect(() => {
    const shown = point.value;
    const before = beneath.value?.assignments;
    const body = { cell: cell.value, assignments: shown?.assignments, before, lang: language.value };
    const turn = ++latest;
    if (!shown || faults.value.length) measures.value = null;
    else ask(turn, body);
  });
}

/** @param {number} turn @param {Record<string, any>} body */
async function ask(turn, body) {
  try {
    const { status, document } = await api.measures(body);
    if (turn === latest) measures.value = status === 200 ? document : null;
  } catch (error) {
    if (!(error instanceof api.Unreachable)) throw error;
  }
}
