/**
 * What the page knows, as signals. `work` is all that undo undoes: the cell, the schedule made by hand
 * and the locks. Everything in it is replaced, never changed in place, so a step back is the old value.
 * @module
 */
import * as api from "./api.js";
import { textOf } from "./ordered.js";
import { language, t } from "./words.js";
import { batch, computed, effect, signal, untracked } from "./view.js";

/** @typedef {import("./ordered.js").Cell} Cell */
/** @typedef {{task: string, operators: string[], start: number, end: number}} Assignment */
/** @typedef {{makespan: number, stress: number, assignments: Assignment[], status?: string, bound?: any, digest?: string}} Point */
/** @typedef {Point & {faults: string[], placed: string[], document?: any}} ByHand a schedule made by hand: what the checker says of it, which tasks were placed since it was last re-solved, and then its document. */
/** @typedef {{cell: Cell, hand: ByHand | null, locks: string[]}} Work */
/** @typedef {{place: string[], message: string, value?: unknown}} Fault */

const MOST_STEPS = 500;
const CHECK_AFTER_MS = 120;

export const work = signal(/** @type {Work | null} */ (null));
const past = signal(/** @type {Work[]} */ ([]));
const future = signal(/** @type {Work[]} */ ([]));
export const canUndo = computed(() => past.value.length > 0);
export const canRedo = computed(() => future.value.length > 0);

export const cell = computed(() => /** @type {Cell} */ (work.value?.cell));
export const hand = computed(() => work.value?.hand ?? null);
export const locks = computed(() => work.value?.locks ?? []);

/** One sentence for the line of role status: a key with its values, so that it follows the language. */
export const status = signal(/** @type {{key: string, values?: any, tone?: string}} */ ({ key: "status.loading" }));
/** @param {string} key @param {any} [values] @param {string} [tone] "bad" where something was refused. */
export function say(key, values, tone) {
  status.value = { key, values, tone };
}

/** @param {Partial<Work>} part what changes; one step of undo. */
export function change(part) {
  const now = /** @type {Work} */ (work.value);
  batch(() => {
    past.value = [...past.value.slice(1 - MOST_STEPS), now];
    future.value = [];
    work.value = { ...now, ...part };
  });
}

/** @param {(cell: Cell) => Cell} edit */
export const edit = (edit) => change({ cell: edit(cell.value) });

export function undo() {
  const last = past.value.at(-1);
  if (!last || !work.value) return;
  batch(() => {
    future.value = [...future.value, /** @type {Work} */ (work.value)];
    past.value = past.value.slice(0, -1);
    work.value = last;
    proposal.value = null;
  });
  say("status.undone");
}

export function redo() {
  const next = future.value.at(-1);
  if (!next || !work.value) return;
  batch(() => {
    past.value = [...past.value, /** @type {Work} */ (work.value)];
    future.value = future.value.slice(0, -1);
    work.value = next;
    proposal.value = null;
  });
  say("status.redone");
}

// ---- the file

/** Its version is that of the content that was read; undefined for one that is yet to be made. */
export const file = signal(/** @type {{name: string, version: string | undefined}} */ ({ name: "", version: "" }));
const savedText = signal("");
export const dirty = computed(() => work.value !== null && textOf(cell.value) !== savedText.value);
/** The newer state of the file that a save met, until the user has chosen. */
export const conflict = signal(/** @type {{version: string, cell: Cell} | null} */ (null));

/** The cell files that can be opened. */
export const files = signal(/** @type {string[]} */ ([]));
export async function listFiles() {
  const { status: code, document } = await api.listFiles();
  if (code === 200) files.value = document.files.map((/** @type {{name: string}} */ one) => one.name);
}

/** Reads a file as it is. @param {string} [name] */
export async function open(name) {
  const { status: code, document } = await api.readCell(name);
  if (code === 404 && !name) return beginNew();
  if (code !== 200) return say("status.refused", { reason: reasonOf(document) }, "bad");
  batch(() => {
    file.value = { name: document.name, version: document.version };
    savedText.value = textOf(document.cell);
    work.value = { cell: document.cell, hand: null, locks: [] };
    past.value = future.value = [];
    plan.value = proposal.value = infeasible.value = picked.value = earlier.value = null;
    unsaved.value = document.draft?.cell ?? null;
  });
  say("status.ready", { name: document.name });
}

/** In a folder without a cell: one to begin with, which saving makes a file. */
function beginNew() {
  const operators = ["human", "robot"].map((kind) => ({ name: kind, kind }));
  batch(() => {
    file.value = { name: "cell.yaml", version: undefined };
    work.value = { cell: { format: 1, operators, tasks: [] }, hand: null, locks: [] };
  });
  say("status.new", { name: file.value.name });
}

/** What was not saved when the studio was stopped last, until the user has chosen. */
export const unsaved = signal(/** @type {Cell | null} */ (null));

export function takeUnsaved() {
  if (unsaved.value) change({ cell: unsaved.value, hand: null, locks: [] });
  unsaved.value = null;
  say("status.taken_up");
}

export async function forgetUnsaved() {
  unsaved.value = null;
  await api.hold({ file: file.value.name });
}

/** Writes the file, unless it has become newer. */
export async function save() {
  if (blocked()) return;
  const written = cell.value;
  const { status: code, document } = await api.writeCell(file.value.name, { cell: written, version: file.value.version });
  if (code === 409) {
    conflict.value = { version: document.version, cell: document.cell };
    return say("status.newer", {}, "bad");
  }
  if (code !== 200) return refused(document);
  batch(() => {
    file.value = { ...file.value, version: document.version };
    savedText.value = textOf(written);
    conflict.value = null;
  });
  say("status.saved", { name: file.value.name });
}

/** Writes over the newer file. */
export async function saveAnyway() {
  file.value = { ...file.value, version: conflict.value?.version ?? file.value.version };
  await save();
}

/** Takes the newer file; undo brings back what was here. */
export function takeTheirs() {
  const theirs = conflict.value;
  if (!theirs) return;
  batch(() => {
    change({ cell: theirs.cell, hand: null, locks: [] });
    file.value = { ...file.value, version: theirs.version };
    savedText.value = textOf(theirs.cell);
    conflict.value = null;
  });
  say("status.taken");
}

// ---- what is wrong with the cell

/** The cell with what is being typed, while something is. */
export const typed = signal(/** @type {Cell | null} */ (null));
const told = signal(/** @type {Fault[]} */ ([]));
/** Names that cannot be keys of the document, which the server therefore never sees. */
const unnamed = computed(() => (work.value ? namingFaults(typed.value ?? cell.value) : []));
export const faults = computed(() => [...unnamed.value, ...told.value]);

/** @param {Cell} cell @returns {Fault[]} */
function namingFaults(cell) {
  const seen = new Set();
  return cell.tasks.flatMap(({ name }, row) => {
    const again = seen.has(name);
    seen.add(name);
    if (name === "") return [{ place: ["tasks", name, "", String(row)], message: t("fault.unnamed", { row: row + 1 }) }];
    if (again) return [{ place: ["tasks", name, "", String(row)], message: t("fault.twice", { name }) }];
    return [];
  });
}

let latest = 0;
/** Asks the server what is wrong, a moment after the last change. */
export function watchForFaults() {
  /** @type {number | undefined} */
  let waiting;
  effect(() => {
    const asked = typed.value ?? work.value?.cell;
    if (!asked) return;
    clearTimeout(waiting);
    waiting = setTimeout(async () => {
      const turn = ++latest;
      try {
        const { status: code, document } = await api.check({ cell: asked });
        if (turn === latest) told.value = code === 200 || code === 422 ? (document.errors ?? []) : [];
        if (dirty.value) await api.hold({ cell: cell.value, file: file.value.name, version: file.value.version });
      } catch (error) {
        if (!(error instanceof api.Unreachable)) throw error;
      }
    }, CHECK_AFTER_MS);
  });
}

/** @returns {boolean} whether the cell cannot be sent, which is then said. */
function blocked() {
  if (unnamed.value.length === 0) return false;
  say("status.refused", { reason: unnamed.value[0].message }, "bad");
  return true;
}

/** @param {any} document @returns {string} the first sentence of what it says; the rest is shown where it belongs. */
function reasonOf(document) {
  return (document.errors?.[0]?.message ?? document.message ?? document.error ?? "?").split("\n")[0];
}

/** @param {any} document */
function refused(document) {
  if (document.errors) told.value = document.errors;
  say("status.refused", { reason: reasonOf(document) }, "bad");
}

// ---- the plan

/** The last plan: its document, the cell it was made for, and whether it is still being made. */
export const plan = signal(/** @type {{document: any, of: string, running: boolean, open: number | null} | null} */ (null));
export const selected = signal(0);
/** The options of `tandem plan`; a limit that is not set is not there. */
export const options = signal(/** @type {Record<string, number>} */ ({ time_limit: 10 }));
/** @param {string} name @param {number | undefined} value */
export function setOption(name, value) {
  const { [name]: _, ...others } = options.value;
  options.value = value === undefined ? others : { ...others, [name]: value };
}
export const running = computed(() => plan.value?.running ?? false);
export const front = computed(() => /** @type {Point[]} */ (plan.value?.document.front ?? []));
export const stale = computed(() => plan.value !== null && work.value !== null && plan.value.of !== textOf(cell.value));
/** Why there is no plan, in the planner's sentences. */
export const infeasible = signal(/** @type {any} */ (null));

/** Plans the cell as it stands here, saved or not. */
export async function makePlan() {
  if (running.value || blocked()) return;
  const asked = cell.value;
  infeasible.value = earlier.value = null;
  if (hand.value) change({ hand: null });
  plan.value = { document: { front: [] }, of: textOf(asked), running: true, open: null };
  selected.value = 0;
  say("status.planning");
  try {
    await api.planLive({ cell: asked, options: options.value, lang: language.value, file: file.value.name, version: file.value.version }, { progress, done, failed, lost });
  } catch (error) {
    lost();
    if (!(error instanceof api.Unreachable)) throw error;
  }
}

/** @param {any} data */
function progress(data) {
  if (!plan.value) return;
  plan.value = { ...plan.value, document: { front: data.front ?? front.value }, open: data.open ?? null };
  if (front.value.length) say("status.found", { n: front.value.length });
}

/** @param {any} document */
function done(document) {
  const made = plan.value;
  if (!made) return;
  const recommended = (document.recommended?.point ?? 1) - 1;
  batch(() => {
    plan.value = { ...made, document, running: false, open: null };
    selected.value = Math.max(0, Math.min(recommended, document.front.length - 1));
  });
  const n = document.front.length;
  say(document.complete ? "status.proven" : "status.unproven", { n, wall: document.wall_s });
}

/** @param {any} data */
function failed(data) {
  batch(() => {
    infeasible.value = data.exit === 4 ? (data.infeasible ?? data) : null;
    plan.value = front.value.length && plan.value ? { ...plan.value, running: false } : null;
  });
  if (infeasible.value) say("status.infeasible", {}, "bad");
  else refused(data);
}

function lost() {
  plan.value = front.value.length && plan.value ? { ...plan.value, running: false } : null;
  say("status.lost", {}, "bad");
}

/** Ends the solver; what it has found stays. */
export const stopPlan = () => api.stopPlan();

/** @param {number} index the point of the front to look at; a schedule made by hand steps back. */
export function choose(index) {
  batch(() => {
    if (index !== selected.value) earlier.value = front.value[selected.value];
    if (hand.value) change({ hand: null });
    proposal.value = null;
    selected.value = index;
  });
  const point = front.value[index];
  say("status.shown", { point: pointName(point) });
}

/** @param {Point} point @returns {string} the name of a point of the front, "23 s, stress 7". */
export const pointName = (point) => t("point.name", { makespan: point.makespan, stress: point.stress });

// ---- the schedule on show

/** What re-solving proposes, until it is kept or discarded. */
export const proposal = signal(/** @type {{point: Point & {changed?: {task: string, what: string}[]}, sentence: string, document: any} | null} */ (null));
export const point = computed(() => /** @type {Point | undefined} */ (proposal.value?.point ?? hand.value ?? front.value[selected.value]));
/** The point that was on show before this one was chosen. */
const earlier = signal(/** @type {Point | null} */ (null));
export const forgetEarlier = () => (earlier.value = null);
/** The schedule under the one on show, with which it is compared: the one that is to be replaced, that was changed by hand, or that was looked at before. */
export const beneath = computed(() => {
  const chosen = front.value[selected.value];
  const under = proposal.value ? (hand.value ?? chosen) : hand.value ? chosen : earlier.value;
  return under ? { assignments: under.assignments, name: pointName(under), earlier: under === earlier.value } : null;
});
/** Its bars, drawn as ghosts. */
export const ghosts = computed(() => beneath.value?.assignments ?? []);
/** The task whose bar was clicked last. */
export const picked = signal(/** @type {string | null} */ (null));

/** @param {string} task */
export function toggleLock(task) {
  const locked = locks.value.includes(task);
  change({ locks: locked ? locks.value.filter((name) => name !== task) : [...locks.value, task] });
  say(locked ? "status.unlocked" : "status.locked", { task });
}

/**
 * What the server says of a task at another time or operator.
 * @param {string} task @param {string[]} operators @param {number} start
 */
export async function verdictOn(task, operators, start) {
  const assignments = /** @type {Point} */ (untracked(() => point.value)).assignments;
  const { status: code, document } = await api.place({ cell: cell.value, assignments, task, operators, start, lang: language.value });
  if (code !== 200) return { allowed: false, reasons: [reasonOf(document)], faults: [], makespan: NaN, stress: NaN };
  return document;
}

/**
 * Puts a task elsewhere, if its cell lets it; the faults that this makes are shown, not forbidden.
 * @param {string} task @param {string[]} operators @param {number} start
 */
export async function drop(task, operators, start) {
  const verdict = await verdictOn(task, operators, start);
  if (!verdict.allowed) return say("status.cannot", { task, reason: verdict.reasons.join(" ") }, "bad");
  const { assignments, makespan, stress, faults } = verdict;
  const placed = [...(hand.value?.placed ?? []).filter((name) => name !== task), task];
  batch(() => {
    change({ hand: { assignments, makespan, stress, faults, placed } });
    proposal.value = null;
  });
  const values = { task, point: pointName(verdict), n: faults.length };
  if (faults.length) say("status.placed_with_faults", values, "bad");
  else say("status.placed", values);
}

/** Plans the rest anew around what is locked and placed, with the fewest changes. */
export async function resolveRest() {
  const now = point.value;
  if (!now || blocked()) return;
  const placed = hand.value?.placed ?? [];
  const last = now.assignments.find((one) => one.task === placed.at(-1));
  const keep = [...new Set([...locks.value, ...placed.slice(0, -1)])].filter((task) => task !== last?.task);
  say("status.resolving");
  const { status: code, document } = await api.replan({
    cell: cell.value,
    assignments: now.assignments,
    keep,
    lang: language.value,
    ...(last && { place: { task: last.task, operators: last.operators, start: last.start } }),
  });
  if (code !== 200) return refused(document);
  proposal.value = { point: document.point, sentence: document.sentence, document: document.document };
  say("status.proposed", { sentence: document.sentence });
}

export function keepProposal() {
  if (!proposal.value) return;
  const { point: kept, document } = proposal.value;
  batch(() => {
    change({ hand: { ...kept, faults: [], placed: [], document } });
    proposal.value = null;
  });
  say("status.kept", { point: pointName(kept) });
}

export function discardProposal() {
  proposal.value = null;
  say("status.discarded");
}

/** @param {Assignment} one @returns {string} the name of a bar, "task 6, human, 18 to 21 s". */
export const barName = (one) =>
  t("bar.name", { task: one.task, who: one.operators.join(" + "), start: one.start, end: one.end });
