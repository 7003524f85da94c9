/**
 * Why a task is where it is, and what it would cost elsewhere: the sentences of `tandem explain`, each
 * with numbers that were planned again.
 * @module
 */
import * as api from "./api.js";
import { cell, picked, point, stale } from "./state.js";
import { language, t } from "./words.js";
import { html, observed, signal, useEffect } from "./view.js";

const answer = signal(/** @type {{task: string, sentences: string[] | null, error?: string} | null} */ (null));

/** @param {string} task */
async function ask(task) {
  const now = point.value;
  if (!now) return;
  answer.value = { task, sentences: null };
  try {
    const { status, document } = await api.explain({ cell: cell.value, assignments: now.assignments, task, lang: language.value });
    if (answer.value?.task !== task) return;
    answer.value =
      status === 200
        ? { task, sentences: document.sentences }
        : { task, sentences: [], error: document.errors?.[0]?.message ?? document.error ?? "?" };
  } catch (error) {
    if (!(error instanceof api.Unreachable)) throw error;
    answer.value = null;
  }
}

export const Explain = observed(() => {
  const task = picked.value;
  const shown = point.value;
  useEffect(() => {
    answer.value = null;
  }, [task, shown]);
  if (!shown) return null;
  if (task === null || !shown.assignments.some((one) => one.task === task)) return html`<p class="explain hint">${t("explain.hint")}</p>`;
  const told = answer.value?.task === task ? answer.value : null;
  return html`<div class="explain">
    <div class="heading">
      <h2>${t("explain.title", { task })}</h2>
      <span class="tools"><button onClick=${() => ask(task)} disabled=${told?.sentences === null || stale.value}>${t("explain.ask")}</button></span>
    </div>
    ${told?.sentences === null ? html`<p class="hint">${t("explain.waiting")}</p>` : null}
    ${told?.error ? html`<p class="error">${told.error}</p>` : null}
    ${told?.sentences?.length ? html`<ul class="sentences" aria-live="polite">${told.sentences.map((one) => html`<li>${one.trim()}</li>`)}</ul>` : null}
  </div>`;
});
